#pragma once
// What is carved: a frame, a mesh of it, and which side of the frame each edge of the mesh's boundary lies on.

#include "geometry/carve.hpp"
#include "geometry/shape/drawing.hpp"

namespace kerf {

/// Which strand of the frame's loops an edge of the mesh lies on. Strands are those of `drawing`, the body on their
/// left; strand k is side `side[k]` of its loop, run backwards when the loop is `reversed`.
struct Rim {
  Drawing drawing;
  std::vector<Index> strand;   // per edge of the mesh; none inside
  std::vector<Index> side;     // per strand
  std::vector<bool> reversed;  // per loop of the frame, the outline first
  std::vector<bool> corner;    // per vertex of the mesh: where two strands meet
  std::vector<Index>
      next_edge;  // per vertex of the mesh on the boundary: the edge that leaves it, the body on its left
};
/// Throws std::invalid_argument when the mesh is not one of the frame.
Rim find_rim(const Shape& frame, const Mesh& mesh);

/// Boundary edges leave their vertex with the body on their left.
std::array<Index, 2> ends_of(const Mesh& mesh, Index boundary_edge);

struct Block {
  const Shape& frame;
  const Mesh& mesh;
  const Rim& rim;
  const Carving& how;
};

bool has(const std::vector<Index>& labels, Index label);

/// A place in the notes of a carving.
std::string text(const Vec2& x);

}  // namespace kerf
