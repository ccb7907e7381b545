// Designs that are their own mirror image: bodies of a half and its image, and curves of which one half moves, about
// random lines.

#include "optimize/constraints/mirrored.hpp"
#include "geometry/plane.hpp"

#include "optimize/constraints.hpp"
#include "optimize/curves.hpp"
#include "optimize/curves/boundary.hpp"
#include "optimize/curves/design_curves.hpp"
#include "tests/optimize/curves.hpp"
#include "tests/support/dice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kerf::mirrored_test {
namespace {

using test::Dice;

/// A square of side 4 with four labels, turned and moved, and one of its four lines of symmetry.
struct Turned {
  Shape frame;
  Mirror mirror;
  Vec2 middle;
  double angle;
  Vec2 at(double x, double y) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return middle + Vec2(c * x - s * y, s * x + c * y);
  }
};
Turned turned(Dice& dice, int line) {
  Turned t;
  t.middle = {dice.between(-3, 3), dice.between(-3, 3)};
  t.angle = dice.between(0, 6);
  t.frame.labels = {"a", "b", "c", "d"};
  t.frame.outline = polygon("outline", {t.at(-2, -2), t.at(2, -2), t.at(2, 2), t.at(-2, 2)}, 0);
  for (int k = 0; k < 4; ++k) t.frame.outline.sides[std::size_t(k)].label = k;
  t.mirror.point = t.middle;
  const double way = line * pi / 4;
  t.mirror.direction = t.at(std::cos(way), std::sin(way)) - t.middle;
  return t;
}

/// With round holes, one across the line, one beside it, and a notch at a corner.
Shape holed(const Turned& t, Dice& dice) {
  Shape body = t.frame;
  body.labels.push_back("design");
  const auto disc = [&](const Vec2& at, double r, int n) {
    std::vector<Vec2> points;
    for (int k = 0; k < n; ++k) points.push_back(at + r * Vec2(std::cos(2 * pi * k / n), std::sin(2 * pi * k / n)));
    body.holes.push_back(polygon("hole", points, 4));
  };
  const Vec2 along = t.mirror.direction, across(-along.y(), along.x());
  disc(t.middle + dice.between(-0.4, 0.4) * along + dice.between(-0.1, 0.1) * across, dice.between(0.2, 0.4), 24);
  disc(t.middle + dice.between(-0.4, 0.4) * along + dice.between(1, 1.1) * across, dice.between(0.2, 0.3), 16);
  return body;
}

TEST(Mirrored, AHalfAndItsImageAreABody) {
  Dice dice(1);
  for (int k = 0; k < 60; ++k) {
    const Turned t = turned(dice, k % 4);
    const Shape body = holed(t, dice);
    const double side = k % 2 == 0 ? 1 : -1;
    const std::optional<Shape> whole = symmetric(body, t.frame, t.mirror, side);
    ASSERT_TRUE(whole) << k;
    EXPECT_FALSE(find_problem(*whole));
    EXPECT_LE(asymmetry(*whole, t.mirror).distance, 1e-13) << k;
    EXPECT_EQ(whole->holes.size(), side > 0 ? 3u : 1u);  // the hole beside the line is on its left
    EXPECT_EQ(whole->outline.sides.size(), 4u);          // sides that the line cuts are whole again
    for (const Side& s : whole->outline.sides) {
      bool found = false;
      for (const Side& f : t.frame.outline.sides) found = found || (f.start == s.start && f.label == s.label);
      EXPECT_TRUE(found);
    }
    // Twice the half that is kept.
    const std::optional<Shape> other = symmetric(body, t.frame, t.mirror, -side);
    ASSERT_TRUE(other);
    EXPECT_NEAR(area(*whole) + area(*other), 2 * area(body), 1e-12);
    // What is its own image already stays so.
    const std::optional<Shape> again = symmetric(*whole, t.frame, t.mirror, side);
    ASSERT_TRUE(again);
    EXPECT_NEAR(area(*again), area(*whole), 1e-13);
    EXPECT_EQ(again->holes.size(), whole->holes.size());
  }
}

TEST(Mirrored, ArcsOfTheFrameStayTheFramesOwn) {
  Shape frame;
  frame.labels = {"round", "bore"};
  frame.outline = circle("outline", {1, 2}, 2, 0);
  frame.outline.sides = {{{-1, 2}, 0, Arc{{1, 2}, 2 * Mat2::Identity(), pi, 1.5 * pi}},
                         {{1, 0}, 0, Arc{{1, 2}, 2 * Mat2::Identity(), 1.5 * pi, 2.5 * pi}},
                         {{1, 4}, 0, Arc{{1, 2}, 2 * Mat2::Identity(), 0.5 * pi, pi}}};
  frame.holes = {circle("left", {0, 2}, 0.3, 1), circle("right", {2, 2}, 0.3, 1)};
  Shape body = frame;
  body.labels.push_back("design");
  body.holes.push_back(polygon("hole", {{1.3, 3}, {1.5, 2.8}, {1.5, 3.2}}, 2));
  const Mirror mirror{{1, 0}, {0, 1}};
  const auto right = symmetric(body, frame, mirror, -1), left = symmetric(body, frame, mirror, 1);
  ASSERT_TRUE(right && left);
  EXPECT_EQ(right->holes.size(), 4u);
  EXPECT_EQ(left->holes.size(), 2u);
  EXPECT_LE(asymmetry(*right, mirror).distance, 1e-13);
  EXPECT_NEAR(area(*left), area(frame), 1e-12);
  for (const Side& s : left->outline.sides) {
    ASSERT_TRUE(s.arc);
    EXPECT_EQ(s.arc->center, Vec2(1, 2));
    EXPECT_EQ(s.label, 0);
  }
}

// A side of the frame that bears something on one side of the line alone stays where it is, and whole.
TEST(Mirrored, LabelsOfTheFrameStayWhereTheyAre) {
  Dice dice(4);
  for (int k = 0; k < 40; ++k) {
    Turned t = turned(dice, k % 4);
    const auto mark = [&](std::size_t side, Index label) {
      std::vector<Side>& sides = t.frame.outline.sides;
      const Vec2 a = sides[side].start, b = sides[(side + 1) % sides.size()].start;
      const double low = dice.between(0.05, 0.6), high = low + 0.3;
      sides.insert(sides.begin() + std::ptrdiff_t(side) + 1,
                   {{(1 - low) * a + low * b, label, {}}, {(1 - high) * a + high * b, sides[side].label, {}}});
    };
    mark(3, 4);
    mark(1, 5);
    t.frame.labels = {"a", "b", "c", "d", "load", "held"};
    Shape body = t.frame;
    body.labels.push_back("design");
    body.holes.push_back(polygon("hole", {t.at(0.1, 0.2), t.at(0.9, 0.3), t.at(0.4, 0.9)}, 6));
    for (const double side : {1.0, -1.0}) {
      const std::optional<Shape> whole = symmetric(body, t.frame, t.mirror, side);
      ASSERT_TRUE(whole) << k;
      ASSERT_EQ(whole->outline.sides.size(), t.frame.outline.sides.size()) << k;
      for (const Side& f : t.frame.outline.sides) {
        bool found = false;
        for (const Side& s : whole->outline.sides)
          found = found || ((f.start - s.start).norm() < 1e-12 && f.label == s.label);
        EXPECT_TRUE(found) << k;
      }
    }
  }
}

TEST(Mirrored, LoadsAreLookedAtSideBySide) {
  Dice dice(3);
  for (int k = 0; k < 20; ++k) {
    const Turned t = turned(dice, 0);  // the line runs from side b to side d, a and c are images
    Scene scene;
    const Vec2 pull(dice.between(-1, 1), dice.between(-1, 1)), seen = image_of(t.mirror, t.middle + pull) - t.middle;
    const auto constant = [](const Vec2& v) { return [v](const Vec2&, const Vec2&) { return v; }; };
    scene.supports = {{.label = 1, .value = constant(Vec2::Zero())}};
    scene.tractions = {{0, constant(pull)}, {2, constant(seen)}};
    EXPECT_TRUE(are_mirrored(t.frame, {scene}, t.mirror));
    scene.tractions[1].value = constant(-seen);
    EXPECT_TRUE(are_mirrored(t.frame, {scene}, t.mirror));
    scene.tractions[1].value = constant(0.9 * seen);
    EXPECT_FALSE(are_mirrored(t.frame, {scene}, t.mirror));
    scene.tractions.clear();
    EXPECT_TRUE(are_mirrored(t.frame, {scene}, t.mirror));
    scene.supports[0].label = 0;
    EXPECT_FALSE(are_mirrored(t.frame, {scene}, t.mirror));
  }
}

TEST(Mirrored, WhatDoesNotReachTheLineIsNoBody) {
  Shape frame;
  frame.labels = {"free"};
  frame.outline = polygon("outline", {{-2, -1}, {2, -1}, {2, 1}, {-2, 1}}, 0);
  Shape body = frame;
  body.labels.push_back("design");
  body.outline = polygon("outline", {{-2, -1}, {-1, -1}, {-1, 1}, {-2, 1}}, 1);
  EXPECT_FALSE(symmetric(body, frame, {{0, 0}, {0, 1}}, 1));
  EXPECT_FALSE(symmetric(body, frame, {{0, 0}, {0, 1}}, -1));
}

Carved carved_of(const Shape& shape, Index design) {
  Carved c;
  c.shape = shape;
  c.design_label = design;
  c.area = area(shape);
  return c;
}

using Eigen::VectorXd;

VectorXd random_step(Dice& dice, Eigen::Index n, double size) {
  VectorXd step(n);
  for (double& s : step) s = dice.between(-size, size);
  return step;
}

// Pairs of chains, chains across the line, closed and open ones, whatever the line.
/// Points of flat arcs are known to the rounding of their centers, as constraints_of has it.
double rounding(const Shape& shape) {
  double flat = 0;
  const auto look = [&](const Loop& loop) {
    for (const Side& side : loop.sides)
      if (side.arc) flat = std::max(flat, largest_radius(*side.arc));
  };
  look(shape.outline);
  for (const Loop& hole : shape.holes) look(hole);
  return std::max(1e-13, 4 * std::numeric_limits<double>::epsilon() * flat);
}

TEST(Mirrored, CurvesMoveWithTheirImages) {
  Dice dice(2);
  for (int k = 0; k < 24; ++k) {
    const Turned t = turned(dice, k % 4);
    const auto whole = symmetric(holed(t, dice), t.frame, t.mirror, 1);
    ASSERT_TRUE(whole);
    const CurveRules rules{.size = 0.1,
                           .tolerance = 0.01,
                           .least_spacing = 0.2,
                           .least_gap = 0.1,
                           .solid = {},
                           .held = {},
                           .mirror = t.mirror};
    const DesignCurves d = design_curves(t.frame, carved_of(*whole, 4), rules);
    EXPECT_LE(asymmetry(shape_of(d), t.mirror).distance, rounding(shape_of(d)));
    const DesignCurves next = moved(d, random_step(dice, d.variables, 0.01));
    EXPECT_LE(asymmetry(shape_of(next), t.mirror).distance, rounding(shape_of(next)));
    EXPECT_NE(pack(next), pack(d));
    // Less than half as many as without the mirror need.
    CurveRules alone = rules;
    alone.mirror.reset();
    EXPECT_LE(d.variables, design_curves(t.frame, carved_of(*whole, 4), alone).variables / 2 + 8);
    // The area's derivative.
    VectorXd by;
    area_of(d, &by);
    const VectorXd way = random_step(dice, d.variables, 1);
    const double h = 1e-5,
                 change = (area_of(moved(d, h * way), nullptr) - area_of(moved(d, -h * way), nullptr)) / (2 * h);
    EXPECT_NEAR(by.dot(way), change, 1e-7);
    // Normal moves at points and at their images are the same.
    const NormalMoves moves = normal_moves(d);
    const VectorXd v = moves.by * way;
    for (std::size_t i = 0; i < moves.at.size(); i += 5) {
      std::size_t image = 0;
      for (std::size_t j = 0; j < moves.at.size(); ++j)
        if ((moves.at[j] - image_of(t.mirror, moves.at[i])).norm() <
            (moves.at[image] - image_of(t.mirror, moves.at[i])).norm())
          image = j;
      EXPECT_NEAR(v[Eigen::Index(i)], v[Eigen::Index(image)], 1e-9);
    }
    DesignCurves even = next;
    even_out(even);
    EXPECT_LE(asymmetry(shape_of(even), t.mirror).distance, rounding(shape_of(even)));
    EXPECT_TRUE(offset_to_area(even, area_of(d, nullptr)));
    EXPECT_LE(asymmetry(shape_of(even), t.mirror).distance, rounding(shape_of(even)));
  }
}

// A quarter of a hole: one open chain across the diagonal, whose ends slide on two sides of the frame. Loads are not
// symmetric; the design is, and it gets stiffer.
TEST(Mirrored, FinishedCurvesAreTheirOwnImage) {
  const Problem p = scenes::quarter_plate(2, 0.15);
  const Carved carved = scenes::quarter_hole(p, 0.6, 12);
  OptimizeRequest r;
  r.volume_at_most = carved.area / area(p.frame);
  r.level_set.mirror = Mirror{{0, 0}, Vec2(1, 1).normalized()};
  const FinishedCurves f = finish_curves(p, r, carved, {.evaluations = 8}, {});
  EXPECT_LE(asymmetry(f.shape, *r.level_set.mirror).distance, 1e-13);
  EXPECT_TRUE(f.feasible);
  ASSERT_FALSE(f.rows.empty());
  EXPECT_LT(f.J, f.rows.front().J);
  r.level_set.mirror.reset();
  EXPECT_GT(
      asymmetry(finish_curves(p, r, carved, {.evaluations = 8}, {}).shape, Mirror{{0, 0}, Vec2(1, 1).normalized()})
          .distance,
      1e-3);
}

}  // namespace
}  // namespace kerf::mirrored_test
