#pragma once
// Triangles cut in four, again and again, in the coordinates of the first one.

#include "base/quadrature.hpp"

#include <array>

namespace kerf {

using Vertices = std::array<Vec2, 3>;

/// Those at the corners, in their order, and the one in the middle.
std::array<Vertices, 4> quarters(const Vertices& corners);
/// The points of a rule.
Points places(const TriangleRule& rule, const Vertices& corners);

}  // namespace kerf
