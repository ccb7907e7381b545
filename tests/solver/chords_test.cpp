// Which edges of a mesh stand for an arc. The truths are the shapes that the edges are drawn from.

#include "solver/post/chords.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::chords_test {
namespace {

Shape plate() {
  Shape s;
  s.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  return s;
}

/// Every piece of a straight side, whatever its length, and whatever arc is near.
void expect_none_on(const Shape& shape, const std::vector<Vec2>& corners, std::mt19937& random, double size) {
  std::uniform_real_distribution<double> in(0, 1);
  const Chords chords(shape);
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int trial = 0; trial < 5; ++trial) {
      const Vec2 side = corners[(i + 1) % corners.size()] - corners[i];
      const double from = trial == 0 ? 0 : in(random)*0.9, to = trial == 0 ? 1 : from + (1 - from) * in(random);
      const Vec2 a = corners[i] + from * side, b = corners[i] + to * side;
      EXPECT_EQ(chords.curvature(a, b, (b - a).norm()), 0) << size;
      EXPECT_EQ(chords.curvature(a, b, 4 * (b - a).norm()), 0) << size;
    }
}

TEST(Chords, StraightSidesBesideHolesOfAnySizeAreNone) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const double radius = std::pow(10, -6 + 5.5 * in(random));
    Shape s = plate();
    const Vec2 center(0.4 + 1.2 * in(random), 0.4 + 0.2 * in(random));
    s.holes.push_back(trial % 2 == 0 ? circle("h", center, radius, 1)
                                     : ellipse("h", center, {radius, 0.05 * radius}, 6 * in(random), 1));
    expect_none_on(s, {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, random, radius);
  }
}

TEST(Chords, PolygonsWithTheirCornersOnACircleAreNone) {
  std::mt19937 random(8);
  for (int corners = 3; corners <= 40; ++corners) {
    Shape s = plate();
    std::vector<Vec2> points;
    for (int i = 0; i < corners; ++i)
      points.push_back(Vec2(1, 0.5) + 0.2 * Vec2(std::cos(2 * pi * i / corners), std::sin(2 * pi * i / corners)));
    s.holes.push_back(polygon("h", points, 1));
    s.regions.push_back(circle("r", {1, 0.5}, 0.2000001, none));
    expect_none_on(s, points, random, corners);
  }
}

TEST(Chords, TheStraightSideThatClosesAnArcIsNone) {
  Shape s;
  s.outline.sides = {{{-1, 0}, 0, std::nullopt}, {{1, 0}, 0, Arc{{0, 0}, Mat2::Identity(), 0, pi}}};
  EXPECT_EQ(Chords(s).curvature({-1, 0}, {1, 0}, 2), 0);
  EXPECT_EQ(Chords(s).curvature({-0.5, 0}, {0, 0}, 0.5), 0);
  EXPECT_NEAR(Chords(s).curvature({1, 0}, {std::cos(0.3), std::sin(0.3)}, 2 * std::sin(0.15)), 1, 1e-12);
}

// With the corners pushed out, so that the polygon has the area of its circle; and each chord divided.
TEST(Chords, OfCirclesHaveTheCurvatureOfTheirOwn) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> in(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const double radius = std::pow(10, -5 + 4 * in(random));
    const int n = 5 + static_cast<int>(40 * in(random));
    Shape s = plate();
    s.holes = {circle("h", {0.5, 0.5}, radius, 1), circle("beside", {0.5 + 2.2 * radius, 0.5}, 0.3 * radius, 2),
               circle("large", {1.5, 0.5}, 0.3, 3)};
    const Chords chords(s);
    const double out = trial % 2 == 0 ? 1 : std::sqrt(2 * pi / n / std::sin(2 * pi / n)), turn = in(random);
    const auto corner = [&](int i) -> Vec2 {
      const double t = turn + 2 * pi * i / n;
      return Vec2(0.5, 0.5) + out * radius * Vec2(std::cos(t), std::sin(t));
    };
    for (int i = 0; i < n; ++i) {
      const Vec2 a = corner(i), b = corner(i + 1);
      const double h = (b - a).norm();
      EXPECT_NEAR(chords.curvature(a, b, h) * radius, 1, 1e-9) << radius << " " << n;
      EXPECT_NEAR(chords.curvature(a, 0.5 * (a + b), h) * radius, 1, 1e-9) << radius << " " << n;
      EXPECT_NEAR(chords.curvature(0.75 * a + 0.25 * b, 0.5 * (a + b), h) * radius, 1, 1e-9) << radius << " " << n;
    }
  }
}

TEST(Chords, OfEllipsesHaveTheCurvatureOfThePlace) {
  Shape s = plate();
  s.holes.push_back(ellipse("h", {1, 0.5}, {0.4, 0.1}, 0, 1));
  const Chords chords(s);
  const Polygon p = flatten(s.holes[0], 1e-3, 0.05);
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Vec2 a = p.points[i], b = p.points[(i + 1) % p.points.size()], y = 0.5 * (a + b) - Vec2(1, 0.5);
    const double t = std::atan2(y.y() / 0.1, y.x() / 0.4),
                 truth = 0.04 / std::pow(std::hypot(0.4 * std::sin(t), 0.1 * std::cos(t)), 3);
    EXPECT_NEAR(chords.curvature(a, b, (b - a).norm()), truth, 1e-9 * truth);
  }
}

}  // namespace
}  // namespace kerf::chords_test
