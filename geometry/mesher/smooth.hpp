#pragma once
// Better triangles from the same number of them.

#include "kerf/mesh.hpp"

namespace kerf {

struct Smoothed {
  std::vector<Vec2> points;                     // as many as before, in their order
  std::vector<std::array<Index, 3>> triangles;  // each in the region where it was
};

/// Lowers the sum over triangles of 1 / quality: the vertices off the boundary, cracks and interfaces move (one damped
/// Newton step each per sweep), edges that are none of these are flipped. No angle falls below `min_angle_deg`, or
/// further below it than it was.
Smoothed smooth(const Mesh& mesh, double min_angle_deg, int sweeps);

}  // namespace kerf
