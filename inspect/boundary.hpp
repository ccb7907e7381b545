#pragma once
// Places along the boundary of a mesh: where a crack could begin, and how much room it has there.

#include "kerf/edge_cracks.hpp"

namespace kerf::inspect {

struct BoundaryPlace {
  Vec2 at = Vec2::Zero(), inward = Vec2::Zero();  // the tangent is `inward` turned by -90 degrees: the body to its left
  double curvature = 0;                           // positive: the body is convex
  Index edge = none, triangle = none;
  double length = 0;  // of the boundary that it stands for
  // Distances: along the boundary to the next corner that is none of the singular points, to the next of these, to the
  // end of what is held (0 on it), and across the body to the next side, crack or other material.
  double corner = infinity, singular = infinity, support = infinity, across = infinity;
  Index wedge = none;  // of a place that is a reentrant corner, its number
};

/// `count` places on every edge of the boundary, by the numbers of the edges; arcs of the mesh are followed, and chords
/// of curves have the curvature that they turn by.
std::vector<BoundaryPlace> places_along(const Model& model, int count);

/// Sides, cracks, borders of materials: what a crack may not come near.
bool is_feature(const Mesh& mesh, Index edge);
/// All of them as segments.
std::vector<std::array<Vec2, 2>> features(const Mesh& mesh);

}  // namespace kerf::inspect
