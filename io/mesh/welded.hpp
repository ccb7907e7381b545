#pragma once
// The triangles of a mesh file, checked and connected: nodes that lie in one place are one vertex.

#include "io/mesh/raw.hpp"
#include "kerf/mesh.hpp"

namespace kerf {

struct Welded {
  Mesh mesh;                  // triangles in the order of the file, counter-clockwise; no labels, cracks, regions
  std::vector<Index> vertex;  // per node of the file; none where no triangle has it
  std::vector<Index> node;    // per vertex, the first of its nodes
  std::vector<bool> doubled;  // per edge: its triangles have nodes of their own at one end at least
  double extent = 0;
};

/// Throws Error(Geometry) for no triangles, triangles without area, turned over (within one surface), with the same
/// corners, on the same side of an edge, and for edges with more than two.
Welded weld(const RawMesh& raw);

/// Throws Error(Geometry) for nodes that hang on an edge, edges of the rim that cross, triangles that overlap around a
/// node, several bodies, and a body that touches itself in a point.
void check_rim(const RawMesh& raw, const Welded& welded);

}  // namespace kerf
