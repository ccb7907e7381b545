#pragma once
// A mesh cut along edges, and its edges halved: what the other rooms need beside kerf/mesh.hpp.

#include "kerf/mesh.hpp"

namespace kerf {

/// split_at_cracks with the edges in `cut` instead of all cracks.
Corners split_at(const Mesh& mesh, const std::vector<bool>& cut);

/// Connected pieces of the body when the edges with cut[e] are cut: a piece number per triangle, counted from 0.
std::vector<Index> pieces(const Mesh& mesh, const std::vector<bool>& cut);

/// The edges that mean something, in two where they have a middle: per edge its vertex, or none.
std::vector<Marked> halve_marked(const Mesh& mesh, const std::vector<Index>& middle);

}  // namespace kerf
