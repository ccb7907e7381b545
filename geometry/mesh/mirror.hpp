#pragma once
// Where a mesh around a crack tip is its own mirror image in the crack; internal to this room.

#include "kerf/mesh.hpp"

namespace kerf {

/// Per triangle and edge its image, none where there is none; edges on the crack and straight ahead of it are their
/// own.
struct MirrorImages {
  std::vector<Index> triangle, edge;
};

/// From each tip outwards, as far as triangle answers triangle up to a twentieth of the length of an edge: patches bent
/// along an arc count while they hardly bend.
MirrorImages mirror_at_tips(const Mesh& mesh);

}  // namespace kerf
