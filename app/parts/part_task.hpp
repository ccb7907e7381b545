#pragma once
// What the first process tells the others about their parts of a body.

#include "app/run/peaks.hpp"
#include "kerf/adaptive.hpp"
#include "solver/system.hpp"

#include <string_view>

namespace kerf {

/// What the others are told. The case they have read themselves.
struct PartTask {
  Mesh coarse;
  std::vector<Index> process;  // per triangle of it
  std::string folder;
  int threads = 1;
  bool vtk = true, copy = false, map = false;
  SingularZones zones = {};  // of the body, which a part does not show
  Floating floating = {};
  std::vector<Index> piece = {};  // SharedBody
  ContactGuess contact = {};
  Floating measured = {};          // floating, of the body with measured displacements
  std::string green = {};          // packed, of maps of clamped holes (topo/clamped_parts.hpp)
  std::vector<Round> rounds = {};  // of mesh.adapt before this one; of the last one alone more than the error is wanted
};

std::string packed(const PartTask& task);
PartTask unpacked(std::string_view bytes);

}  // namespace kerf
