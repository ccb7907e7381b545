// Constraints measured on a design, against closed forms: random frozen discs and round voids, random strips, random
// bodies and their images.

#include "optimize/constraints.hpp"

#include "optimize/constraints/mirrored.hpp"
#include "optimize/constraints/sides.hpp"
#include "optimize/constraints/thickness.hpp"
#include "optimize/loop/finish.hpp"
#include "tests/support/dice.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::constraints_test {
namespace {

using test::Dice;

/// [-2, 2]^2; its label is 0, that of designs 1.
Shape square() {
  Shape s;
  s.labels = {"free"};
  s.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  return s;
}

TEST(Depth, OfDrawnBodiesIsExact) {
  Dice dice(1);
  const Region disc(circle("c", {0.3, -0.2}, 1.7, none)), whole(square());
  for (int k = 0; k < 200; ++k) {
    const Vec2 x(dice.between(-3, 3), dice.between(-3, 3));
    EXPECT_NEAR(disc.depth(x), 1.7 - (x - Vec2(0.3, -0.2)).norm(), 1e-12);
    const Vec2 out = (x.cwiseAbs().array() - 2).matrix();
    const double depth = out.maxCoeff() < 0 ? -out.maxCoeff() : -out.cwiseMax(0).norm();
    EXPECT_NEAR(whole.depth(x), depth, 1e-12);
  }
}

TEST(Depth, OfEllipsesAgreesWithFineChords) {
  Dice dice(2);
  for (int k = 0; k < 20; ++k) {
    const Loop loop =
        ellipse("e", {dice.between(-1, 1), 0}, {dice.between(0.2, 1), dice.between(0.2, 1)}, dice.between(0, 3), none);
    const Polygon fine = flatten(loop, 1e-7, infinity);
    const Region exact(loop), chords(polygon("p", fine.points, none));
    for (int i = 0; i < 20; ++i) {
      const Vec2 x(dice.between(-2, 2), dice.between(-2, 2));
      EXPECT_NEAR(exact.depth(x), chords.depth(x), 2e-7);
    }
  }
}

// The boundary of the void comes nearest to the middle of the region at | |c - f| - r |.
TEST(Frozen, DepthsOfRoundVoidsAreExact) {
  Dice dice(3);
  int cut = 0, whole = 0;
  for (int k = 0; k < 100; ++k) {
    const Vec2 f(dice.between(-0.8, 0.8), dice.between(-0.8, 0.8)), c(dice.between(-0.9, 0.9), dice.between(-0.9, 0.9));
    const double R = dice.between(0.1, 0.6), r = dice.between(0.1, 0.9), away = (c - f).norm();
    Shape design = square();
    design.labels.push_back("design");
    design.holes.push_back(circle("void", c, r, 1));
    const Intrusion found = intrusion(design, square(), circle("f", f, R, none));
    const double depth = R - std::abs(away - r);
    if (away + R < r) {
      EXPECT_GT(found.depth, 0);  // no boundary in it: all of it is void
      EXPECT_EQ(found.share, 1);
      ++whole;
    } else if (depth <= 0) {
      EXPECT_EQ(found.depth, 0);
      EXPECT_EQ(found.share, 0);
    } else {
      EXPECT_GE(found.depth, depth - 1e-9);
      EXPECT_LE(found.depth, std::max(depth, R));
      ++cut;
    }
  }
  EXPECT_GT(cut, 25);
  EXPECT_GT(whole, 2);
}

// A slot cut through the square beside its middle leaves two strips; between two slots there is a third.
TEST(Thickness, OfStripsIsTheirWidth) {
  Dice dice(4);
  for (int k = 0; k < 40; ++k) {
    const double t = dice.between(0, 3), w = dice.between(0.05, 0.4), gap = dice.between(0.1, 0.3);
    const Vec2 along(std::cos(t), std::sin(t)), across(-along.y(), along.x());
    Shape design = square();
    design.labels.push_back("design");
    for (const double side : {1.0, -1.0}) {
      const Vec2 a = side * w / 2 * across, b = a + side * gap * across;
      design.holes.push_back(polygon("slot", {a - along, a + along, b + along, b - along}, 1));
    }
    const std::vector<DrawnSide> sides = sides_of(design);
    std::vector<bool> moves;
    for (const DrawnSide& s : sides) moves.push_back(s.label == 1);
    const Thinnest member = thinnest(sides, moves, false, 1.5 * w), void_ = thinnest(sides, moves, true, 1.5 * gap);
    EXPECT_NEAR(member.width, w, 2e-3 * w);
    EXPECT_NEAR(void_.width, gap, 2e-3 * gap);
    EXPECT_NEAR(across.dot(member.at), 0, 1e-3);
    // Wider ones are not looked for.
    EXPECT_EQ(thinnest(sides, moves, false, 0.9 * w).width, infinity);
    // What cannot move does not count.
    EXPECT_EQ(thinnest(sides, std::vector<bool>(sides.size(), false), false, 1.5 * w).width, infinity);
  }
}

// The corners of a rectangle are no members, however narrow the discs in them are.
TEST(Thickness, CornersAreNoMembers) {
  Shape design = square();
  design.labels.push_back("design");
  for (Side& side : design.outline.sides) side.label = 1;
  const std::vector<DrawnSide> sides = sides_of(design);
  const std::vector<bool> moves(sides.size(), true);
  EXPECT_EQ(thinnest(sides, moves, false, 3).width, infinity);
  EXPECT_NEAR(thinnest(sides, moves, false, 6).width, 4, 0.02);
}

/// Many sides around a random place, and the same mirrored.
TEST(Symmetry, DistancesOfImagesAreThoseOfTheChange) {
  Dice dice(5);
  for (int k = 0; k < 50; ++k) {
    const double t = dice.between(0, 3);
    const Mirror mirror{{dice.between(-1, 1), dice.between(-1, 1)}, {std::cos(t), std::sin(t)}};
    const Vec2 across(-mirror.direction.y(), mirror.direction.x());
    std::vector<Vec2> points;
    const int n = 12;
    for (int i = 0; i < n; ++i) {
      const double angle = pi * (i + 0.5) / n;
      points.push_back(mirror.point +
                       dice.between(0.5, 1.5) * (std::cos(angle) * mirror.direction + std::sin(angle) * across));
    }
    for (int i = n - 1; i >= 0; --i) points.push_back(image_of(mirror, points[std::size_t(i)]));
    Shape body;
    body.outline = polygon("o", points, 0);
    EXPECT_LE(asymmetry(body, mirror).distance, 1e-14 * extent(body));
    const double change = dice.between(1e-9, 1e-3);
    body.outline.sides[3].start += change * (body.outline.sides[3].start - mirror.point).normalized();
    const Asymmetry found = asymmetry(body, mirror);
    EXPECT_LE(found.distance, change * (1 + 1e-6));
    EXPECT_GT(found.distance, 0.05 * change);
  }
}

TEST(KeptConstraints, AllThatWereAskedForAreListed) {
  Shape frame = square(), design = square();
  design.labels.push_back("design");
  design.holes.push_back(circle("void", {0, 0}, 0.5, 1));
  OptimizeRequest r;
  EXPECT_TRUE(constraints_of({.shape = design, .frame = &frame}, r).empty());
  r.volume_at_most = 0.9;
  r.bounds = {{"G", {}, 2}};
  r.level_set.frozen = {circle("pad", {0.6, 0}, 0.2, none)};
  r.level_set.min_feature = 0.5;
  r.level_set.min_gap = 1.1;
  r.level_set.mirror = Mirror{{0.1, 0}, {0, 1}};
  const double bound = 2.1;
  const auto all = constraints_of({.shape = design, .frame = &frame, .bounds = {&bound, 1}}, r);
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[0].name, "volume");
  EXPECT_NEAR(all[0].got, 1 - pi / 64, 1e-12);
  EXPECT_FALSE(all[0].kept);
  EXPECT_EQ(all[1].note, "G 2.1 > 2");
  EXPECT_EQ(all[2].name, "frozen pad");
  EXPECT_NEAR(all[2].got, 0.1, 1e-9);
  EXPECT_NEAR((all[2].at.value() - Vec2(0.5, 0)).norm(), 0, 1e-6);
  EXPECT_TRUE(is_broken(all[2]));
  EXPECT_EQ(all[3].name, "min_feature");
  EXPECT_NEAR(all[3].got, 1.5, 0.02);  // from the void to the frame
  EXPECT_TRUE(all[3].kept);
  EXPECT_NEAR(all[4].got, 1, 0.01);
  EXPECT_FALSE(all[4].kept);
  EXPECT_FALSE(is_broken(all[4]));
  EXPECT_NEAR(all[5].got, 0.2, 1e-9);
  EXPECT_NE(conflicts(all, true).find("conflict: min_gap = 1.1, but a gap is"), std::string::npos);
  EXPECT_EQ(conflicts(all, true).find("volume"), std::string::npos);
}

/// A design as judged: optimal but for what its shape says.
OptimizeResult judged(const OptimizeRequest& r, const Shape& frame, double from) {
  OptimizeResult result;
  result.shape = square();
  result.shape.labels.push_back("design");
  result.shape.holes.push_back(circle("void", {0, 0}, 0.5, 1));
  result.history = {{.objective = from, .merit = from, .volume_fraction = 1}};
  const Iteration row{.objective = 2, .merit = 2, .volume_fraction = 0.5};
  judge(result, r, {.row = row, .residual = 1e-4, .asked = 1e-3, .kind = "residual", .why = "done", .frame = &frame});
  return result;
}

TEST(KeptConstraints, WhatIsNotKeptIsNotOptimal) {
  const Shape frame = square();
  OptimizeRequest r;
  EXPECT_EQ(judged(r, frame, 3).ending, Ending::Optimal);
  r.level_set.min_gap = 1.1;
  const OptimizeResult narrow = judged(r, frame, 3);
  EXPECT_EQ(narrow.ending, Ending::Stalled);
  EXPECT_TRUE(narrow.feasible);
  EXPECT_NE(narrow.stopped.find("conflict: min_gap"), std::string::npos) << narrow.stopped;
  r.level_set.min_gap = 0;
  r.level_set.frozen = {circle("pad", {0.6, 0}, 0.2, none)};
  const OptimizeResult cut = judged(r, frame, 3);
  EXPECT_EQ(cut.ending, Ending::Infeasible);
  EXPECT_FALSE(cut.feasible);
  EXPECT_EQ(cut.stopped.rfind("infeasible: conflict: \"pad\" is frozen, but void reaches 0.1 into it at (0.5, ", 0), 0u)
      << cut.stopped;
}

TEST(KeptConstraints, AStartThatViolatesThemIsSaid) {
  const Shape frame = square();
  OptimizeRequest r;
  r.volume_at_most = 0.99;
  EXPECT_EQ(judged(r, frame, 3).stopped.find("the start"), std::string::npos);
  EXPECT_NE(
      judged(r, frame, 1)
          .stopped.find("J is above that of the start, 1, which violates its constraints (volume fraction 1 > 0.99)"),
      std::string::npos);
}

}  // namespace
}  // namespace kerf::constraints_test
