// Curves that end on arcs of the frame, and beside its corners.

#include "geometry/plane.hpp"
#include "kerf/shape_gradient.hpp"
#include "optimize/curves.hpp"
#include "optimize/curves/boundary.hpp"
#include "optimize/curves/curve_mesh.hpp"
#include "optimize/loop/evaluate.hpp"

#include <gtest/gtest.h>

namespace kerf::curved_frame_test {
namespace {

using Eigen::VectorXd;

const Mat2 unit_axes = Mat2::Identity();

Vec2 polar(double radius, double angle) {
  return radius * Vec2(std::cos(angle), std::sin(angle));
}

/// Pieces of the design from one angle to another, at most `depth` off the circle, the start of the next side left out.
void add_bite(std::vector<Side>& sides, double radius, double depth, std::array<double, 2> angle, Index label) {
  constexpr int pieces = 8;
  for (int k = 0; k < pieces; ++k) {
    const double part = double(k) / pieces;
    sides.push_back({polar(radius + depth * std::sin(pi * part), angle[0] + part * (angle[1] - angle[0])), label,
                     std::nullopt, false, true});
  }
}

/// A quarter of a disc of radius 2, clamped at the bottom, loaded at the left, free along the arc.
Problem quarter_disc(double size) {
  Problem p;
  p.frame.labels = {"bottom", "rim", "left"};
  p.frame.outline = {
      "outline",
      {{{0, 0}, 0, std::nullopt}, {{2, 0}, 1, Arc{{0, 0}, 2 * unit_axes, 0, pi / 2}}, {{0, 2}, 2, std::nullopt}}};
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 0, .value = [](const Vec2&, const Vec2&) { return Vec2(0, 0); }}};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(-0.3 * x.y(), 0.5); }}};
  p.sizing.size = size;
  p.objective = {"compliance", {compliance()}};
  return p;
}
Carved bitten_disc(const Problem& p) {
  Carved carved{.shape = p.frame, .design_label = 3};
  carved.shape.labels.push_back("design");
  std::vector<Side>& sides = carved.shape.outline.sides;
  sides = {{{0, 0}, 0, std::nullopt}, {{2, 0}, 1, Arc{{0, 0}, 2 * unit_axes, 0, pi / 6}}};
  add_bite(sides, 2, -0.5, {pi / 6, pi / 3}, 3);
  sides.push_back({polar(2, pi / 3), 1, Arc{{0, 0}, 2 * unit_axes, pi / 3, pi / 2}});
  sides.push_back({{0, 2}, 2, std::nullopt});
  carved.area = area(carved.shape);
  return carved;
}

/// A square with a round hole, from which the design grows into the body.
Problem pierced(double size) {
  Problem p;
  p.frame.labels = {"bottom", "side", "top", "hole"};
  p.frame.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 1);
  p.frame.outline.sides[0].label = 0;
  p.frame.outline.sides[2].label = 2;
  p.frame.holes = {circle("hole", {0, 0}, 1, 3)};
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 0, .value = [](const Vec2&, const Vec2&) { return Vec2(0, 0); }}};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.2, 1 + 0.2 * x.x()); }}};
  p.sizing.size = size;
  p.objective = {"compliance", {compliance()}};
  return p;
}
Carved grown_hole(const Problem& p) {
  Carved carved{.shape = p.frame, .design_label = 4};
  carved.shape.labels.push_back("design");
  std::vector<Side>& sides = carved.shape.holes[0].sides;  // the body on the left: clockwise
  sides = {{polar(1, pi / 6), 3, Arc{{0, 0}, unit_axes, pi / 6, -4 * pi / 3}}};
  add_bite(sides, 1, 0.5, {-4 * pi / 3, -11 * pi / 6}, 4);
  carved.area = area(carved.shape);
  return carved;
}

/// An L whose notch is cut off by the design: the corner (1, 1) lies in the void, 0.07 away.
Problem angle_bracket(double size) {
  Problem p;
  p.frame.labels = {"bottom", "free", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1);
  p.frame.outline.sides[0].label = 0;
  p.frame.outline.sides[5].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 0, .value = [](const Vec2&, const Vec2&) { return Vec2(0, 0); }}};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(-0.5 * x.y(), 0); }}};
  p.sizing.size = size;
  p.objective = {"compliance", {compliance()}};
  return p;
}
Carved beside_the_corner(const Problem& p) {
  Carved carved{.shape = p.frame, .design_label = 3};
  carved.shape.labels.push_back("design");
  carved.shape.outline.sides = {{{0, 0}, 0, std::nullopt}, {{2, 0}, 1, std::nullopt}};
  for (const Vec2& x : {Vec2(2, 0.8), Vec2(1.3, 0.85), Vec2(0.95, 0.95), Vec2(0.85, 1.3)})
    carved.shape.outline.sides.push_back({x, 3, std::nullopt, false, true});
  carved.shape.outline.sides.push_back({{0.8, 2}, 1, std::nullopt});
  carved.shape.outline.sides.push_back({{0, 2}, 2, std::nullopt});
  carved.area = area(carved.shape);
  return carved;
}

DesignCurves curves_of(const Problem& p, const Carved& carved, const std::vector<Index>& solid) {
  const double h = p.sizing.size;
  return design_curves(p.frame, carved, {h, 0.2 * h, 2 * h, h, solid});
}

OptimizeRequest as_light(const Problem& p, const Carved& carved) {
  OptimizeRequest r;
  r.volume_at_most = carved.area / area(p.frame);
  return r;
}

/// Derivatives of the area and of J by every variable against differences; the ends of the chain stay on the circle.
void expect_derivatives(const Problem& p, const Carved& carved, double radius) {
  const DesignCurves d = curves_of(p, carved, {0, 2});
  ASSERT_EQ(d.rails.size(), 1u);
  ASSERT_EQ(d.apart.size(), 1u);
  VectorXd by_area;
  area_of(d, &by_area);
  const CurveMesh mesh = curve_mesh(d, p.sizing);
  const OptimizeRequest r = as_light(p, carved);
  const auto evaluate = [&](const VectorXd& step) {
    const DesignCurves there = moved(d, step);
    for (const Knot* end : {&there.chains[0].knots.front(), &there.chains[0].knots.back()})
      EXPECT_NEAR(end->at.norm(), radius, 1e-12);
    return evaluate_mesh(p, r, shape_of(there), moved(mesh, there).value(), {});
  };
  const Evaluated e = evaluate(VectorXd::Zero(d.variables));
  const VectorXd by =
      pull_back(mesh, d, shape_gradient(analyze(e.objective, e.cases[0].model, e.cases[0].state), e.objective));
  for (Eigen::Index k = 0; k < d.variables; ++k) {
    const double step = 1e-4;
    const VectorXd unit = step * VectorXd::Unit(d.variables, k);
    EXPECT_NEAR(by_area[k], (area_of(moved(d, unit), nullptr) - area_of(moved(d, -unit), nullptr)) / (2 * step), 1e-6);
    EXPECT_NEAR(by[k], (evaluate(unit).J - evaluate(-unit).J) / (2 * step), 2e-5 * by.cwiseAbs().maxCoeff()) << k;
  }
}

TEST(CurvesOnArcs, DerivativesOfWhatEndsOnTheOutline) {
  const Problem p = quarter_disc(0.3);
  expect_derivatives(p, bitten_disc(p), 2);
}

TEST(CurvesOnArcs, DerivativesOfWhatEndsOnARoundHole) {
  const Problem p = pierced(0.5);
  expect_derivatives(p, grown_hole(p), 1);
}

// The circle may be gone round from either end, but for the point where its long arc is parted (255 degrees).
TEST(CurvesOnArcs, EndsOnAWholeCircleAreLimitedByTheirOwnArc) {
  const Problem p = pierced(0.5);
  const DesignCurves d = curves_of(p, grown_hole(p), {0, 2});
  const KnotHold &first = d.holds[0].front(), &last = d.holds[0].back();
  const double gap = 0.75 * 0.5;
  // The chain begins at 120 degrees, where the arc from 255 degrees ends, and ends at 30, where that to -105 begins.
  EXPECT_EQ(first.lower, -infinity);
  EXPECT_NEAR(first.upper, 17 * pi / 12 - gap, 1e-9);
  EXPECT_NEAR(last.lower, -7 * pi / 12 + gap, 1e-9);
  EXPECT_EQ(last.upper, infinity);
  for (const KnotHold& hold : {first, last}) {
    EXPECT_EQ(hold.kind, KnotHold::Kind::Slides);
    EXPECT_TRUE(angles_of(d)[std::size_t(hold.offset)]);  // along an arc: an angle
  }
  // A hole that bears a load is no rail: the ends stay.
  const DesignCurves held = curves_of(p, grown_hole(p), {0, 2, 3});
  for (const KnotHold& hold : held.holds[0]) EXPECT_NE(hold.kind, KnotHold::Kind::Slides);
}

TEST(CurvesOnArcs, StepsLowerJAndKeepTheArcs) {
  for (const bool outside : {true, false}) {
    const Problem p = outside ? quarter_disc(0.15) : pierced(0.25);
    const Carved carved = outside ? bitten_disc(p) : grown_hole(p);
    const FinishedCurves f = finish_curves(p, as_light(p, carved), carved, {.evaluations = 8}, {});
    EXPECT_LT(f.J, f.rows.front().J) << f.why;
    EXPECT_TRUE(f.feasible);
    EXPECT_LE(f.area, carved.area * (1 + 1e-3));
    EXPECT_FALSE(find_problem(f.shape));
    const double radius = outside ? 2 : 1;
    const Loop& loop = outside ? f.shape.outline : f.shape.holes[0];
    int arcs = 0;
    for (const Side& side : loop.sides) {
      if (side.label != (outside ? 1 : 3)) continue;
      ++arcs;
      ASSERT_TRUE(side.arc);
      EXPECT_NEAR(side.start.norm(), radius, 1e-9);
      EXPECT_LT(side.arc->center.norm(), 1e-9);
      EXPECT_NEAR(side.arc->axes.col(0).norm(), radius, 1e-9);
    }
    EXPECT_EQ(arcs, 2);  // that of the hole is parted in the middle
  }
}

/// How far x is in the notch, where no frame is.
double in_notch(const Vec2& x) {
  return std::max(0.0, std::min(x.x() - 1, x.y() - 1));
}

TEST(CurvesAtCorners, OverhangIsHowFarTheBodyCoversACorner) {
  const Problem p = angle_bracket(0.1);
  DesignCurves d = curves_of(p, beside_the_corner(p), {0, 2});
  EXPECT_EQ(overhang(d, p.frame, {}, 0.1), 0);
  VectorXd out = VectorXd::Zero(d.variables);
  for (const KnotHold& hold : d.holds[0])
    if (hold.kind == KnotHold::Kind::Free) out[hold.offset] = -0.15;  // to the right of the chain is the void
  d = moved(d, out);
  const Polygon polygon = flatten(shape_of(d).outline, 1e-4, 0.01);
  ASSERT_TRUE(inside(polygon.points, Vec2(1, 1)));
  double deep = 0, away = infinity;
  for (std::size_t i = 0; i < polygon.points.size(); ++i) {
    deep = std::max(deep, in_notch(polygon.points[i]));
    away = std::min(away, distance(Vec2(1, 1), polygon.points[i], polygon.points[(i + 1) % polygon.points.size()]));
  }
  EXPECT_GT(std::max(deep, away), 0.03);
  EXPECT_NEAR(overhang(d, p.frame, {}, 0.1), std::max(deep, away), 0.01);
}

TEST(CurvesAtCorners, NoStepCoversTheNotch) {
  const Problem p = angle_bracket(0.12);
  const Carved carved = beside_the_corner(p);
  const FinishedCurves f = finish_curves(p, as_light(p, carved), carved, {.evaluations = 10}, {});
  EXPECT_LT(f.J, f.rows.front().J) << f.why;
  EXPECT_FALSE(find_problem(f.shape));
  for (const Vec2& x : flatten(f.shape.outline, 1e-3, 0.02).points) EXPECT_LT(in_notch(x), 0.01 * 0.12);
}

/// The fitted curve would cut the corner by a few hundredths: it is brought back before anything is solved.
TEST(CurvesAtCorners, WhatTheFitLeavesOutsideComesBack) {
  const Problem p = angle_bracket(0.15);
  Carved carved = beside_the_corner(p);
  std::vector<Side>& sides = carved.shape.outline.sides;
  sides[2].start = {2, 0.97};
  sides[3].start = {1.3, 0.985};
  sides[4].start = {0.999, 0.999};
  sides[5].start = {0.985, 1.3};
  sides[6].start = {0.97, 2};
  carved.area = area(carved.shape);
  EXPECT_GT(overhang(curves_of(p, carved, {0, 2}), p.frame, {}, 0.15), 0.003);
  const FinishedCurves f = finish_curves(p, as_light(p, carved), carved, {.evaluations = 4}, {});
  for (const Vec2& x : flatten(f.shape.outline, 1e-3, 0.02).points) EXPECT_LT(in_notch(x), 0.01 * 0.15);
}

}  // namespace
}  // namespace kerf::curved_frame_test
