#pragma once
// Error bars at points, from a better solution [theory: R.9].

#include "solver/recover_stress.hpp"

namespace kerf {

/// Half widths of error bars: the true value is expected within value +- half width.
struct ErrorBars {
  Eigen::VectorXd at_corners, at_centroids;
  Eigen::VectorXd around;  // per corner: what the two solutions typically differ by around it
};

/// The better solution comes from `better_element` on triangulate(shape, sizing, {&mesh, better_sizes(...)}), the size
/// and the edges of `mesh` times longer_edges: as many unknowns as the solution itself has, which the higher degree
/// makes up for. But edges are 8 times shorter at singular corners, whose error reaches everywhere and which a higher
/// degree alone hardly helps, and 4 times shorter along curved sides and cracks, whose polygons err alike for all
/// degrees. Throws Error(Usage) when there is no better element.
const Element& better_element(const Element& e);
double longer_edges(const Element& own);
std::vector<double> better_sizes(const Mesh& mesh, const Corners& corners, const std::vector<bool>& singular,
                                 double longer = 1);

/// Where the two solutions are compared: for every corner a point of one of its triangles next to it, then the
/// centroids. `better`: triangles of the better mesh.
struct Places {
  std::vector<Vec2> x;
  std::vector<Index> own, better;
};
Places places(const Mesh& mesh, const Corners& corners, const Mesh& better);

/// From a quantity (a topological derivative, a component of the stress) of the two solutions at the places, each from
/// its recovered_at: the larger of 1.5 |difference| and 1.3 times its typical size in two rings of triangles, for
/// points where the difference changes sign. Right where the better solution's error is less than a third; no
/// guarantee: the factors cover 95 % of the points of known exact solutions, tests/solver/error_bars_test.cpp.
ErrorBars error_bars(const Corners& corners, const Eigen::VectorXd& values, const Eigen::VectorXd& better);

/// The half width at a point where the two solutions differ by `difference`.
double half_width_at(const Mesh& mesh, const Corners& corners, const ErrorBars& bars, const PointIn& at,
                     double difference);

}  // namespace kerf
