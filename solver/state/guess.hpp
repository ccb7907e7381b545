#pragma once
// A first set for contact from what the faces do on another mesh.

#include "solver/system.hpp"

namespace kerf {

/// Per row in contact; nothing for no guess.
std::vector<Motion> motions_of(const Mesh& mesh, const Skeleton& s, const Ordering& o, const Kernel& k,
                               const ContactGuess& guess);

}  // namespace kerf
