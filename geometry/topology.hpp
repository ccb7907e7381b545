#pragma once
// A mesh cut along edges, and its edges halved: what the other rooms need beside kerf/mesh.hpp.

#include "kerf/mesh.hpp"

namespace kerf {

/// split_at_cracks with the edges in `cut` instead of all cracks.
Corners split_at(const Mesh& mesh, const std::vector<bool>& cut);

/// Connected pieces of the body when the edges with cut[e] are cut: a piece number per triangle, counted from 0.
std::vector<Index> pieces(const Mesh& mesh, const std::vector<bool>& cut);

/// The middle of an edge, of a curved one on its arc.
Vec2 middle_of(const Mesh& mesh, Index edge);
/// The points of an edge in its direction, once it is halved so many times: those of `refine`, bit for bit.
std::vector<Vec2> divided_edge(const Mesh& mesh, Index edge, int divisions);
/// `mesh` with edges in two, each of which has its middle in `points`, behind those of `mesh`: per edge its number, or
/// none. Labels, cracks and arcs go on. Throws FoldedTriangle where a middle on an arc turns a triangle over.
Mesh halved(const Mesh& mesh, const std::vector<Index>& middle, std::vector<Vec2> points,
            std::vector<std::array<Index, 3>> triangles, std::vector<Index> region);

}  // namespace kerf
