// Arcs x(t) = center + axes (cos t, sin t), circles and ellipses. The semi-axes are the singular values of `axes`:
// their sum and difference squared are |axes|^2 +- 2 |det|.

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

Vec2 at(const Arc& arc, double t) {
  return arc.center + arc.axes * Vec2(std::cos(t), std::sin(t));
}

Vec2 velocity(const Arc& arc, double t) {
  return arc.axes * Vec2(-std::sin(t), std::cos(t));
}

double determinant(const Arc& arc) {
  return cross(arc.axes.col(0), arc.axes.col(1));
}

double largest_radius(const Arc& arc) {
  const double sum = arc.axes.squaredNorm(), product = 2 * std::abs(determinant(arc));
  return (std::sqrt(std::max(0.0, sum + product)) + std::sqrt(std::max(0.0, sum - product))) / 2;
}

double smallest_radius(const Arc& arc) {
  return std::abs(determinant(arc)) / largest_radius(arc);
}

double length(const Arc& arc) {
  return largest_radius(arc) * std::abs(arc.to - arc.from);
}

std::vector<Vec2> points_on(const Arc& arc, int n) {
  std::vector<Vec2> points;
  for (int i = 0; i <= n; ++i) points.push_back(at(arc, arc.from + (arc.to - arc.from) * i / n));
  return points;
}

double parameter(const Arc& arc, const Vec2& x) {
  const Vec2 d = x - arc.center, p = arc.axes.col(0), q = arc.axes.col(1);
  const double whole = cross(p, q);
  return std::atan2(cross(p, d) / whole, cross(d, q) / whole);
}

Vec2 onto(const Arc& arc, const Vec2& x) {
  return at(arc, parameter(arc, x));
}

double beyond_middle(const Arc& arc, const Vec2& x) {
  const Vec2 d = x - arc.center, p = arc.axes.col(0), q = arc.axes.col(1);
  const double turn = arc.to - arc.from, t = std::atan2(d.dot(q), d.dot(p));
  return std::remainder(t - arc.from - turn / 2, 2 * pi);
}

bool faces(const Arc& arc, const Vec2& x) {
  const Vec2 out = x - arc.center;
  const double low = std::min(arc.from, arc.to), turn = 2 * pi;
  const double angle = std::fmod(std::fmod(std::atan2(out.y(), out.x()) - low, turn) + turn, turn);
  return angle <= std::abs(arc.to - arc.from);
}

/// At half a turn the sign of the angle is rounding: counter-clockwise then.
Arc arc_between(const Vec2& a, const Vec2& b, const Vec2& given) {
  const Vec2 along = (b - a).normalized();
  const Vec2 center = given + along * along.dot(0.5 * (a + b) - given);
  const Vec2 p = a - center, q = b - center;
  double turn = std::atan2(cross(p, q), p.dot(q));
  if (std::abs(turn) > pi - 1e-6) turn = std::abs(turn);
  const double from = std::atan2(p.y(), p.x());
  return {center, p.norm() * Mat2::Identity(), from, from + turn};
}

}  // namespace kerf
