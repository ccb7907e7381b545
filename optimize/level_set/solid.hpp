#pragma once
// What of a design stays solid.

#include "optimize/level_set/background.hpp"

#include <string>
#include <vector>

#include <span>

namespace kerf {

/// Frozen loops, regions of other materials, strips of a `width` along loads and along what functionals look at, the
/// rings of functionals (named in a note), and the labels of supports.
Solid solid_parts(const Problem& p, const OptimizeRequest& r, double width, std::vector<std::string>& notes);

/// Corners of more than pi inside the body, between sides that bear nothing: no design needs them. Curved sides are
/// taken as chords no further than `chord` away.
std::vector<Vec2> sharp_corners(const Shape& frame, std::span<const Index> loaded, std::span<const Index> held,
                                double chord);

}  // namespace kerf
