#pragma once
// The part of a mesh that one of several processes works on, divided further than the mesh is anywhere as a whole.

#include "kerf/mesh.hpp"

namespace kerf {

/// Own triangles come first; behind them those of other processes that shared a vertex with them before they were
/// divided, and what lies beyond a crack from these. Vertices keep their order, and with it every edge its direction:
/// on all processes the same.
struct MeshPart {
  Mesh mesh;
  Index own = 0;                          // triangles
  std::vector<Index> process;             // per triangle, whose it is
  std::vector<std::vector<double>> from;  // per crack and edge of Mesh::cracks: how far along all chords it begins
  std::vector<double> whole;              // per crack the length of its path
  /// Per process: own triangles that it has, too; triangles here that are its own. In the same order on both sides.
  std::vector<std::vector<Index>> shown, seen;
  std::vector<Index> origin = {};  // per triangle that of the undivided mesh which it is a part of
};

/// What process `here` has of `coarse`, whose triangles belong to `process`; every triangle then divided into four,
/// `times` times (kerf/mesh.hpp refine).
MeshPart mesh_part(const Mesh& coarse, const std::vector<Index>& process, int count, Index here, int times);

}  // namespace kerf
