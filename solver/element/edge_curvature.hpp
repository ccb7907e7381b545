#pragma once
// Curved edges of cells: polynomials of degree k + 1, 4 at most, that are tangent to the true curve at their ends.

#include "kerf/element.hpp"
#include "kerf/mesh.hpp"

#include <array>
#include <vector>

namespace kerf {

/// x(s) = chord(s) + s (1 - s) (q[0] + q[1] s + q[2] s^2) for s from 0 to 1 along the edge's own direction.
struct EdgeCurvature {
  std::array<Vec2, 3> q = {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
};
inline Vec2 height(const EdgeCurvature& b, double s) {
  return b.q[0] + s * (b.q[1] + s * b.q[2]);
}
inline Vec2 height_slope(const EdgeCurvature& b, double s) {
  return b.q[1] + 2 * s * b.q[2];
}

/// Of degree 2, 3 or (above) 4, for a piece of an ellipse: farther from it than rounding by O(h^(2 degree))
/// [theory: E.24].
EdgeCurvature curvature_of(const Arc& piece, int degree);

/// The curved edges of a mesh as an element sees them.
struct EdgeCurvatures {
  std::vector<EdgeCurvature> all;
  std::vector<Index> of;  // per edge its place in `all` or none; empty when all edges are straight
};
/// Throws Error(Usage) for an element whose cells are straight, Error(Numerics) that names the place where a cell
/// folds.
EdgeCurvatures curvatures_of(const Mesh& mesh, const Element& e);
const EdgeCurvature* curvature_at(const EdgeCurvatures& curvatures, Index edge);

/// A point of an edge of the mesh, what a step of s is there (dx/ds), in the edge's direction.
struct OnEdge {
  Vec2 x, slope;
};
/// The slope is that of the polynomial where the edge is curved, the chord otherwise; |slope| is the length per unit of
/// s.
OnEdge on_edge(const Mesh& mesh, const EdgeCurvatures& curvatures, Index edge, double s);
/// The normal there times |dx/ds|, on the side of `towards`.
inline Vec2 normal_at(const OnEdge& p, const Vec2& towards) {
  const Vec2 n(p.slope.y(), -p.slope.x());
  return n.dot(towards) < 0 ? Vec2(-n) : n;
}

}  // namespace kerf
