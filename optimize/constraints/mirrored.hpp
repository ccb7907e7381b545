#pragma once
// Mirror images of points and of bodies.

#include "kerf/optimize.hpp"

namespace kerf {

/// The mirror image of a point.
inline Vec2 image_of(const Mirror& mirror, const Vec2& x) {
  const Vec2 along = mirror.direction.normalized(), d = x - mirror.point;
  return mirror.point + 2 * along.dot(d) * along - d;
}

/// The body that is what lies on one side of the line and its image; `side`: 1 for the left of its direction, -1. Loops
/// without drawn sides are the frame's own. Nothing where what lies there is no body, or not one.
std::optional<Shape> symmetric(const Shape& body, const Shape& frame, const Mirror& mirror, double side);

/// Whether tractions and supports of all scenes are their own mirror images, tractions up to their sign, at three
/// points of every side.
bool are_mirrored(const Shape& frame, const std::vector<Scene>& scenes, const Mirror& mirror);

}  // namespace kerf
