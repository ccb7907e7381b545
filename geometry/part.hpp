#pragma once
// Pieces of a mesh as meshes of their own, and balls put back into the holes made for them.

#include "geometry/ball.hpp"

namespace kerf {

/// Some triangles of a mesh. Vertices keep their relative order, and with it every edge its direction. Edges keep
/// labels and cracks; those where the piece was cut off have none.
struct Part {
  Mesh mesh;
  std::vector<Index> triangle, edge;  // of the whole, per triangle and edge of the part
};
Part part(const Mesh& whole, const std::vector<bool>& use);
/// The same without cracks, of which `use` may have one side alone.
Mesh part_without_cracks(Mesh whole, const std::vector<bool>& use);

/// The mesh of a body with ball_holes, the holes filled with their balls: the triangles of the body first, then those
/// of the balls in order. Throws std::invalid_argument when a ball's boundary is not in the mesh.
struct Filled {
  Mesh mesh;
  std::vector<Index> first_triangle;                     // per ball, one more at the end
  std::vector<std::vector<std::vector<Index>>> contour;  // per ball, BallMesh::contour in edges of the whole
};
Filled fill(const Mesh& outside, const std::vector<BallMesh>& balls);

}  // namespace kerf
