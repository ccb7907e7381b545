#pragma once
// Points of nested hexagonal lattices, spaced by the size field, inside the body and clear of its pieces; internal to
// this room.

#include "geometry/mesher/size_field.hpp"

namespace kerf {

/// One lattice per size level (step a = cap, cap/2, cap/4, ...), used where h lies in (a/sqrt 2, sqrt 2 a]. No point is
/// nearer than 0.6 a to a piece, or inside a piece's diametral circle. In an order in which neighbors follow each
/// other. Throws Error(Geometry) when there would be more than `most` points.
std::vector<Vec2> lattice_points(const Drawing& drawing, const Pieces& pieces, const SizeField& field,
                                 std::size_t most);

}  // namespace kerf
