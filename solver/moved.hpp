#pragma once
// A body whose mesh moves while its topology stays.

#include "kerf/model.hpp"

namespace kerf {

/// `prepare` (kerf/model.hpp), bit for bit. Where `before` has the same triangles, cracks and supports, what follows
/// from these alone is taken over: the order and, unless somebody else holds it, memory and analysis of its factor.
Model prepare_moved(Mesh mesh, const Element& e, Scene scene, int threads, Model before);

}  // namespace kerf
