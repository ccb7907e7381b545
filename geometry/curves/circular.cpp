// Ellipses and long arcs of a shape as chains of circular arcs of less than half a turn, for files that know no others.

#include "geometry/arc_chain.hpp"

#include "geometry/plane.hpp"

#include <cmath>

namespace kerf {

namespace {

constexpr double longest_turn = 0.95 * pi;  // of an arc of a loop of several sides: files say the shorter way round

bool is_circle(const Arc& arc) {
  const double radius = arc.axes.col(0).norm();
  return (arc.axes.transpose() * arc.axes - radius * radius * Mat2::Identity()).norm() <= 1e-12 * radius * radius;
}

/// The chain of an ellipse or of a part of it.
/// Knots may come as near to each other as an eighth of the smallest radius of curvature.
std::vector<Side> as_chain(const Side& side, double tolerance, bool whole) {
  const Arc& arc = *side.arc;
  const int n = 16 + int(128 * std::abs(arc.to - arc.from) / (2 * pi));
  ChainTrace trace{points_on(arc, n), whole, {}};
  trace.points.front() = side.start;
  if (whole) trace.points.pop_back();
  const double spacing = smallest_radius(arc) * smallest_radius(arc) / largest_radius(arc) / 8;
  std::vector<Side> all = sides(fit_arcs(trace, {tolerance, spacing}).chain, side.label);
  return all;
}

void add_parts(const Side& side, std::vector<Side>& out) {
  const Arc& arc = *side.arc;
  const int n = int(std::ceil(std::abs(arc.to - arc.from) / longest_turn));
  for (int k = 0; k < n; ++k) {
    Side part = side;
    part.arc->from = arc.from + (arc.to - arc.from) * k / n;
    part.arc->to = arc.from + (arc.to - arc.from) * (k + 1) / n;
    if (k > 0) part.start = at(*part.arc, part.arc->from);
    out.push_back(std::move(part));
  }
}

Loop circular(const Loop& loop, double tolerance, bool ellipses) {
  const bool whole = loop.sides.size() == 1;
  if (whole && (!ellipses || !loop.sides.front().arc || is_circle(*loop.sides.front().arc))) return loop;
  Loop out{loop.name, {}};
  for (const Side& side : loop.sides) {
    if (!side.arc) {
      out.sides.push_back(side);
    } else if (is_circle(*side.arc)) {
      add_parts(side, out.sides);
    } else {
      const std::vector<Side> chain = as_chain(side, tolerance, whole);
      out.sides.insert(out.sides.end(), chain.begin(), chain.end());
    }
  }
  return out;
}

}  // namespace

Shape circular(Shape shape, double tolerance, bool ellipses) {
  shape.outline = circular(shape.outline, tolerance, ellipses);
  for (Loop& hole : shape.holes) hole = circular(hole, tolerance, ellipses);
  if (ellipses)
    for (Loop& region : shape.regions) region = circular(region, tolerance, ellipses);
  return shape;
}

}  // namespace kerf
