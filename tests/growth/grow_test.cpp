// Bodies whose cracks grow. Truths from outside: the series of the kink, symmetry, the limit of paths of straight
// pieces, and a life by a formula of K.

#include "geometry/plane.hpp"
#include "growth/kink.hpp"
#include "growth/life.hpp"
#include "kerf/growth.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::grow_test {
namespace {

using namespace growth;

const auto fixed = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };

struct Body {
  Shape shape;
  Scene scene;
  Sizing sizing;
};

/// A rectangle about the origin on rollers, pulled at its top.
Body plate(double width, double height, Crack crack, double pull, CrackLaw law = {.kind = CrackLaw::Kind::Open}) {
  Body b;
  const double w = width / 2, h = height / 2;
  b.shape.outline = polygon("outline", {{-w, -h}, {w, -h}, {w, h}, {-w, h}}, 0);
  b.shape.labels = {"bottom", "right", "top", "left"};
  for (Index side = 0; side < 4; ++side) b.shape.outline.sides[static_cast<std::size_t>(side)].label = side;
  b.shape.cracks = {std::move(crack)};
  b.scene.material = plane_strain(1000, 0.3);
  b.scene.supports = {{0, false, false, true, fixed}};
  b.scene.tractions = {{2, [pull](const Vec2&, const Vec2&) { return Vec2(0, pull); }}};
  b.scene.laws = {law};
  b.sizing = {.size = height / 12};
  return b;
}

Grown grown(const Body& b, const GrowRequest& request, const WatchGrowth& watch = {}) {
  return grow(b.shape, b.sizing, bdms(2), b.scene, request, {}, watch);
}

const GrowthLaw paris{.form = Paris{1e-11, 3}};

// Of a strip with a crack in its middle, by Tada's formula of K, 0.1 % (handbook of H. Tada, P. C. Paris and G. R.
// Irwin, section 2.1).
TEST(Grow, TheLifeOfACentreCrack) {
  const Body b = plate(10, 24, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 100);
  const Grown g = grown(b, {.law = paris, .step = 0.25, .length = 5});
  EXPECT_NE(g.ended.find("as asked"), std::string::npos) << g.ended;
  const GrowthStep& last = g.steps.back();
  ASSERT_EQ(last.tips.size(), 2u);
  const double from = 0.5, to = 0.5 * last.tips[0].a;
  std::vector<PathPoint> path;
  for (int i = 0; i <= 40; ++i) {
    const double a = from * std::pow(to / from, i / 40.0), x = a / 10;
    path.push_back({a, 100 * std::sqrt(pi * a / std::cos(pi * x)) * (1 - 0.1 * x * x + 0.96 * std::pow(x, 4)), 0});
  }
  const double N = Life(paris, path).cycles();
  EXPECT_NEAR(last.cycles, N, 0.012 * N);
  EXPECT_LT(g.cycles_error, 0.02 * N);
  EXPECT_LT(std::abs(g.energy_balance), 2e-3);
  for (const GrowthStep& s : g.steps)
    for (const GrownTip& tip : s.tips) EXPECT_LT(std::abs(tip.at.y()), 2e-3);  // straight on
  EXPECT_NEAR(last.tips[0].a, 2 * std::abs(last.tips[0].at.x()), 2e-3);
}

// Until K reaches the toughness, within a step: the error holds, and half the step halves it.
TEST(Grow, TheLifeUntilItRuns) {
  const Body b = plate(10, 24, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 100);
  const GrowthLaw law{.form = Paris{1e-11, 3}, .K_c = 260};
  std::vector<PathPoint> path;
  for (int i = 0; i <= 80; ++i) {
    const double a = 0.5 * std::pow(6, i / 80.0), x = a / 10;
    path.push_back({a, 100 * std::sqrt(pi * a / std::cos(pi * x)) * (1 - 0.1 * x * x + 0.96 * std::pow(x, 4)), 0});
  }
  const Life life(law, path);
  ASSERT_EQ(life.end(), LifeEnd::Runs);
  double coarse = 0;
  for (const double step : {0.4, 0.2}) {
    const Grown g = grown(b, {.law = law, .step = step});
    EXPECT_EQ(g.ended, "unstable: K reaches the toughness of the law at the largest load");
    EXPECT_NEAR(g.steps.back().cycles, life.cycles(), g.cycles_error + 0.012 * life.cycles()) << step;
    EXPECT_GT(g.cycles_error, 0);
    if (coarse > 0) {
      EXPECT_LT(g.cycles_error, 0.75 * coarse);
    }
    coarse = g.cycles_error;
  }
}

// A small kink of the body is that of the series [Amestoy, Leblond 1992], whatever the angle.
TEST(Grow, TheFirstPieceIsTheKinkOfTheSeries) {
  std::mt19937 bits(7);
  for (int k = 0; k < 3; ++k) {
    const double angle = 0.3 + 0.9 * (bits() / 4294967296.0);
    const Vec2 along(std::cos(angle), std::sin(angle));
    const Body b = plate(20, 20, {"c", {-along, along}, {}}, 1);
    const Grown g = grown(b, {.law = paris, .tips = {{0, false}}, .step = 0.16, .steps = 1});
    ASSERT_EQ(g.steps.size(), 2u) << g.ended;
    const GrownTip& tip = g.steps[0].tips.at(0);
    const Direction series = symmetric_direction({tip.K_I, tip.K_II, tip.T}, tip.da);
    EXPECT_NEAR(tip.angle, series.angle, 0.012) << angle;
    EXPECT_LE(tip.symmetry, 1e-3);
    EXPECT_NEAR(tip.da, 0.02, 1e-12);  // an eighth of the step, behind a kink
    EXPECT_EQ(g.steps[1].tips.size(), 1u);
  }
}

// Faces in contact and with friction: wings open by the series of the kink and turn into the direction of the load,
// both the same; K falls, so that the load must rise.
TEST(Grow, WingsOfAClosedCrack) {
  const double c = std::sqrt(0.5);
  const Body b = plate(20, 20, {"c", {{-c, -c}, {c, c}}, {}}, -1, {.friction = 0.3});
  const Grown g = grown(b, {.toughness = 1, .step = 0.2, .steps = 7});
  ASSERT_EQ(g.steps.size(), 8u) << g.ended;
  EXPECT_EQ(g.steps[0].tips[0].K_I, 0);
  EXPECT_NEAR(g.steps[0].tips[0].angle, 77.33 * pi / 180, 0.01);  // of pure shear
  for (const GrowthStep& s : g.steps) {
    ASSERT_EQ(s.tips.size(), 2u);
    const GrownTip &end = s.tips[0], &start = s.tips[1];
    EXPECT_LT((end.at + start.at).norm(), 4e-3);
    if (s.number > 0) {
      EXPECT_GT(s.load, g.steps[static_cast<std::size_t>(s.number) - 1].load);
      EXPECT_LE(std::abs(end.K_II), 1.1e-3 * end.K_I);
      EXPECT_LE(std::abs(start.K_II), 1.1e-3 * start.K_I);
    }
  }
  const auto& path = g.shape.cracks[0].points;
  const Vec2 at_end = path.back() - path[path.size() - 2];
  EXPECT_LT(std::atan2(std::abs(at_end.x()), at_end.y()), 0.3);  // the load acts along y
}

// Two cracks and two holes [Bouchard, Bay, Chastel 2003]: images of each other. The place is the limit of paths of
// straight pieces: (-1.5814, -1.5386 with half the step) -> -1.496 at x = -5.524, (.0676, .1464) -> .225 at 4.824.
TEST(Grow, TwoCracksAndTwoHoles) {
  Body b;
  b.shape.outline = polygon("outline", {{-10, -5}, {10, -5}, {10, 5}, {-10, 5}}, 0);
  b.shape.labels = {"bottom", "right", "top", "left"};
  for (Index side = 0; side < 4; ++side) b.shape.outline.sides[static_cast<std::size_t>(side)].label = side;
  b.shape.holes = {circle("lower", {-7, 2}, 2, none), circle("upper", {7, -2}, 2, none)};
  b.shape.cracks = {{"a", {{-10, -2.15}, {-9, -2.15}}, {}}, {"b", {{10, 2.15}, {9, 2.15}}, {}}};
  b.scene.material = plane_strain(98000, 0.3);
  b.scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, -0.1); }},
                      {2, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0.1); }}};
  b.scene.laws.assign(2, CrackLaw{.kind = CrackLaw::Kind::Open});
  b.sizing = {.size = 0.5};
  const Grown g = grown(b, {.law = paris, .step = 0.7175});
  ASSERT_EQ(g.notes.size(), 2u) << g.ended;
  EXPECT_NE(g.notes[0].find("a:end reaches hole \"upper\""), std::string::npos) << g.notes[0];
  EXPECT_NE(g.notes[1].find("b:end reaches hole \"lower\""), std::string::npos) << g.notes[1];
  EXPECT_EQ(g.ended, "no tip is left inside the body");
  const auto height = [&](double x) {
    const auto& p = g.shape.cracks[0].points;
    for (std::size_t i = 0; i + 1 < p.size(); ++i)
      if (p[i].x() <= x && x < p[i + 1].x())
        return p[i].y() + (x - p[i].x()) / (p[i + 1].x() - p[i].x()) * (p[i + 1].y() - p[i].y());
    return nan;
  };
  EXPECT_NEAR(height(-5.524), -1.496, 0.025);
  EXPECT_NEAR(height(4.824), 0.225, 0.025);
  for (const Vec2& p : g.shape.cracks[0].points) {
    double least = infinity;
    const auto& other = g.shape.cracks[1].points;
    for (std::size_t i = 0; i + 1 < other.size(); ++i) least = std::min(least, distance(-p, other[i], other[i + 1]));
    EXPECT_LT(least, 6e-3) << p.transpose();
  }
}

// A path of many pieces on one line does not meet itself: K to the end, by Kaya and Erdogan (Q. Appl. Math. 45, 1987):
// 1.1892 and 1.3673 sigma sqrt(pi a) at a tenth and a fifth of the width.
TEST(Grow, AStraightPathDoesNotMeetItself) {
  Body b = plate(50, 250, {"c", {{-25, 0}, {-24, 0}}, {}}, 100);
  b.scene.supports.clear();
  b.scene.tractions.push_back({0, [](const Vec2&, const Vec2&) { return Vec2(0, -100); }});
  const Grown g = grown(b, {.law = paris, .step = 0.5, .length = 10});
  EXPECT_NE(g.ended.find("as asked"), std::string::npos) << g.ended << g.notes.size();
  ASSERT_EQ(g.steps.size(), 19u);
  const auto geometry = [&](std::size_t k) {
    return g.steps[k].tips.at(0).K_I / (100 * std::sqrt(pi * g.steps[k].tips.at(0).a));
  };
  EXPECT_NEAR(geometry(8), 1.1892, 2e-3);
  EXPECT_NEAR(geometry(18), 1.3673, 2e-3);
}

// Two tips on one line, nearer than a step: one goes on to the other, and the outer tips grow on, images of each other.
TEST(Grow, TipsThatFaceEachOtherMeet) {
  Body b = plate(8, 8, {"left", {{-1.5, 0}, {-0.02, 0}}, {}}, 1);
  b.shape.cracks.push_back({"right", {{0.02, 0}, {1.5, 0}}, {}});
  b.scene.laws.push_back({.kind = CrackLaw::Kind::Open});
  const Grown g = grown(b, {.law = paris, .step = 0.2, .steps = 2});
  ASSERT_EQ(g.notes.size(), 1u) << g.ended;
  EXPECT_NE(g.notes[0].find("left:end reaches the tip right:start"), std::string::npos) << g.notes[0];
  ASSERT_EQ(g.steps.size(), 3u) << g.ended;
  EXPECT_EQ(g.steps[0].tips.size(), 4u);
  const std::vector<GrownTip>& tips = g.steps[2].tips;
  ASSERT_EQ(tips.size(), 2u);
  EXPECT_NEAR(tips[0].at.x(), -tips[1].at.x(), 1e-3);
  // Of a crack of twice the half length: sqrt(pi a), 5 % more in this plate.
  EXPECT_NEAR(g.steps[1].tips[0].K_I, std::sqrt(1.5 * pi), 0.2 * std::sqrt(1.5 * pi));
  EXPECT_THROW(grown(b, {.law = paris, .step = 1e-3}), Error);
}

TEST(Grow, SaysWhyItEnds) {
  const Body b = plate(8, 8, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1);
  EXPECT_EQ(grown(b, {.law = GrowthLaw{.form = Paris{1e-11, 3}, .threshold = 100}}).ended,
            "arrested: the range of K is below the threshold at every tip");
  EXPECT_EQ(grown(b, {.law = GrowthLaw{.form = Paris{1e-11, 3}, .K_c = 0.1}}).ended,
            "unstable: K reaches the toughness of the law at the largest load");
  EXPECT_NE(grown(b, {.law = paris, .step = 0.2, .cycles = 1}).ended.find("cycles are done, as asked"),
            std::string::npos);
  const Body closed = plate(8, 8, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, -1, {});
  EXPECT_EQ(grown(closed, {.toughness = 1.0}).ended, "no tip is loaded: K is 0 at all of them");
  const Body through = plate(8, 8, {"c", {{-4, 0}, {-3, 0}}, {}}, 1);
  EXPECT_THROW(grown(through, {.law = paris, .tips = {{0, true}}}), Error);  // it ends on the outline
}

// A history of two equal cycles is two cycles, and smaller ones between them count as rainflow counts them.
TEST(Grow, SpectraAreBlocks) {
  const Body b = plate(8, 8, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1, {});
  const GrowRequest once{.law = paris, .step = 0.2, .steps = 1};
  const double rate = grown(b, once).steps[0].tips[0].rate;
  GrowRequest twice = once;
  twice.spectrum = {0, 1, 0, 1};
  EXPECT_NEAR(grown(b, twice).steps[0].tips[0].rate, 2 * rate, 1e-12 * rate);
  GrowRequest mixed = once;  // 0-1, and .5-.75 within
  mixed.spectrum = {0, 0.75, 0.5, 1};
  EXPECT_NEAR(grown(b, mixed).steps[0].tips[0].rate, (1 + std::pow(0.25, 3)) * rate, 1e-9 * rate);
  GrowRequest reversed = once;  // closed where the load is reversed
  reversed.spectrum = {-1, 1};
  reversed.min = -1;
  EXPECT_NEAR(grown(b, reversed).steps[0].tips[0].rate, rate, 1e-3 * rate);
}

// With contact the least load of a cycle closes the crack: K there is 0, whatever its sign.
TEST(Grow, ClosureIsComputed) {
  const Body open = plate(8, 8, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1),
             touching = plate(8, 8, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1, {});
  const GrowRequest reversed{.law = paris, .min = -0.5, .step = 0.2, .steps = 1};
  const GrownTip free = grown(open, reversed).steps[0].tips[0], closed = grown(touching, reversed).steps[0].tips[0];
  EXPECT_NEAR(closed.K_I, free.K_I, 1e-3 * free.K_I);
  EXPECT_NEAR(free.K_I_min, -0.5 * free.K_I, 1e-12);
  EXPECT_NEAR(closed.K_I_min, 0, 1e-6);
  EXPECT_NEAR(closed.dK, closed.K_I, 1e-3 * closed.K_I);
}

// A run that is cut short after any step and goes on by its record ends with the same bits, and solves no state twice.
TEST(Grow, GoesOnFromARecordWithTheSameBits) {
  const Body b = plate(8, 8, {"c", {{-0.5, -0.3}, {0.5, 0.3}}, {}}, 1);
  const GrowRequest request{.law = paris, .step = 0.2, .tolerance = 0.2, .steps = 3};
  std::vector<GrowthRecord> records;
  int bodies = 0;
  const Grown whole = grown(b, request, [&](const auto&, const auto&, const Adapted* body, const GrowthRecord& record) {
    bodies += body != nullptr;
    records.push_back(record);
    return true;
  });
  ASSERT_GT(records.size(), 5u);
  EXPECT_EQ(bodies, static_cast<int>(records.size()));
  for (const std::size_t cut : {std::size_t{1}, records.size() - 2}) {
    int again = 0, told = 0;
    const Grown rest = grow(
        b.shape, b.sizing, bdms(2), b.scene, request, {},
        [&](const auto&, const auto&, const Adapted* body, const GrowthRecord& record) {
          ++told;
          again += body == nullptr;
          EXPECT_EQ(record.told, told);
          return true;
        },
        records[cut]);
    EXPECT_EQ(again, records[cut].told);
    EXPECT_EQ(told, static_cast<int>(records.size()));
    ASSERT_EQ(rest.steps.size(), whole.steps.size());
    for (std::size_t i = 0; i < whole.steps.size(); ++i) {
      EXPECT_EQ(rest.steps[i].cycles, whole.steps[i].cycles);
      ASSERT_EQ(rest.steps[i].tips.size(), whole.steps[i].tips.size());
      for (std::size_t k = 0; k < whole.steps[i].tips.size(); ++k) {
        EXPECT_EQ(rest.steps[i].tips[k].at, whole.steps[i].tips[k].at);
        EXPECT_EQ(rest.steps[i].tips[k].K_II, whole.steps[i].tips[k].K_II);
      }
    }
    EXPECT_EQ(rest.path_error, whole.path_error);
    EXPECT_EQ(rest.solves, whole.solves);
  }
}

// Of a crack in the middle of a strip, by Tada's K (0.1 %): intervals hold K at every step and the life, and the energy
// released and lost can be one number.
TEST(Grow, GuaranteedIntervalsHoldTheFormula) {
  const Body b = plate(10, 24, {"c", {{-1, 0}, {1, 0}}, {}}, 100);
  const GrowRequest request{.law = paris, .step = 0.3, .length = 4, .bounds = true};
  const Grown g = grown(b, request);
  const auto K = [](double a) {
    const double x = a / 10;
    return 100 * std::sqrt(pi * a / std::cos(pi * x)) * (1 - 0.1 * x * x + 0.96 * std::pow(x, 4));
  };
  std::vector<PathPoint> path;
  for (const GrowthStep& s : g.steps)
    for (const GrownTip& tip : s.tips) {
      ASSERT_TRUE(tip.in) << tip.name;
      EXPECT_TRUE(tip.in->guaranteed) << tip.in->note;
      const double a = 0.5 * tip.a, by_formula = K(a);
      EXPECT_LT(tip.in->K_I.low, 1.001 * by_formula);
      EXPECT_GT(tip.in->K_I.high, 0.999 * by_formula);
      EXPECT_LT(tip.in->K_I.high - tip.in->K_I.low, 0.05 * by_formula);
      EXPECT_LE(tip.in->K_II.low, 0);
      EXPECT_GE(tip.in->K_II.high, 0);
    }
  ASSERT_TRUE(g.bounds);
  EXPECT_TRUE(g.bounds->guaranteed) << g.bounds->note;
  const double from = 1, to = 0.5 * g.steps.back().tips[0].a;
  for (int i = 0; i <= 40; ++i) {
    const double a = from * std::pow(to / from, i / 40.0);
    path.push_back({a, K(a), 0});
  }
  const double N = Life(paris, path).cycles();
  for (const Interval& in : {g.bounds->cycles, g.bounds->cycles_smooth}) {
    EXPECT_LT(in.low, 1.003 * N);
    EXPECT_GT(in.high, 0.997 * N);
  }
  EXPECT_LT(g.bounds->cycles_smooth.high - g.bounds->cycles_smooth.low, g.bounds->cycles.high - g.bounds->cycles.low);
  EXPECT_LT(g.bounds->cycles_smooth.high - g.bounds->cycles_smooth.low, 0.25 * N);
  EXPECT_LE(g.bounds->released.low, g.bounds->lost.high);
  EXPECT_LE(g.bounds->lost.low, g.bounds->released.high);
}

// No interval where faces are in contact, and it is said.
TEST(Grow, NoGuaranteeInContact) {
  const Body b = plate(8, 8, {"c", {{-0.6, -0.6}, {0.6, 0.6}}, {}}, -1, {});
  const Grown g = grown(b, {.toughness = 1, .step = 0.2, .steps = 1, .bounds = true});
  ASSERT_TRUE(g.bounds);
  EXPECT_FALSE(g.bounds->guaranteed);
  EXPECT_FALSE(g.bounds->note.empty());
}

// A crack under tension leaves its line for the direction in which G/G_c is the largest: the angle of pure mode I from
// G(angle)/G_c(angle) = (F_11^2 + F_21^2)/G_c by small angles: G falls as 1 - angle^2/4.. of Cotterell and Rice, and
// the load is that at which G there reaches G_c.
TEST(Grow, ToughnessByDirection) {
  const Body b = plate(12, 12, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1);
  const double tilt = 0.2, depth = 0.3;
  const auto G_c = [=](double phi) { return 1 - depth * std::cos(2 * (phi - tilt)); };  // least at tilt
  const GrowRequest request{
      .toughness = 2, .anisotropy = G_c, .criterion = Criterion::Energy, .tips = {{0, false}}, .step = 0.1, .steps = 1};
  const Grown g = grown(b, request);
  const GrownTip& tip = g.steps[0].tips.at(0);
  // The largest of G/G_c by the functions of Cotterell and Rice for small angles, on a fine grid.
  double best = 0, angle = 0;
  for (int i = -5000; i <= 5000; ++i) {
    const double x = i * 1e-4, F11 = (3 * std::cos(x / 2) + std::cos(3 * x / 2)) / 4,
                 F21 = (std::sin(x / 2) + std::sin(3 * x / 2)) / 4, ratio = (F11 * F11 + F21 * F21) / G_c(x);
    if (ratio > best) best = ratio, angle = x;
  }
  EXPECT_NEAR(tip.angle, angle, 3e-3);
  EXPECT_NEAR(g.steps[0].load, 2 / (tip.K_I * std::sqrt(best)), 2e-3 * g.steps[0].load);
}

// Under pressure a crack grows in its own plane where K_IIc is low, and opens a wing where it is high.
TEST(Grow, InShearOrByAWing) {
  const double c = std::sqrt(0.5);
  const Body b = plate(20, 20, {"c", {{-c, -c}, {c, c}}, {}}, -1, {.friction = 0.3});
  GrowRequest request{.toughness = 1, .toughness_shear = 0.7, .tips = {{0, false}}, .step = 0.2, .steps = 1};
  const Grown straight = grown(b, request);
  const GrownTip& tip = straight.steps[0].tips.at(0);
  EXPECT_EQ(tip.angle, 0);
  EXPECT_NEAR(straight.steps[0].load, 0.7 / std::abs(tip.K_II), 1e-12 * straight.steps[0].load);
  request.toughness_shear = 0.9;  // 1/1.2315 = .812 is the limit
  EXPECT_NEAR(std::abs(grown(b, request).steps[0].tips.at(0).angle), 77.33 * pi / 180, 0.01);
}

// A small crack in a plate that its loads pull runs at once: the load falls like the root of its length, and what the
// crack adds to the displacement is too little to keep it from falling, too (snap-back). Wings under pressure are
// stable.
TEST(Grow, SaysWhereTheLoadFalls) {
  const Grown open =
      grown(plate(10, 10, {"c", {{-0.5, 0}, {0.5, 0}}, {}}, 1), {.toughness = 1, .step = 0.2, .steps = 3});
  ASSERT_TRUE(open.unstable_from);
  EXPECT_EQ(*open.unstable_from, 0);
  ASSERT_TRUE(open.snaps_back_from);
  EXPECT_EQ(*open.snaps_back_from, 0);
  const double c = std::sqrt(0.5);
  const Grown wings =
      grown(plate(20, 20, {"c", {{-c, -c}, {c, c}}, {}}, -1, {}), {.toughness = 1, .step = 0.2, .steps = 3});
  EXPECT_FALSE(wings.unstable_from);
}

}  // namespace
}  // namespace kerf::grow_test
