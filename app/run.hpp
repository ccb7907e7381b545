#pragma once
// Case -> files. The whole toolkit in one page of calls.

#include "app/point_values.hpp"
#include "app/run/collect.hpp"
#include "app/run/journal.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

enum class Job { Run, Solve, Map, Validate, Optimize, Grow };
/// "solve", "map", ... as the commands are called; every other word is Run.
Job job_called(std::string_view command);

/// What the numbers of a result come from, of the body that its state belongs to, for who wants more than files.
struct RunFields {
  Mesh mesh;
  PlotData state;             // at corners of split_for_stress
  Eigen::VectorXd indicator;  // of the error, per triangle
  FullMap map;                // empty without a map everywhere
  ReadPoints at;              // values anywhere; keeps the solution, and no factor
};

/// Runs the jobs and writes every file of the interface; result.json after all others but the page, and once more last.
/// Throws Error(Geometry | Numerics | Files). A state that cannot be solved is written (status, reason) before
/// Error(Numerics) leaves; a map or a validation that cannot be had leaves a result with status "failed" and the state.
/// After an optimization mesh, state, cracks and functional are those of its design; a map and a validation asked for
/// beside it are of the body before it. An optimization that is asked to stop leaves its files without result.json, and
/// throws Error(Numerics).
Result run(const Case& c, Job job, const RunOptions& options);

/// What `kerf check` prints: the geometry in numbers and what each label selected. Meshes, solves nothing. Draws
/// check.png in the folder, unless that is empty or the case wants no pictures.
std::string check(const Case& c, const std::filesystem::path& folder = {});

}  // namespace kerf
