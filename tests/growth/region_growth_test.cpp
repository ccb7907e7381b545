// Cracks that grow through regions. Truths from outside: a region of the body's own material and law changes nothing;
// the load and the life in a region of another law by its constants and a formula of K.

#include "geometry/plane.hpp"
#include "growth/life.hpp"
#include "kerf/growth.hpp"
#include "kerf/mesher.hpp"
#include "tests/support/dice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::region_growth_test {
namespace {

using namespace growth;

const auto fixed = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
constexpr Material body = plane_strain(1000, 0.3);

struct Body {
  Shape shape;
  Scene scene;
  Sizing sizing;
};
/// A rectangle about the origin on rollers, pulled at its top.
Body plate(double width, double height, Crack crack, double pull) {
  Body b;
  const double w = width / 2, h = height / 2;
  b.shape.outline = polygon("outline", {{-w, -h}, {w, -h}, {w, h}, {-w, h}}, 0);
  b.shape.labels = {"bottom", "right", "top", "left"};
  for (Index side = 0; side < 4; ++side) b.shape.outline.sides[static_cast<std::size_t>(side)].label = side;
  b.shape.cracks = {std::move(crack)};
  b.scene.material = body;
  b.scene.supports = {{0, false, false, true, fixed}};
  b.scene.tractions = {{2, [pull](const Vec2&, const Vec2&) { return Vec2(0, pull); }}};
  b.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  b.sizing = {.size = height / 12};
  return b;
}
Body with_region(Body b, Loop region, const Material& m) {
  b.shape.regions.push_back(std::move(region));
  b.scene.regions.push_back(m);
  return b;
}

Grown grown(const Body& b, const GrowRequest& request) {
  return grow(b.shape, b.sizing, bdms(2), b.scene, request, {});
}

bool says(const Grown& g, const std::string& words) {
  return std::ranges::any_of(g.notes, [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

const GrowthLaw paris{.form = Paris{1e-11, 3}};

// The life between bounds is that by the law of the region in which the crack lies; a path that crosses a border, at
// which rates jump, has no such bounds, nor has a cycle that is pushed by more than it is pulled.
TEST(GrowThroughRegions, BoundsOfALifeAreThoseOfTheRegionsLaw) {
  const Loop region = polygon("weld", {{-2, -1}, {2, -1}, {2, 1}, {-2, 1}}, none);
  const Body b = with_region(plate(10, 20, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1), region, body);
  GrowRequest request{.law = paris,
                      .regions = {{.region = 0, .law = GrowthLaw{.form = Paris{4e-11, 3}}}},
                      .tips = {{0, false}},
                      .step = 0.2,
                      .steps = 4,
                      .bounds = true};
  const Grown inside = grown(b, request);
  ASSERT_TRUE(inside.bounds);
  const double N = inside.steps.back().cycles;
  EXPECT_LT(inside.bounds->cycles.low, N);
  EXPECT_GT(inside.bounds->cycles.high, N);
  EXPECT_LT(inside.bounds->cycles.high, 2 * N);
  request.min = -2;
  EXPECT_TRUE(std::isnan(grown(b, request).bounds->cycles.low));
  request.min = 0;
  request.step = 0.6;
  const Grown across = grown(b, request);
  EXPECT_TRUE(says(across, "c:end leaves region \"weld\"")) << across.ended;
  EXPECT_TRUE(std::isnan(across.bounds->cycles.low));
}

// The region is as stiff and twice as tough: the load is twice K_c/K while the tip lies in it.
TEST(GrowThroughRegions, TheToughnessIsThatWhereTheTipLies) {
  const Loop region = polygon("weld", {{1.03, -1}, {1.9, -1}, {1.9, 1}, {1.03, 1}}, none);
  const Body b = with_region(plate(10, 20, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1), region, body);
  const Grown g = grown(
      b, {.toughness = 3, .regions = {{.region = 0, .toughness = 6}}, .tips = {{0, false}}, .step = 0.25, .steps = 8});
  EXPECT_TRUE(says(g, "c:end enters region \"weld\" at (1.03,")) << g.ended;
  EXPECT_TRUE(says(g, "c:end leaves region \"weld\" at (1.9,")) << g.ended;
  int within = 0;
  for (const GrowthStep& s : g.steps) {
    ASSERT_EQ(s.tips.size(), 1u);
    const GrownTip& tip = s.tips[0];
    const bool in = tip.at.x() > 1.03 && tip.at.x() < 1.9;
    within += in;
    EXPECT_EQ(tip.region, in ? 0 : none);
    EXPECT_NEAR(s.load, (in ? 6 : 3) / tip.dK, 1e-12);
    EXPECT_GT(std::min(std::abs(tip.at.x() - 1.03), std::abs(tip.at.x() - 1.9)), 0.09) << "clear of the border";
    EXPECT_LT(std::abs(tip.at.y()), 3e-3);
  }
  EXPECT_GE(within, 2);
}

// Tada's strip again, its crack growing faster in a region: each part by its own constant.
TEST(GrowThroughRegions, TheLifeIsTheSumOfItsParts) {
  const double border = 1.2;
  const Loop region = polygon("soft", {{border, -3}, {4, -3}, {4, 3}, {border, 3}}, none),
             other = polygon("left", {{-4, -3}, {-border, -3}, {-border, 3}, {-4, 3}}, none);
  Body b = with_region(plate(10, 24, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 100), region, body);
  b = with_region(std::move(b), other, body);
  const GrowthLaw faster{.form = Paris{5e-11, 3}};
  const Grown g = grown(b, {.law = paris,
                            .regions = {{.region = 0, .law = faster}, {.region = 1, .law = faster}},
                            .step = 0.125,
                            .length = 4.5});
  ASSERT_EQ(g.steps.back().tips.size(), 2u) << g.ended;
  const double end = 0.5 * g.steps.back().tips[0].a;
  const auto life = [](const GrowthLaw& law, double from, double to) {
    std::vector<PathPoint> path;
    for (int i = 0; i <= 40; ++i) {
      const double a = from * std::pow(to / from, i / 40.0), x = a / 10;
      path.push_back({a, 100 * std::sqrt(pi * a / std::cos(pi * x)) * (1 - 0.1 * x * x + 0.96 * std::pow(x, 4)), 0});
    }
    return Life(law, path).cycles();
  };
  const double N = life(paris, 0.5, border) + life(faster, border, end);
  EXPECT_NEAR(g.steps.back().cycles, N, 0.02 * N);
  EXPECT_LT(std::abs(g.steps.back().cycles - N), g.cycles_error);
}

// An inclined crack past and through regions of its own material: the path is that of the body without them.
TEST(GrowThroughRegions, ARegionOfTheBodyItselfChangesNothing) {
  const Body plain = plate(10, 10, {"c", {{-0.5, -0.3}, {0.5, 0.3}}, {}}, 1);
  const Body b = with_region(plain, circle("r", {1.3, 0.2}, 0.45, none), body);
  const GrowRequest request{.law = paris, .tips = {{0, false}}, .step = 0.2, .length = 2.6};
  const Grown with = grown(b, request), without = grown(plain, request);
  EXPECT_TRUE(says(with, "c:end enters region \"r\"")) << with.ended;
  const std::vector<Vec2>& path = without.shape.cracks[0].points;
  for (const GrowthStep& s : with.steps) {
    const Vec2& at = s.tips.at(0).at;
    double least = infinity;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) least = std::min(least, distance(at, path[i], path[i + 1]));
    EXPECT_LT(least, 8e-3) << s.number;
  }
}

// Stiffer and softer discs at random beside the way of a crack: every tip keeps clear of borders and has K, and is
// symmetric where it has grown.
TEST(GrowThroughRegions, RandomDiscs) {
  test::Dice dice(48);
  for (int k = 0; k < 3; ++k) {
    const double contrast = k == 0 ? 4 : k == 1 ? 0.25 : 1.5, r = dice.between(0.3, 0.7);
    const Loop disc = circle("disc", {dice.between(1.2, 1.6), dice.between(-0.4, 0.4)}, r, none);
    const Body b =
        with_region(plate(10, 10, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1), disc, plane_strain(1000 * contrast, 0.3));
    const Grown g = grown(b, {.toughness = 1, .tips = {{0, false}}, .step = 0.2, .steps = 9});
    EXPECT_EQ(g.steps.size(), 10u) << k << ' ' << g.ended;
    for (const GrowthStep& s : g.steps) {
      ASSERT_EQ(s.tips.size(), 1u);
      EXPECT_TRUE(std::isfinite(s.tips[0].K_I));
      if (s.number > 0) {
        EXPECT_LT(std::abs(s.tips[0].K_II), 2e-3 * s.tips[0].K_I) << k << ' ' << s.number;
      }
      const double away = std::abs((s.tips[0].at - disc.sides[0].arc->center).norm() - r);
      EXPECT_GT(away, 0.008) << k << ' ' << s.number;
    }
  }
}

TEST(GrowThroughRegions, ATipOnABorderStays) {
  const Body b = with_region(plate(10, 10, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1), circle("r", {1, 0}, 0.5, none),
                             plane_strain(5000, 0.3));
  const Grown g = grown(b, {.toughness = 1, .step = 0.2, .steps = 1});
  EXPECT_TRUE(says(g, "c:end stays as it is: it lies on a border between materials, where there is no K"));
  ASSERT_EQ(g.steps[0].tips.size(), 1u);
  EXPECT_EQ(g.steps[0].tips[0].name, "c:start");
  EXPECT_THROW(grown(b, {.toughness = 1, .tips = {{0, false}}, .step = 0.2}), Error);
}

// An arc in the way is met at (1.2, 0), .14 before its chord.
TEST(GrowThroughRegions, AnArcIsMetWhereItIs) {
  Body b = plate(10, 10, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1);
  b.shape.cracks.push_back(arc_crack("d", {2, 0}, 0.8, pi - 0.6, pi + 0.6));
  b.scene.laws.push_back({.kind = CrackLaw::Kind::Open});
  const Grown g = grown(b, {.toughness = 1, .tips = {{0, false}}, .step = 0.2, .steps = 9});
  EXPECT_TRUE(says(g, "c:end reaches crack \"d\" at (1.2")) << g.ended;
}

}  // namespace
}  // namespace kerf::region_growth_test
