#pragma once
// Closed uniform cubic B-splines.

#include "kerf/types.hpp"

namespace kerf {

/// Weights of the control points first, first + 1, ... (cyclic) in the point at s of the spline and in its derivative
/// by s, which runs through the spans: s in [0, number of control points].
struct SplineWeights {
  Index first;
  Eigen::Vector4d position, derivative;
};
SplineWeights spline_weights(Index control_points, double s);

}  // namespace kerf
