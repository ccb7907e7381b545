// Where the tip of a crack is, which way it points, how far it is from everything else, and the ring around it that an
// energy release rate is integrated over.

#include "io/case/tip.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

double distance(const Vec2& x, const Loop& loop, double chord, double longest) {
  const Polygon p = flatten(loop, chord, longest);
  double least = infinity;
  for (std::size_t i = 0; i < p.points.size(); ++i)
    least = std::min(least, kerf::distance(x, p.points[i], p.points[(i + 1) % p.points.size()]));
  return least;
}

/// To the pieces first, first + 1, ..., last - 1 of a polyline, or to an arc.
double distance(const Vec2& x, const Crack& crack, std::size_t first, std::size_t last) {
  double least = infinity;
  if (!crack.arc) {
    for (std::size_t i = first; i < last; ++i)
      least = std::min(least, kerf::distance(x, crack.points[i], crack.points[i + 1]));
    return least;
  }
  const Arc& arc = *crack.arc;
  for (const Vec2& end : crack.points) least = std::min(least, (x - end).norm());
  if (faces(arc, x)) least = std::min(least, std::abs((x - arc.center).norm() - arc.axes.col(0).norm()));
  return least;
}

}  // namespace

TipPlace crack_tip(const Shape& shape, Index crack, bool at_start) {
  const auto number = static_cast<std::size_t>(crack);
  const Crack& own = shape.cracks[number];
  const std::size_t last = own.points.size() - 1;
  TipPlace tip;
  tip.at = at_start ? own.points.front() : own.points.back();
  if (own.arc) {
    const double t = at_start ? own.arc->from : own.arc->to;
    const double way = (own.arc->to > own.arc->from) == at_start ? -1 : 1;
    tip.direction = way * Vec2(-std::sin(t), std::cos(t));
  } else {
    tip.direction = (tip.at - own.points[at_start ? 1 : last - 1]).normalized();
  }

  const double size = extent(shape);
  tip.clearance = infinity;
  const auto consider = [&](double d, const std::string& what) {
    if (d < tip.clearance) tip.clearance = d, tip.nearest = what;
  };
  consider(distance(tip.at, shape.outline, 1e-7 * size, size), "the outline");
  for (const Loop& hole : shape.holes)
    consider(distance(tip.at, hole, 1e-7 * size, size), "hole \"" + hole.name + "\"");
  for (const Loop& region : shape.regions)
    consider(distance(tip.at, region, 1e-7 * size, size), "region \"" + region.name + "\"");
  const Vec2 other = at_start ? own.points.back() : own.points.front();
  consider((tip.at - other).norm(), "its other end");
  for (std::size_t k = 0; k < shape.cracks.size(); ++k)
    if (k != number)
      consider(distance(tip.at, shape.cracks[k], 0, shape.cracks[k].points.size() - 1),
               "crack \"" + shape.cracks[k].name + "\"");
  if (!own.arc && last > 1) consider(distance(tip.at, own, at_start ? 1 : 0, at_start ? last : last - 1), "its kink");

  // A fifth of half the crack's length, half of what is free, and of an arc a tenth of its radius: the fields of a tip
  // are those of a straight crack in a body without other sides.
  double outer = std::min(0.2 * 0.5 * path_length(own), 0.5 * tip.clearance);
  if (own.arc) outer = std::min(outer, 0.1 * own.arc->axes.col(0).norm());
  tip.ring = {0.3 * outer, outer};
  return tip;
}

}  // namespace kerf
