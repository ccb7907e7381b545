// Zones in which a largest stress is not looked for: where the stress of linear elasticity is infinite, or jumps, for
// every design. Along clamped sides a band, since designs meet them wherever they like; elsewhere discs. A corner is
// singular where the body fills more than reentrant_angle; where a design can cut it away it is none of its business to
// be left out. Ends of rollers are regular where the outline turns by a right angle or more: the mirror image goes on
// behind them. docs/theory/curves.md, section "Stress".

#include "optimize/stress_zones.hpp"

#include "geometry/plane.hpp"
#include "optimize/constraints/sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

/// What a side of the frame bears.
struct Borne {
  bool loaded = false, clamped = false, held = false;
  bool free() const {
    return !loaded && !held;
  }
};

Borne borne_by(const StressedBody& body, Index label) {
  Borne b;
  if (label == none) return b;
  b.loaded = std::ranges::find(body.loaded, label) != body.loaded.end();
  bool first = false, second = false;
  for (const Support& s : body.supports) {
    if (s.label != label) continue;
    b.held = true;
    first = first || s.first;
    second = second || s.second;
  }
  b.clamped = first && second;
  return b;
}

/// How the body turns at a corner between two sides, the body on the left: below 0 where it fills more than pi.
double turn_between(const DrawnSide& before, const DrawnSide& after) {
  const Vec2 a = tangent(before, 1), b = tangent(after, 0);
  return std::atan2(cross(a, b), a.dot(b));
}

class ZonesOfBody {
 public:
  ZonesOfBody(const StressedBody& body, const LargestStress& how)
      : body_(body), end_(how.ends * extent(body.shape)), band_(how.supports * extent(body.shape)) {}

  std::vector<StressZone> all() {
    of_loop(body_.shape.outline, false);
    for (const Loop& hole : body_.shape.holes) of_loop(hole, true);
    of_cracks();
    of_regions();
    return std::move(zones_);
  }

 private:
  void point(const Vec2& at, std::string what, bool support = false) {
    if (end_ > 0) zones_.push_back({at, at, end_, std::move(what), support});
  }
  std::string label(Index number) const {
    return fmt::format("\"{}\"", body_.shape.labels[static_cast<std::size_t>(number)]);
  }

  void of_loop(const Loop& loop, bool hole) {
    std::vector<DrawnSide> sides;
    add_sides(loop, hole, sides);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const DrawnSide &side = sides[i], &next = sides[(i + 1) % sides.size()];
      const Borne here = borne_by(body_, side.label), there = borne_by(body_, next.label);
      if (here.clamped && band_ > 0) along(side);
      of_corner(side, next, here, there);
    }
  }

  void along(const DrawnSide& side) {
    const int pieces = side.arc ? 32 : 1;
    for (int k = 0; k < pieces; ++k)
      zones_.push_back({at(side, double(k) / pieces), at(side, double(k + 1) / pieces), band_,
                        "support " + label(side.label), true});
  }

  void of_corner(const DrawnSide& side, const DrawnSide& next, const Borne& here, const Borne& there) {
    constexpr double right_angle = 0.5 * pi - 0.02;
    const double turn = turn_between(side, next);
    const bool ends = side.label != next.label;
    if (ends && (here.loaded || there.loaded))
      return point(side.b, "end of load " + label(here.loaded ? side.label : next.label));
    // Clamped ends are within the band already, unless that was taken away.
    const bool ends_support = ends && (here.held || there.held);
    if (ends_support && (here.clamped || there.clamped || turn < right_angle))
      return point(side.b, "end of support " + label(here.held ? side.label : next.label), true);
    if (pi - turn > reentrant_angle && (!(here.free() && there.free()) || stays_solid(side.b))) point(side.b, "corner");
  }

  /// Whether what the body has around the point is all frozen.
  bool stays_solid(const Vec2& x) const {
    constexpr int around = 16;
    const double reach = 1e-3 * extent(body_.shape);
    const Region whole(body_.shape);
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * pi * (k + 0.5) / around;
      const Vec2 y = x + reach * Vec2(std::cos(angle), std::sin(angle));
      if (!(whole.depth(y) > 0)) continue;
      if (std::ranges::none_of(body_.frozen, [&](const Loop& loop) { return Region(loop).depth(y) > 0; })) return false;
    }
    return true;
  }

  void of_cracks() {
    for (const Crack& crack : body_.shape.cracks) {
      const std::string what = fmt::format("crack \"{}\"", crack.name);
      for (const Vec2& x : crack.points) point(x, what);
    }
  }

  void of_regions() {
    constexpr double sharp = 0.3;
    for (const Loop& loop : body_.shape.regions) {
      std::vector<DrawnSide> sides;
      add_sides(loop, false, sides);
      for (std::size_t i = 0; i < sides.size(); ++i)
        if (std::abs(turn_between(sides[i], sides[(i + 1) % sides.size()])) > sharp)
          point(sides[i].b, fmt::format("corner of region \"{}\"", loop.name));
    }
  }

  const StressedBody& body_;
  double end_, band_;
  std::vector<StressZone> zones_;
};

}  // namespace

std::vector<StressZone> stress_zones(const StressedBody& body, const LargestStress& how) {
  return ZonesOfBody(body, how).all();
}

std::string zones_in_words(const LargestStress& what) {
  std::vector<std::string> all;
  for (const StressZone& zone : what.zones) {
    const bool band = (zone.b - zone.a).norm() > 0;
    std::string words =
        band ? fmt::format("{} within {:.3g}", zone.what, zone.radius)
             : fmt::format("{} at ({:.4g}, {:.4g}) within {:.3g}", zone.what, zone.a.x(), zone.a.y(), zone.radius);
    if (std::ranges::find(all, words) == all.end()) all.push_back(std::move(words));
  }
  return fmt::format("{}", fmt::join(all, ", "));
}

Functional with_zones(Functional j, const StressedBody& body) {
  for (Term& term : j.terms) {
    if (!term.largest) continue;
    LargestStress what = *term.largest;
    what.zones = stress_zones(body, what);
    Term again = max_stress(what);
    again.factor = term.factor;
    term = std::move(again);
  }
  return j;
}

}  // namespace kerf
