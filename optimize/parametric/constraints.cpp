// What keeps designs of numbers meshable: least distances between drawn things, and from them to holes, cracks,
// regions, the outline and forbidden discs, as constraints 1 - distance/least <= 0 with their derivatives. Circles are
// exact. Other boundaries are sampled, and their distance is the soft minimum of (L.9), with derivatives by the
// variables of both. Pairs whose boxes keep apart, or one inside the other, for all variables are left out, so that the
// number of constraints stays small. A region keeps things on the side on which they start. What must hold of a shape
// by itself is in its own file (shapes/). docs/theory/level_set.md, section "Drawn designs".

#include "optimize/parametric/constraints.hpp"

#include "geometry/plane.hpp"
#include "kerf/optimize.hpp"
#include "optimize/parametric/followers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

using Eigen::VectorXd;

/// Something that has a boundary; `drawn`: number of what draws it, or none.
struct Thing {
  std::string name;
  Index drawn = none;
  std::function<DesignCurve(const VectorXd& v)> curve;
  std::function<DesignCurve(const VectorXd& v)> cut = {};  // of a crack, what counts against fixed things
  bool container = false;                                  // what is drawn stays inside
  CoordinateBox box = {};                                  // of it for all variables
};

// A circle has two axes of the same length at a right angle.
std::optional<DesignCurve> as_disc(const Loop& loop) {
  if (loop.sides.size() != 1 || !loop.sides[0].arc) return std::nullopt;
  const Arc& arc = *loop.sides[0].arc;
  const double r = arc.axes.col(0).norm();
  if (std::abs(arc.axes.col(1).norm() - r) > 1e-12 * r ||
      std::abs(arc.axes.col(0).dot(arc.axes.col(1))) > 1e-12 * r * r)
    return std::nullopt;
  return fixed_disc(arc.center, r);
}

CoordinateBox box_of(const DesignCurve& c) {
  CoordinateBox box{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
  if (c.disc) box = {c.center.array() - c.radius, c.center.array() + c.radius};
  for (const Vec2& x : c.points) {
    box.low = box.low.cwiseMin(x);
    box.high = box.high.cwiseMax(x);
  }
  return box;
}

Thing fixed(std::string name, DesignCurve curve) {
  Thing thing{.name = std::move(name), .box = box_of(curve)};
  thing.curve = [curve = std::move(curve)](const VectorXd&) { return curve; };
  return thing;
}

Thing fixed_loop(std::string name, const Loop& loop, double chord, double longest) {
  if (auto round = as_disc(loop)) return fixed(std::move(name), std::move(*round));
  return fixed(std::move(name), fixed_polyline(flatten(loop, chord, longest).points, true));
}

// An arc as chords no longer than `longest`, 16 at least.
DesignCurve path_of(const Crack& crack, double longest) {
  std::vector<Vec2> points = crack.points;
  if (crack.arc) {
    const int pieces = std::max(16, static_cast<int>(std::ceil(path_length(crack) / longest)));
    points = points_on(*crack.arc, pieces);
  }
  return fixed_polyline(std::move(points), false);
}

Thing drawn_thing(const Drawn& d, Index number) {
  const DrawnShape& shape = shape_of(d);
  return {.name = name(d),
          .drawn = number,
          .curve = [d, &shape](const VectorXd& v) { return shape.boundary(d, v, false); },
          .cut = [d, &shape](const VectorXd& v) { return shape.boundary(d, v, true); },
          .box = shape.box(d)};
}

// A sufficient test only: the gap along one of the axes.
bool always_apart(const Thing& a, const Thing& b, double least) {
  const Vec2 gap = (b.box.low - a.box.high).cwiseMax(a.box.low - b.box.high);
  return gap.maxCoeff() > least;
}

/// Whether a box lies farther than `least` inside a closed polygon or disc.
/// Corners inside and no side of the polygon within `least` of the box, or across it.
bool always_inside(const Thing& a, const DesignCurve& b, double least) {
  const std::array<Vec2, 4> corners = {a.box.low, Vec2(a.box.high.x(), a.box.low.y()), a.box.high,
                                       Vec2(a.box.low.x(), a.box.high.y())};
  if (b.disc)
    return std::ranges::all_of(corners, [&](const Vec2& x) { return (x - b.center).norm() + least < b.radius; });
  for (const Vec2& x : corners)
    if (!inside_polygon(b.points, x)) return false;
  // No side comes near the box.
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    const Vec2 &p = b.points[i], &q = b.points[(i + 1) % b.points.size()];
    if (p.x() > a.box.low.x() && p.x() < a.box.high.x() && p.y() > a.box.low.y() && p.y() < a.box.high.y())
      return false;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec2 &c = corners[k], &e = corners[(k + 1) % 4];
      if (std::min({segment_foot(c, p, q).distance, segment_foot(e, p, q).distance, segment_foot(p, c, e).distance,
                    segment_foot(q, c, e).distance}) <= least)
        return false;
      if (cross_inside(c, e, p, q)) return false;
    }
  }
  return true;
}

// c = 1 - d/least with dc = -dd/least, by the variables of both.
Constraint apart(const Thing& a, const Thing& b, double least, const std::string& what, const Design& d) {
  const std::vector<Eigen::Index> first = first_variables(d);
  const auto begin = [&](const Thing& t) { return t.drawn == none ? 0 : first[static_cast<std::size_t>(t.drawn)]; };
  const auto count = [&](const Thing& t) {
    return t.drawn == none ? 0 : d.drawn[static_cast<std::size_t>(t.drawn)].lower.size();
  };
  const Eigen::Index from_a = begin(a), from_b = begin(b), na = count(a), nb = count(b);
  // Soft minima are 1/40 of the distance wide [theory: L.9].
  const Apart how{.container = b.container, .width = least / sharpness, .by_a = na, .by_b = nb};
  return {what, [=](const VectorXd& x, VectorXd* gradient) {
            const VectorXd va = x.segment(from_a, na);
            const Distance r =
                distance_between(b.drawn == none ? a.cut(va) : a.curve(va), b.curve(x.segment(from_b, nb)), how);
            if (gradient) {
              gradient->setZero(x.size());
              gradient->segment(from_a, na) -= r.by_a / least;
              gradient->segment(from_b, nb) -= r.by_b / least;
            }
            // No distance, as of curves without points, is no violation.
            return std::isfinite(r.value) ? 1 - r.value / least : -1.0;
          }};
}

}  // namespace

std::vector<Constraint> constraints(const Design& d, const Problem& p, double least,
                                    const std::vector<Forbidden>& forbidden) {
  // Fixed arcs become chords that are a twentieth of the least distance off at most.
  const double longest = std::max(least, extent(p.frame) / 200), chord = least / 20;
  std::vector<Thing> others;
  others.push_back(fixed_loop("the outline", p.frame.outline, chord, extent(p.frame)));
  others.back().container = true;
  for (const Loop& hole : p.frame.holes)
    others.push_back(fixed_loop(fmt::format("hole '{}'", hole.name), hole, chord, longest));
  for (const Crack& crack : p.frame.cracks)
    others.push_back(fixed(fmt::format("crack '{}'", crack.name), path_of(crack, longest)));
  for (const Loop& region : p.frame.regions)
    others.push_back(fixed_loop(fmt::format("region '{}'", region.name), region, chord, longest));
  const std::size_t first_region = others.size() - p.frame.regions.size();
  for (const Forbidden& f : forbidden) others.push_back(fixed(f.name, fixed_disc(f.center, f.radius)));

  std::vector<Constraint> all;
  const std::vector<Eigen::Index> first = first_variables(d);
  std::vector<Thing> things;
  for (std::size_t k = 0; k < d.drawn.size(); ++k) things.push_back(drawn_thing(d.drawn[k], static_cast<Index>(k)));
  for (std::size_t k = 0; k < things.size(); ++k) {
    const Drawn& one = d.drawn[k];
    // What is fixed is an obstacle to others and has no constraint of its own.
    if (one.lower == one.upper) continue;
    const std::string apart_by = fmt::format("less than {:.4g} apart", least);
    for (std::size_t i = 0; i < others.size(); ++i) {
      Thing other = others[i];
      const DesignCurve curve = other.curve({});
      if (i >= first_region && i < first_region + p.frame.regions.size()) {
        const DesignCurve start = things[k].curve(one.start);
        // Inside a region or outside of it, as it starts.
        const Vec2 x = start.disc ? start.center : start.points.front();
        other.container = curve.disc ? (x - curve.center).norm() < curve.radius : inside_polygon(curve.points, x);
      }
      if (other.container ? always_inside(things[k], curve, least) : always_apart(things[k], other, least)) continue;
      all.push_back(
          apart(things[k], other, least, fmt::format("{} and {} are {}", things[k].name, other.name, apart_by), d));
    }
    for (std::size_t i = 0; i < things.size(); ++i) {
      if (i == k || (i < k && d.drawn[i].lower != d.drawn[i].upper)) continue;  // once per pair
      if (always_apart(things[k], things[i], least)) continue;
      all.push_back(apart(things[k], things[i], least,
                          fmt::format("{} and {} are {}", things[k].name, things[i].name, apart_by), d));
    }
    if (const auto constrain = shape_of(one).constrain) constrain(one, first[k], least, all);
  }
  return all;
}

}  // namespace kerf
