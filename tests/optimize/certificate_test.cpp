// Prices and margins of a tie under uniform tension, whose values are known.

#include "optimize/level_set/certificate.hpp"

#include "topo/bump.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::certificate_test {
namespace {

// s^2/E: what the compliance loses per area that a side of the tie gains. A hole costs three times that [Kirsch].
constexpr double density = 4.5;

/// [0, 2] x [0, 1] held at the left, pulled by 3 at the right where there is a body.
Problem canvas() {
  Problem p;
  p.frame.labels = {"side", "right", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  p.frame.outline.sides[1].label = 1;
  p.frame.outline.sides[3].label = 2;
  p.scene.material = plane_stress(2, 0);
  p.plane_strain = false;
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{.label = 1, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {3, 0}; }}};
  p.sizing.size = 0.1;
  p.objective = {"compliance", {compliance()}};
  return p;
}

/// A strip of half thickness 0.2 in it, its two long sides drawn by the design.
Shape tie(const Problem& p) {
  Shape shape = p.frame;
  shape.labels.push_back("design");
  shape.outline = polygon("outline", {{0, 0.3}, {2, 0.3}, {2, 0.7}, {0, 0.7}}, 3);
  shape.outline.sides[1].label = 1;
  shape.outline.sides[3].label = 2;
  return shape;
}

OptimizeRequest limited(double volume) {
  OptimizeRequest r;
  r.volume_at_most = volume;
  return r;
}

TEST(Certificate, TheWholeAreaHasThePriceOfItsSides) {
  const Problem p = canvas();
  const OptimizeRequest r = limited(0.4);
  const Ground g = make_ground(p, r);
  const Evaluated e = evaluate_design(p, r, tie(p), {});
  const Prices prices = prices_of(g, e);
  EXPECT_NEAR(prices.area, density, 1e-6);
  const HoleMargin holes = hole_margin(g, e, prices);
  EXPECT_NEAR(holes.least, 2, 1e-6);
  const BumpMargin bumps = bump_margin(g, e, prices);
  EXPECT_NEAR(bumps.least, 1 - bump_share, 1e-6);
  // Beside the boundary nothing is said, in the middle there is a number.
  for (std::size_t t = 0; t < holes.margin.size(); ++t) {
    const Vec2 x = centroid(*holes.mesh, static_cast<Index>(t)),
               away(1 - std::abs(x.x() - 1), 0.2 - std::abs(x.y() - 0.5));
    if (away.minCoeff() < 0.99 * g.size) {
      EXPECT_TRUE(std::isnan(holes.margin[t])) << x.transpose();
    } else if (away.x() > 0.5) {
      EXPECT_TRUE(std::isfinite(holes.margin[t])) << x.transpose();
    }
  }
}

TEST(Certificate, RoomForMoreAreaCostsNothing) {
  const Problem p = canvas();
  const OptimizeRequest r = limited(0.8);
  EXPECT_EQ(prices_of(make_ground(p, r), evaluate_design(p, r, tie(p), {})).area, 0);
}

// The area is J: a bound on the compliance that binds costs area per compliance, one that does not costs nothing, and
// then a hole is worth all of its area.
TEST(Certificate, ABoundThatBindsHasAPrice) {
  Problem p = canvas();
  OptimizeRequest r;
  FunctionalBound bound;
  bound.functional = p.objective;
  p.objective = {"volume", {volume()}};
  const double compliance = density * 0.8;
  for (const bool binds : {true, false}) {
    bound.at_most = binds ? compliance : 2 * compliance;
    r.bounds = {bound};
    const Ground g = make_ground(p, r);
    const Evaluated e = evaluate_design(p, r, tie(p), {});
    EXPECT_NEAR(e.bounds[0], compliance, 1e-9);
    const Prices prices = prices_of(g, e);
    EXPECT_NEAR(prices.bound[0], binds ? 1 / density : 0, 1e-6);
    EXPECT_EQ(prices.area, 1);
    EXPECT_NEAR(hole_margin(g, e, prices).least, binds ? 2 : -1, 1e-6);
    EXPECT_NEAR(bump_margin(g, e, prices).least, binds ? 1 - bump_share : 1, 1e-6);
  }
}

// What is promised of the best hole comes true when it is made; where none pays, nothing is promised.
TEST(Certificate, TheBestHoleGainsWhatItPromises) {
  Problem p = canvas();
  p.sizing.size = 0.05;
  const OptimizeRequest r = limited(0.4);
  const Ground g = make_ground(p, r);
  const Evaluated e = evaluate_design(p, r, tie(p), {});
  Prices prices = prices_of(g, e);
  EXPECT_EQ(best_hole(g, e, prices, hole_margin(g, e, prices)).gain, 0);
  prices.area = 4 * density;  // a hole costs three times what a side does
  const BestChange best = best_hole(g, e, prices, hole_margin(g, e, prices));
  ASSERT_GT(best.gain, 0);
  EXPECT_NEAR(best.at.y(), 0.5, 0.03);
  EXPECT_LE(best.radius, 0.2 / 3);
  Shape with = tie(p);
  with.holes.push_back(circle("hole", best.at, best.radius, 3));
  Problem fine = p;
  fine.sizing.size = 0.02;
  const double before = evaluate_design(fine, r, tie(p), {}).J, after = evaluate_design(fine, r, with, {}).J,
               gained = prices.area * pi * best.radius * best.radius - (after - before);
  EXPECT_NEAR(best.gain * std::abs(e.J), gained, 0.05 * gained);
  // A gap that is asked for leaves no room.
  OptimizeRequest wide = r;
  wide.level_set.min_gap = 0.2;
  const Ground narrow = make_ground(p, wide);
  EXPECT_EQ(best_hole(narrow, e, prices, hole_margin(narrow, e, prices)).gain, 0);
}

// A half disc is worth what a layer of its area is, times the share of it [theory: L.13].
TEST(Certificate, BumpsGainWhereMaterialIsCheap) {
  const Problem p = canvas();
  const OptimizeRequest r = limited(0.4);
  const Ground g = make_ground(p, r);
  const Evaluated e = evaluate_design(p, r, tie(p), {});
  Prices prices = prices_of(g, e);
  EXPECT_EQ(best_bump(g, e, prices).gain, 0);
  prices.area = 0.5 * bump_share * density;
  const BestChange best = best_bump(g, e, prices);
  EXPECT_NEAR(best.gain * std::abs(e.J), 0.25 * pi * best.radius * best.radius * bump_share * density, 1e-6);
  // In the middle of a side, as wide as the side.
  EXPECT_NEAR(best.at.x(), 1, 0.1);
  EXPECT_NEAR(best.radius, 1, 0.1);
}

TEST(Certificate, NoBumpsUnderBodyForcesAndOfDensities) {
  Problem p = canvas();
  const OptimizeRequest r = limited(0.4);
  const Shape shape = tie(p);
  const auto least = [&](const Problem& q, const OptimizeRequest& request) {
    const Ground g = make_ground(q, request);
    const Evaluated e = evaluate_design(q, request, shape, {});
    Prices prices = prices_of(g, e);
    prices.bound.assign(prices.bound.size(), 1);
    return bump_margin(g, e, prices).least;
  };
  Problem heavy = p;
  heavy.scene.body = [](const Vec2&) { return Vec2(0, -1e-3); };
  EXPECT_TRUE(std::isnan(least(heavy, r)));
  Problem moved = p;
  moved.objective = {"displacement", {displacement_tracking({}, {})}};
  EXPECT_TRUE(std::isnan(least(moved, r)));
  OptimizeRequest bounded = r;
  bounded.bounds.resize(1);
  bounded.bounds[0].functional = moved.objective;
  bounded.bounds[0].at_most = 1e3;
  EXPECT_TRUE(std::isnan(least(p, bounded)));
  EXPECT_TRUE(std::isfinite(least(p, r)));
}

// Beside the tips of a crack nothing is said, nor in what stays solid. The crack lies along the stress and changes
// nothing.
TEST(Certificate, NothingIsSaidBesideTipsAndInFrozenParts) {
  Problem p = canvas();
  p.frame.cracks = {{"c", {Vec2(0.9, 0.5), Vec2(1.1, 0.5)}, {}}};
  p.scene.laws.resize(1);
  OptimizeRequest r = limited(0.4);
  r.level_set.frozen = {polygon("pad", {{1.4, -0.1}, {2.1, -0.1}, {2.1, 1.1}, {1.4, 1.1}}, none)};
  const Ground g = make_ground(p, r);
  Shape shape = tie(p);
  shape.cracks = p.frame.cracks;
  const Evaluated e = evaluate_design(p, r, shape, {0});
  const HoleMargin holes = hole_margin(g, e, prices_of(g, e));
  int said = 0;
  for (std::size_t t = 0; t < holes.margin.size(); ++t) {
    if (std::isnan(holes.margin[t])) continue;
    ++said;
    const Vec2 x = centroid(*holes.mesh, static_cast<Index>(t));
    EXPECT_LT(x.x(), 1.4);
    for (const Vec2& tip : p.frame.cracks[0].points) EXPECT_GE((x - tip).norm(), 2 * g.size);
  }
  EXPECT_GT(said, 20);
}

}  // namespace
}  // namespace kerf::certificate_test
