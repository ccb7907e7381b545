#pragma once
// A first set for contact on many cracks.

#include "kerf/model.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// Each crack alone in an infinite body, under what the body without cracks has where it lies, on a mesh of that size:
/// for many cracks, whose coarser meshes are not much smaller. Straight ones without friction, gap and fluid; the
/// others are taken as closed. Throws as triangulate and prepare do. [theory: C.36]
ContactGuess lone_cracks_guess(const Shape& shape, const Element& e, const Scene& scene, double size, int threads);

}  // namespace kerf
