#pragma once
// What there is to say of a level set's design at the end: the certificate and its word.

#include "optimize/curves.hpp"
#include "optimize/level_set/descent.hpp"
#include "optimize/loop/finish.hpp"

namespace kerf {

/// A run as it was left.
struct LevelSetEnd {
  const Ground& g;
  const Descent& descent;
  const FinishedCurves& curves;                // no shape: none were made
  std::vector<Iteration> finishing = {};       // rows of the curves
  std::shared_ptr<const Evaluated> last = {};  // the curves on the mesh that the case asks for; null: not the result
};

/// Whether the curves are the result: they keep the constraints as well as the carved design, and are no worse.
bool curves_are_better(const LevelSetEnd& end);

/// The curves on a mesh as kerf solve makes it. Throws Error(Geometry | Numerics).
std::shared_ptr<const Evaluated> solve_again(const LevelSetEnd& end);

/// The result with its certificate: shape residual, hole margin, the design on a finer mesh. `go_on`: not stopped.
OptimizeResult result_of(const LevelSetEnd& end, bool go_on);

}  // namespace kerf
