// A body without regions that stay void: areas by inclusion and exclusion, labels, what is refused.

#include "optimize/constraints.hpp"
#include "optimize/refuse.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kerf {
namespace {

Shape square(double side) {
  Shape s;
  s.labels = {"bottom", "right", "top", "left"};
  s.outline = polygon("outline", {{0, 0}, {side, 0}, {side, side}, {0, side}}, 0);
  for (Index i = 0; i < 4; ++i) s.outline.sides[std::size_t(i)].label = i;
  return s;
}

double length_of_label(const Shape& s, const std::string& label) {
  double sum = 0;
  const auto add = [&](const Loop& loop) {
    for (std::size_t i = 0; i < loop.sides.size(); ++i)
      if (const Side& side = loop.sides[i]; side.label != none && s.labels[std::size_t(side.label)] == label)
        sum += (loop.sides[(i + 1) % loop.sides.size()].start - side.start).norm();
  };
  add(s.outline);
  for (const Loop& hole : s.holes) add(hole);
  return sum;
}

std::string refusal(const Shape& body, const Loop& keep_out) {
  try {
    without(body, keep_out);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Geometry);
    return e.what();
  }
  return {};
}

TEST(KeepOut, InsideTheBodyIsAHole) {
  const Shape s = without(square(2), circle("spanner", {1, 1}, 0.5, none));
  ASSERT_EQ(s.holes.size(), 1u);
  EXPECT_EQ(s.holes[0].name, "spanner");
  EXPECT_NEAR(area(s), 4 - pi * 0.25, 1e-12);
  EXPECT_EQ(s.labels.back(), "keep_out:spanner");
  EXPECT_FALSE(find_problem(s));
}

TEST(KeepOut, FlushWithASideTakesItsLabelAway) {
  const Shape s = without(square(2), polygon("slot", {{0.5, 1}, {1.5, 1}, {1.5, 2}, {0.5, 2}}, none));
  EXPECT_TRUE(s.holes.empty());
  EXPECT_NEAR(area(s), 3, 1e-14);
  EXPECT_NEAR(length_of_label(s, "top"), 1, 1e-14);
  EXPECT_NEAR(length_of_label(s, "keep_out:slot"), 3, 1e-14);
  EXPECT_FALSE(find_problem(s));
}

TEST(KeepOut, ReachesOutOfTheBody) {
  const Shape corner = without(square(2), circle("corner", {2, 2}, 1, none));
  EXPECT_NEAR(area(corner), 4 - pi / 4, 1e-12);
  EXPECT_NEAR(length_of_label(corner, "top"), 1, 1e-12);
  EXPECT_FALSE(find_problem(corner));
  Shape plate = square(2);
  plate.holes.push_back(circle("h", {1, 1}, 0.5, none));
  const Shape lens = without(plate, circle("lens", {1.5, 1}, 0.4, none));
  EXPECT_EQ(lens.holes.size(), 1u);
  EXPECT_FALSE(find_problem(lens));
}

TEST(KeepOut, WhatIsCutAlreadyStays) {
  const Loop disc = circle("corner", {2, 1}, 0.7, none), bay = polygon("bay", {{0, 0}, {1, 0}, {0, 1}}, none);
  const Shape once = without(without(square(2), disc), bay), twice = without(without(once, disc), bay);
  EXPECT_EQ(once.outline.sides.size(), twice.outline.sides.size());
  EXPECT_DOUBLE_EQ(area(once), area(twice));
  EXPECT_EQ(once.labels.size(), twice.labels.size());
}

TEST(KeepOut, OutsideTheBodyNothingChanges) {
  EXPECT_EQ(without(square(2), circle("far", {5, 5}, 1, none)).labels.size(), 4u);
  EXPECT_EQ(without(square(2), polygon("beside", {{2, 0}, {3, 0}, {3, 1}, {2, 1}}, none)).labels.size(), 4u);
}

TEST(KeepOut, WhatLeavesNoBodyIsRefused) {
  EXPECT_NE(refusal(square(2), polygon("all", {{-1, -1}, {3, -1}, {3, 3}, {-1, 3}}, none)).find("whole body"),
            std::string::npos);
  EXPECT_NE(refusal(square(2), polygon("band", {{-1, 0.5}, {3, 0.5}, {3, 1}, {-1, 1}}, none)).find("in pieces"),
            std::string::npos);
  Shape cracked = square(2);
  cracked.cracks.push_back({"c", {{0.5, 1}, {1.5, 1}}, {}});
  EXPECT_NE(refusal(cracked, circle("disc", {1.5, 1}, 0.2, none)).find("crack \"c\""), std::string::npos);
}

TEST(KeepOut, WhatActsInItIsNamed) {
  Scene scene;
  scene.material = plane_stress(1, 0.3);
  scene.supports.push_back({.label = 3});
  scene.tractions.push_back({1, [](const Vec2&, const Vec2&) { return Vec2(1, 0); }});
  const auto why = [&](const Loop& loop) { return wrong_keep_out(square(2), scene, loop).value_or(""); };
  EXPECT_NE(why(circle("a", {0, 1}, 0.3, none)).find("\"left\", which is held"), std::string::npos);
  EXPECT_NE(why(circle("a", {2, 1}, 0.3, none)).find("\"right\", which is loaded"), std::string::npos);
  EXPECT_EQ(why(circle("a", {1, 2}, 0.3, none)), "");
  EXPECT_NE(why(circle("a", {9, 2}, 0.3, none)).find("nothing to keep out"), std::string::npos);
}

/// A star-shaped polygon or a circle at random.
Loop random_loop(std::mt19937& generator) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec2 center(1 + unit(generator), 1 + unit(generator));
  const double pick = unit(generator), radius = 0.3 + unit(generator);
  if (pick < 0.3) return circle("r", center, radius, none);
  if (pick < 0.5) return ellipse("r", center, {radius, radius * (0.3 + 0.6 * unit(generator))}, pick * 9, none);
  std::vector<Vec2> points;
  const int n = 3 + int(6 * unit(generator));
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * pi * (k + 0.5 * unit(generator)) / n;
    points.push_back(center + radius * (0.4 + 0.6 * unit(generator)) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon("r", points, none);
}

/// |A| - |A without B| = |B| - |B without A|.
TEST(KeepOut, AreasOfRandomRegionsAgreeFromBothSides) {
  int compared = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    std::mt19937 generator(seed);
    Shape a, b;
    a.outline = random_loop(generator);
    b.outline = random_loop(generator);
    try {
      const Shape less = without(a, b.outline), other = without(b, a.outline);
      const double common = area(a) - area(less);
      EXPECT_NEAR(common, area(b) - area(other), 1e-9) << seed;
      EXPECT_GE(common, -1e-12) << seed;
      EXPECT_LE(solid_in(less, b.outline).depth, 1e-9) << seed;
      ++compared;
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find("cannot be cut"), std::string::npos) << seed;
    }
  }
  EXPECT_GT(compared, 40);
}

TEST(KeepOut, MaterialInItIsMeasured) {
  const Intrusion found = solid_in(square(2), polygon("slot", {{0.5, 1.5}, {1.5, 1.5}, {1.5, 3}, {0.5, 3}}, none));
  EXPECT_NEAR(found.depth, 0.5, 0.05);
  OptimizeRequest r;
  r.keep_out = {circle("spanner", {1, 1}, 0.5, none)};
  const Shape frame = square(2);
  const std::vector<KeptConstraint> all = constraints_of({.shape = frame, .frame = &frame}, r);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].name, "keep_out spanner");
  EXPECT_FALSE(all[0].kept);
  EXPECT_TRUE(is_broken(all[0]));
  EXPECT_NEAR(all[0].got, 0.5, 0.02);
}

}  // namespace
}  // namespace kerf
