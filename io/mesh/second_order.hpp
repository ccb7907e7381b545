#pragma once
// Curves from meshes of second order: what the nodes in the middle of edges say.

#include "kerf/mesh.hpp"

#include <vector>

namespace kerf {

/// Nodes in the middle of edges. `at`: per edge, not a number where there is none. `chain`: per edge none where its
/// shape does not matter (inside the body); else edges that meet and have the same number may be one curve.
struct MiddleNodes {
  std::vector<Vec2> at;
  std::vector<Index> chain;
};

/// Sets Mesh::arc and Mesh::arcs of the edges that are bent, and says for each which curve it is a part of, or none.
/// Where all nodes of neighbors lie on a circle or an ellipse, that is the curve; any other edge becomes the piece of
/// an ellipse through its three nodes that has the same tangents as its neighbors [Farin 2002], as corners
/// between edges would be notches. Where the curve bends both ways within one edge, its chord stays.
std::vector<Index> bend(Mesh& mesh, const MiddleNodes& nodes, double extent);

}  // namespace kerf
