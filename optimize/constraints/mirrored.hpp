#pragma once
// Mirror images of points and of bodies.

#include "kerf/optimize.hpp"

namespace kerf {

/// The mirror image of a point.
inline Vec2 image_of(const Mirror& mirror, const Vec2& x) {
  const Vec2 along = mirror.direction.normalized(), d = x - mirror.point;
  return mirror.point + 2 * along.dot(d) * along - d;
}

}  // namespace kerf
