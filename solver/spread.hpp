#pragma once
// Error bars at points, from a better solution.

#include "solver/recover_stress.hpp"

namespace kerf {

/// A quantity at every corner and at the centroid of every triangle.
struct PointValues {
  Eigen::VectorXd at_corners, at_centroids;
};

/// Half widths of error bars: the true value is expected within value +- half width.
struct Spread {
  PointValues half_width;
  Eigen::VectorXd around;  // per corner: what the two solutions typically differ by around it
};

/// From a quantity (a topological derivative, a component of the stress) of a solution and of a better one on the same
/// mesh, both from recovered stresses: the larger of 2.1 |difference| and 1.6 times its typical size in two rings of
/// triangles, for points where the difference changes sign. Asymptotically right where the better solution converges
/// faster; next to it the factors leave room for the better one's error being about half of the first one's, as it is
/// where crack tips dominate both. Guarantees nothing: measured on exact solutions, tests/solver/spread_test.cpp. What
/// both solutions share, it does not see: polygons for curved sides, the mesh where a crack begins to touch.
Spread spread(const Corners& corners, const PointValues& values, const PointValues& better);

/// The half width at a point of triangle t where the two solutions differ by `difference`.
double half_width_at(const Mesh& mesh, const Corners& corners, const Spread& spread, Index t, const Vec2& x,
                     double difference);

/// An element that is one order better on the same mesh; 2.0 to 2.4 times the work for bdms 1. Throws Error(Usage) when
/// there is none.
const Element& better_element(const Element& e);

}  // namespace kerf
