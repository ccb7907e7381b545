#pragma once
// Points and segments.

#include "kerf/types.hpp"

namespace kerf {

/// Distance of x to the segment from a to b, which may be a point.
double distance(const Vec2& x, const Vec2& a, const Vec2& b);

}  // namespace kerf
