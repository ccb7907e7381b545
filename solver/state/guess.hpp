#pragma once
// A first set for contact from what the faces do on another mesh.

#include "kerf/shape.hpp"
#include "solver/system.hpp"

namespace kerf {

/// Per row in contact; nothing for no guess.
std::vector<Motion> motions_of(const Mesh& mesh, const Skeleton& s, const Ordering& o, const Kernel& k,
                               const ContactGuess& guess);

/// Each crack alone in an infinite body, under what the body without cracks has where it lies, on a mesh of that size:
/// for many cracks, whose coarser meshes are not much smaller. Straight ones without friction, gap and fluid; the
/// others are taken as closed. Throws as triangulate and prepare do. [theory: C.36]
ContactGuess lone_cracks_guess(const Shape& shape, const Element& e, const Scene& scene, double size, int threads);

}  // namespace kerf
