#pragma once
// Sides that meshes draw by chords.

#include "kerf/shape.hpp"

namespace kerf {

/// The arcs of outline, holes, regions and cracks.
std::vector<Arc> arcs_of(const Shape& shape);

}  // namespace kerf
