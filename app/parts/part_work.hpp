#pragma once
// What every process does with its part of a body.

#include "app/parts/part_task.hpp"
#include "app/run/coarse_copy.hpp"
#include "app/run/findings.hpp"

#include <optional>

namespace kerf {

/// What all find together: the same on all, but for what the first one alone writes or draws.
struct FoundTogether {
  Findings of = {};
  Quality mesh;                                // with curved edges, which divided triangles are not similar beside
  Analysis functional = {};                    // the values alone
  std::vector<NamedField> fields, map_fields;  // names, kinds and components of the files
  std::optional<MapResult> map;
  std::vector<std::vector<std::vector<double>>> probes;  // rows of each
  std::vector<CopiedCenter> centers;                     // of the first process alone, as those at the corners
  std::vector<CopiedCorner> copied;                      // of the first process alone
  // With mesh.adapt: this round; why it is the last one, or else the indicator of the triangles before they were
  // divided, of the first process alone, and nothing of what is above.
  Round round;
  std::string stopped;
  Eigen::VectorXd eta;
  SharedEffort effort;
  ModelSeconds seconds;
};

/// Solves and writes the part that this process has.
FoundTogether work_together(const Case& c, PartTask task, Communicator& comm);

/// The file of a process among those of a grid.
std::string piece_name(std::string_view of, Index process);

}  // namespace kerf
