#pragma once
// What there is to say of a level set's design at the end: the certificate and its word.

#include "optimize/curves/curves.hpp"
#include "optimize/level_set/descent.hpp"
#include "optimize/loop/finish.hpp"

namespace kerf {

/// A run as it was left.
struct LevelSetEnd {
  const Ground& g;
  const Descent& descent;
  const FinishedCurves& curves;             // no shape: none were made
  const std::vector<Iteration>& finishing;  // rows of the curves
};

/// Whether the curves are the result: they keep the constraints as well as the carved design, and are no worse.
bool curves_are_better(const LevelSetEnd& end);

/// The result with its certificate: shape residual, hole margin, the design on a finer mesh. `go_on`: not stopped.
OptimizeResult result_of(const LevelSetEnd& end, bool go_on);

}  // namespace kerf
