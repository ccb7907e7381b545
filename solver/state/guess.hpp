#pragma once
// A first set for contact from what the faces do on another mesh.

#include "solver/system.hpp"

namespace kerf {

/// Of a mesh that has parts of the cracks' paths alone: per crack how far along its path each of its edges begins, and
/// the length of the path (MeshPart, geometry/mesh_part.hpp).
struct PartOfPaths {
  const std::vector<std::vector<double>>& from;
  const std::vector<double>& whole;
};

/// Per row in contact; nothing for no guess.
std::vector<Motion> motions_of(const Mesh& mesh, const Skeleton& s, const Ordering& o, const Kernel& k,
                               const ContactGuess& guess, const PartOfPaths* part = nullptr);

}  // namespace kerf
