// Points and segments: nearest points, distances, crossings by the signs of four cross products.

#include "geometry/plane.hpp"

#include <algorithm>

namespace kerf {

double foot(const Vec2& x, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double squared = d.squaredNorm();
  return squared == 0 ? 0 : std::clamp((x - a).dot(d) / squared, 0.0, 1.0);
}

double distance(const Vec2& x, const Vec2& a, const Vec2& b) {
  return (a + foot(x, a, b) * (b - a) - x).norm();
}

double squared_distance(const Vec2& x, const Vec2& a, const Vec2& b) {
  return (a + foot(x, a, b) * (b - a) - x).squaredNorm();
}

std::optional<double> crossing(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double ca = cross(d - c, a - c), cb = cross(d - c, b - c);
  const double ac = cross(b - a, c - a), ad = cross(b - a, d - a);
  if ((ca > 0) == (cb > 0) || (ac > 0) == (ad > 0)) return {};
  return ca / (ca - cb);
}

bool cross_inside(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return cross(d - c, a - c) * cross(d - c, b - c) < 0 && cross(b - a, c - a) * cross(b - a, d - a) < 0;
}

}  // namespace kerf
