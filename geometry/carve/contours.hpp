#pragma once
// From the signs of a function at the vertices of a mesh to closed loops of boundary, and the cracks between them.

#include "geometry/carve/signs.hpp"

namespace kerf {

/// A point of the boundary of what is inside: the crossing of an edge, or a vertex on the frame's boundary.
struct ContourNode {
  Index edge = none, vertex = none;
};
/// Closed, what is inside on the left: node i to node i + 1 along the frame's `strand[i]`, or (none) the zero line.
struct Contour {
  std::vector<ContourNode> nodes;
  std::vector<Index> strand;
};
std::vector<Contour> contours(const Mesh& mesh, const Signs& signs, const Rim& rim);

/// Part of a crack between two places on its path.
struct CrackPart {
  Index crack;
  ContourNode from, to;  // an edge: cut there; neither: the crack's own end
  Crack shape;           // without a name
};
/// What lies inside, in the order of the cracks and along their paths; what is shorter than `least` is left out.
std::vector<CrackPart> cut_cracks(const Block& block, const Signs& signs, double least,
                                  std::vector<std::string>& notes);

}  // namespace kerf
