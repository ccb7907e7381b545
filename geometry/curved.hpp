#pragma once
// Sides that meshes draw by chords.

#include "kerf/mesh.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// The arcs of outline, holes, regions and cracks.
std::vector<Arc> arcs_of(const Shape& shape);

/// The mesh with chords in place of its curved edges.
Mesh with_chords(const Mesh& mesh);

/// What intervals of its mesh are for a shape with arcs.
inline constexpr const char* of_polygon = "the interval is that of the polygon that the mesh makes of curved sides";

}  // namespace kerf
