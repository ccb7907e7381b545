#pragma once
// Sides that meshes draw by chords.

#include "kerf/shape.hpp"

namespace kerf {

/// The arcs of outline, holes, regions and cracks.
std::vector<Arc> arcs_of(const Shape& shape);

/// What intervals of its mesh are for a shape with arcs.
inline constexpr const char* of_polygon = "the interval is that of the polygon that the mesh makes of curved sides";

}  // namespace kerf
