// Constraints against round outlines, regions, ellipses and curved cracks of the frame: their distances and
// derivatives.

#include "optimize/parametric/constraints.hpp"
#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/start.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::containers_test {
namespace {

using namespace scenes;
using Eigen::VectorXd;

constexpr double least = 0.1;

Drawn disc(const char* name, const Vec2& x, double radius, double box) {
  return drawn(Drawn::Kind::Circle, name, Eigen::Vector3d(x.x(), x.y(), radius), box);
}

/// The distance that a constraint speaks of, where there is one of that name.
std::optional<double> distance_of(const std::vector<Constraint>& all, const std::string& name, const VectorXd& x) {
  for (const Constraint& c : all)
    if (c.name.rfind(name, 0) == 0) return (1 - c.value(x, nullptr)) * least;
  return std::nullopt;
}

void expect_derivatives(const std::vector<Constraint>& all, const VectorXd& x) {
  for (const Constraint& c : all) {
    VectorXd by;
    c.value(x, &by);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      VectorXd a = x, b = x;
      a[i] += 1e-6;
      b[i] -= 1e-6;
      EXPECT_NEAR(by[i], (c.value(a, nullptr) - c.value(b, nullptr)) / 2e-6, 1e-5 * (1 + by.norm())) << c.name << i;
    }
  }
}

Problem round_plate() {
  Problem p;
  p.frame.labels = {"rim"};
  p.frame.outline = circle("rim", {0, 0}, 2, 0);
  p.sizing.size = 0.2;
  return p;
}

TEST(Containers, ARoundOutline) {
  const Problem p = round_plate();
  Design d{{disc("a", {1, 0.5}, 0.2, 1)}};
  const VectorXd x = start_of(d);
  const std::string name = "hole 'a' and the outline";
  EXPECT_NEAR(*distance_of(constraints(d, p, least, {}), name, x), 2 - std::hypot(1, 0.5) - 0.2, 1e-12);
  expect_derivatives(constraints(d, p, least, {}), x);
  // What its box keeps inside needs no constraint.
  EXPECT_FALSE(distance_of(constraints({{disc("a", {0.5, 0.5}, 0.2, 0.1)}}, p, least, {}), name, x));
  // What is no disc is looked at by its points.
  Design s{{drawn(Drawn::Kind::Spline, "s", blob({1, 0.5}, 0.4, 6), 1)}};
  const std::vector<Constraint> of_spline = constraints(s, p, least, {});
  double furthest = 0;
  for (const Vec2& y : shape_of(s.drawn[0]).boundary(s.drawn[0], start_of(s), false).points)
    furthest = std::max(furthest, y.norm());
  EXPECT_NEAR(*distance_of(of_spline, "hole 's' and the outline", start_of(s)), 2 - furthest, 0.01);
  expect_derivatives(of_spline, start_of(s));
}

TEST(Containers, RegionsHoldWhatBeginsInThem) {
  Problem p = round_plate();
  p.frame.regions = {circle("disc", {-0.8, 0}, 0.7, none),
                     polygon("box", {{0.2, -0.8}, {1.4, -0.8}, {1.4, 0.8}, {0.2, 0.8}}, none)};
  p.scene.regions.assign(2, plane_strain(2, 0.3));
  // In the disc; in the box; in none.
  const Design d{{disc("a", {-0.9, 0.1}, 0.2, 1.5), disc("b", {0.7, 0}, 0.3, 1.5), disc("c", {0, 1.5}, 0.1, 1.5)}};
  const VectorXd x = start_of(d);
  const std::vector<Constraint> all = constraints(d, p, least, {});
  const auto distance = [&](const std::string& name) { return *distance_of(all, name, x); };
  EXPECT_NEAR(distance("hole 'a' and region 'disc'"), 0.7 - std::hypot(0.1, 0.1) - 0.2, 1e-12);
  EXPECT_NEAR(distance("hole 'a' and region 'box'"), 1.1 - 0.2, 0.01);
  EXPECT_NEAR(distance("hole 'b' and region 'box'"), 0.2, 0.01);  // 0.5 to the left side
  EXPECT_NEAR(distance("hole 'b' and region 'disc'"), 1.5 - 0.7 - 0.3, 1e-12);
  EXPECT_NEAR(distance("hole 'c' and region 'disc'"), std::hypot(0.8, 1.5) - 0.8, 1e-12);
  EXPECT_NEAR(distance("hole 'c' and region 'box'"), std::hypot(0.2, 0.7) - 0.1, 0.01);
  expect_derivatives(all, x);
  // A spline begins where its first point does.
  const Design s{{drawn(Drawn::Kind::Spline, "s", blob({-0.8, 0}, 0.2, 6), 1.5)}};
  const std::vector<Constraint> of_spline = constraints(s, p, least, {});
  double furthest = 0, nearest = infinity;
  for (const Vec2& y : shape_of(s.drawn[0]).boundary(s.drawn[0], start_of(s), false).points) {
    furthest = std::max(furthest, (y - Vec2(-0.8, 0)).norm());
    nearest = std::min(nearest, 0.2 - y.x());
  }
  EXPECT_NEAR(*distance_of(of_spline, "hole 's' and region 'disc'", start_of(s)), 0.7 - furthest, 0.01);
  EXPECT_NEAR(*distance_of(of_spline, "hole 's' and region 'box'", start_of(s)), nearest, 0.02);
  // A box of places that stays in the region, and one that a side of it crosses.
  const auto kept = [&](const Vec2& at, double box) {
    const Design one{{disc("b", at, 0.15, box)}};
    return !distance_of(constraints(one, p, least, {}), "hole 'b' and region 'box'", start_of(one));
  };
  EXPECT_TRUE(kept({0.8, 0}, 0.05));
  EXPECT_FALSE(kept({0.8, 0}, 0.2));
}

/// A polygon may reach into a box without having a corner of the box outside of it.
TEST(Containers, ASpikeInTheBoxIsSeen) {
  Problem p = round_plate();
  p.frame.labels = {"side"};
  p.frame.outline = polygon("o", {{-2, -2}, {2, -2}, {2, 2}, {0.02, 2}, {0, 0.1}, {-0.02, 2}, {-2, 2}}, 0);
  const Design wide{{disc("a", {0, -0.5}, 0.3, 1)}}, below{{disc("a", {0, -1}, 0.3, 0.1)}};
  EXPECT_NEAR(*distance_of(constraints(wide, p, least, {}), "hole 'a' and the outline", start_of(wide)), 0.3, 0.01);
  EXPECT_FALSE(distance_of(constraints(below, p, least, {}), "hole 'a' and the outline", start_of(below)));
}

TEST(Containers, EllipsesAndCurvedCracksOfTheFrame) {
  Problem p = round_plate();
  p.frame.labels.push_back("hole");
  p.frame.holes = {ellipse("e", {-0.8, 0}, {0.6, 0.3}, 0, 1)};
  p.frame.cracks = {arc_crack("arc", {0, 0}, 1, -0.5, 0.5)};
  p.scene.laws.resize(1);
  const Design d{{disc("a", {0.3, 0.1}, 0.2, 1.2)}};
  const VectorXd x = start_of(d);
  const std::vector<Constraint> all = constraints(d, p, least, {});
  EXPECT_NEAR(*distance_of(all, "hole 'a' and crack 'arc'", x), 1 - std::hypot(0.3, 0.1) - 0.2, 0.01);
  // The point of the ellipse nearest to the center, by search.
  double nearest = infinity;
  for (int i = 0; i < 20000; ++i) {
    const double t = 2 * pi * i / 20000;
    nearest = std::min(nearest, (Vec2(-0.8 + 0.6 * std::cos(t), 0.3 * std::sin(t)) - Vec2(0.3, 0.1)).norm());
  }
  EXPECT_NEAR(*distance_of(all, "hole 'a' and hole 'e'", x), nearest - 0.2, 0.01);
  // The same axes turned by the angle of an ellipse are no circle either.
  Problem skew = p;
  skew.frame.holes[0].sides[0].arc->axes << 0.5, 0.3, 0, 0.4;
  EXPECT_TRUE(distance_of(constraints(d, skew, least, {}), "hole 'a' and hole 'e'", x));
}

/// A thing that does not move has no constraints of its own, but others keep away from it, whichever comes first.
TEST(Containers, WhatIsFixedIsKeptAwayFrom) {
  const Problem p = round_plate();
  for (const bool first : {true, false}) {
    Design d{{disc("a", {-0.5, 0}, 0.2, 0), disc("b", {0.5, 0}, 0.3, 1)}};
    if (!first) std::swap(d.drawn[0], d.drawn[1]);
    const std::vector<Constraint> all = constraints(d, p, least, {});
    EXPECT_EQ(std::ranges::count_if(all, [](const Constraint& c) { return c.name.find("'a'") != std::string::npos; }),
              1);
    EXPECT_NEAR(*distance_of(all, "hole 'b' and hole 'a'", start_of(d)), 0.5, 1e-12);
  }
}

}  // namespace
}  // namespace kerf::containers_test
