// Whether a point lies inside polygons, by the even-odd rule along a ray to the right.

#include "geometry/plane.hpp"

namespace kerf {

bool crosses_ray(const Vec2& x, const Vec2& a, const Vec2& b) {
  return (a.y() > x.y()) != (b.y() > x.y()) && x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

bool inside(std::span<const Vec2> polygon, const Vec2& x) {
  bool odd = false;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    if (crosses_ray(x, polygon[i], polygon[i + 1 < polygon.size() ? i + 1 : 0])) odd = !odd;
  return odd;
}

bool inside(std::span<const std::array<Vec2, 2>> sides, const Vec2& x) {
  bool odd = false;
  for (const auto& [a, b] : sides)
    if (crosses_ray(x, a, b)) odd = !odd;
  return odd;
}

}  // namespace kerf
