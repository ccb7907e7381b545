#pragma once
// From error indicators to the next mesh: target sizes for remeshing, or newest-vertex bisection.

#include "kerf/mesh.hpp"

namespace kerf {

/// What the next mesh should reach.
struct Goal {
  double error;                // square root of the sum of the squared indicators
  double order = 1;            // of convergence: an indicator's square falls like area h^(2 order)
  double max_triangles = 2e7;  // wins over the error
  double smallest = 0.125;     // change of a triangle's size in one round, between these two
  double largest = 4;
};

/// Target edge lengths at the vertices, for Background: the fewest triangles that reach the goal. `eta` holds one
/// indicator per triangle. Throws std::invalid_argument on numbers that make no sense.
std::vector<double> equidistributed_sizes(const Mesh& mesh, std::span<const double> eta, const Goal& goal);

/// Newest-vertex bisection takes vertex 0 of a triangle as its newest one and edge 0, opposite to it, as the edge to
/// halve. This turns the triangles of any mesh so that edge 0 is the longest (of equals the one of least number; with
/// `mirrored_tips` the same one in mirror images).
Mesh longest_edges_first(Mesh mesh, bool mirrored_tips = false);

/// The marked triangles halved, each at least once, and as many others as it takes that no edge ends in the middle of
/// another. Labels, cracks and arcs carry over; new vertices lie on the middles of edges, of curved ones on their arcs.
/// The descendants of a triangle, over all rounds, have at most four shapes, if the first mesh came from
/// longest_edges_first those of halved longest edges. `mirrored_tips`: where the mesh around a crack tip is its own
/// mirror image in the crack, it stays so.
Mesh bisect(const Mesh& mesh, std::span<const Index> marked, bool mirrored_tips = false);

}  // namespace kerf
