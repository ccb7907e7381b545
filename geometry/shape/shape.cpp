// Shapes: constructors of loops and cracks, lengths and areas, polygons of loops within a chord error, the extent (the
// diagonal of the box around the outline).
// The extent of an arc x(t) = c + A (cos t, sin t) is at its ends or where a component of x' is 0: t = atan2(A_k2,
// A_k1) + n pi for component k. A piece of turn s on a circle of radius r lies r (1 - cos(s/2)) off its chord, and is
// at most r s long; for an ellipse r is the larger semi-axis, which is safe.

#include "kerf/shape.hpp"

#include "geometry/shape/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Values of t in the arc's range where a coordinate of x(t) is extreme.
template <class Visit>
void each_extreme(const Arc& arc, Visit&& visit) {
  const auto [low, high] = std::minmax(arc.from, arc.to);
  for (int axis = 0; axis < 2; ++axis) {
    const double t0 = std::atan2(arc.axes(axis, 1), arc.axes(axis, 0));
    for (double t = t0 + pi * std::ceil((low - t0) / pi); t <= high; t += pi) visit(t);
  }
}

}  // namespace

Loop circle(std::string name, const Vec2& center, double radius, Index label) {
  return ellipse(std::move(name), center, Vec2(radius, radius), 0, label);
}

Loop ellipse(std::string name, const Vec2& center, const Vec2& semi_axes, double angle_rad, Index label) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Arc arc{center, Mat2{{c * semi_axes.x(), -s * semi_axes.y()}, {s * semi_axes.x(), c * semi_axes.y()}}, 0, 2 * pi};
  const Vec2 start = center + arc.axes.col(0);
  return {std::move(name), {{start, label, arc}}};
}

Loop polygon(std::string name, const std::vector<Vec2>& points, Index label) {
  Loop loop{std::move(name), {}};
  for (const Vec2& p : points) loop.sides.push_back({p, label, std::nullopt});
  return loop;
}

Crack arc_crack(std::string name, const Vec2& center, double radius, double from_rad, double to_rad) {
  const Arc arc{center, radius * Mat2::Identity(), from_rad, to_rad};
  return {std::move(name), {at(arc, from_rad), at(arc, to_rad)}, arc};
}

double path_length(const Crack& crack) {
  if (crack.arc) return length(*crack.arc);
  double sum = 0;
  for (std::size_t i = 1; i < crack.points.size(); ++i) sum += (crack.points[i] - crack.points[i - 1]).norm();
  return sum;
}

double area(const Shape& shape) {
  double sum = std::abs(signed_area(shape.outline));
  for (const Loop& hole : shape.holes) sum -= std::abs(signed_area(hole));
  return sum;
}

/// Counter-clockwise whatever the loop's own direction, labels going with their pieces.
Polygon flatten(const Loop& loop, double chord, double longest) {
  if (!(chord > 0) || !(longest > 0))
    throw Error(Fault::Geometry,
                fmt::format("'{}': the chord error and the longest piece must be positive", loop.name));
  Polygon polygon;
  for (const Side& side : loop.sides) {
    polygon.points.push_back(side.start);
    polygon.label.push_back(side.label);
    if (!side.arc) continue;
    const Arc& arc = *side.arc;
    const double radius = largest_radius(arc);
    // The chord's distance is at most radius (1 - cos(step / 2)), the piece's length at most radius step.
    const double step = std::min({pi / 3, longest / radius, 2 * std::acos(std::max(0.5, 1 - chord / radius)),
                                  // acos loses its digits near 1
                                  chord < 1e-8 * radius ? std::sqrt(8 * chord / radius) : pi});
    const double count = std::ceil(std::abs(arc.to - arc.from) / step * (1 - 1e-12));
    if (!(count <= 1e7))
      throw Error(Fault::Geometry,
                  fmt::format("'{}': an arc would need {:g} pieces; allow a larger chord error", loop.name, count));
    for (int i = 1; i < int(count); ++i) {
      polygon.points.push_back(at(arc, arc.from + (arc.to - arc.from) * i / count));
      polygon.label.push_back(side.label);
    }
  }
  if (signed_area(loop) < 0) {
    std::reverse(polygon.points.begin(), polygon.points.end());
    // Piece i now runs between what were the points of piece n - 2 - i.
    std::reverse(polygon.label.begin(), polygon.label.end());
    std::rotate(polygon.label.begin(), polygon.label.begin() + 1, polygon.label.end());
  }
  return polygon;
}

double extent(const Shape& shape) {
  Vec2 low = Vec2::Constant(infinity), high = -low;
  const auto see = [&](const Vec2& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  };
  for (const Side& side : shape.outline.sides) {
    see(side.start);
    if (side.arc) each_extreme(*side.arc, [&](double t) { see(at(*side.arc, t)); });
  }
  return shape.outline.sides.empty() ? 0 : (high - low).norm();
}

}  // namespace kerf
