#pragma once
// Intervals that contain quantities of the exact solution.

#include "app/run/solve.hpp"
#include "kerf/functional.hpp"

namespace kerf {

/// The body and what its intervals are asked for.
struct BoundsTask {
  const Body& body;
  const Functional& functional;
  const Perturbation& perturbation;
  bool plane_strain;
};

/// The quantity of mesh.adapt in words: "K_I at the end of crack \"c\"". `curved`: mesh.curved.
std::string in_words(const GoalRequest& goal, const Shape& shape, bool curved);

/// Relative half width of the interval of that quantity, and where a finer mesh narrows it. `own`: of the state. Throws
/// Error(Usage) where there is none.
Indicator goal_indicator(const BoundsTask& task, const GoalRequest& goal, const Model& model, const State& state,
                         const Indicator& own);

/// The stresses at a point.
struct BoundedStress {
  Bounded s_xx, s_yy, s_xy;
};
/// Of the points of a probe, in their order; `bounds` are those of the body's state.
std::vector<BoundedStress> bound_stresses(const BoundsTask& task, const Model& model, const std::vector<Vec2>& points,
                                          const QuantityBounds& bounds);

/// What [bounds] asks for, of the body that `adapted` is a solution of. Solves again where cracks that may touch are
/// open everywhere: what it says then is of open cracks, and not guaranteed.
BoundsResult bound_quantities(const BoundsTask& task, const BoundsRequest& request, const Adapted& adapted,
                              int threads);

}  // namespace kerf
