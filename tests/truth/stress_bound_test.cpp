// A bound of a norm of the stress beside a reentrant corner of the frame: what displacement elements say of the curves
// on a finer mesh, against the bound, the frame, and the compliance without a bound.

#include "kerf/analysis.hpp"
#include "kerf/mesher.hpp"
#include "optimize/curves.hpp"

#include <gtest/gtest.h>

namespace kerf::stress_bound_test {

namespace {

constexpr double arm = 0.4, power = 8;

/// Held at the top, loaded at the right end of the lower arm.
Problem bracket() {
  Problem p;
  p.frame.labels = {"rest", "top", "load"};
  p.frame.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 0.1}, {1, 0.3}, {1, arm}, {arm, arm}, {arm, 1}, {0, 1}}, 0);
  p.frame.outline.sides[2].label = 2;
  p.frame.outline.sides[6].label = 1;
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 1, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, 0}; }}};
  p.scene.tractions = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, -1}; }}};
  p.sizing.size = 0.06;
  p.objective = {"compliance", {compliance()}};
  return p;
}

/// Without the outer corner, and hollow around the inner one.
Carved carved_bracket(const Problem& p) {
  constexpr double hollow = 0.1;
  constexpr int pieces = 6;
  Carved carved;
  carved.shape = p.frame;
  carved.shape.labels.emplace_back("design");
  carved.design_label = 3;
  std::vector<Vec2> at{{0.25, 0}, {1, 0}, {1, 0.1}, {1, 0.3}, {1, arm}};
  std::vector<Index> label{0, 0, 2, 0, 0};
  for (int k = 0; k <= pieces; ++k) {
    const double t = -1.5 * pi * k / pieces;  // through the body
    at.push_back(Vec2(arm, arm) + hollow * Vec2(std::cos(t), std::sin(t)));
    label.push_back(k < pieces ? 3 : 0);
  }
  at[5] = {arm + hollow, arm};  // exactly
  at[5 + pieces] = {arm, arm + hollow};
  for (const auto& [x, of] : std::vector<std::pair<Vec2, Index>>{{{arm, 1}, 1}, {{0, 1}, 0}, {{0, 0.25}, 3}})
    at.push_back(x), label.push_back(of);
  carved.shape.outline = polygon("outline", at, 0);
  for (std::size_t i = 0; i < label.size(); ++i) carved.shape.outline.sides[i].label = label[i];
  carved.area = area(carved.shape);
  return carved;
}

/// Beyond the inner corner.
double outside(const Shape& shape) {
  double most = 0;
  for (const Vec2& x : flatten(shape.outline, 1e-5, infinity).points)
    most = std::max(most, std::min(x.x(), x.y()) - arm);
  return most;
}

struct Told {
  double compliance, norm;
};
Told told(const Problem& p, const OptimizeRequest& r, const Shape& shape) {
  const Model m = prepare(triangulate(shape, {.size = 0.02}), element("p2", 1), p.scene, 1);
  const State state = solve(m);
  return {analyze(p.objective, m, state, true).value, analyze(r.bounds[0].functional, m, state, true).value};
}

TEST(StressBound, HoldsBesideAReentrantCornerInsideTheFrame) {
  const Problem p = bracket();
  const Carved carved = carved_bracket(p);
  OptimizeRequest r;
  r.volume_at_most = carved.area / area(p.frame);
  const FinishedCurves free = finish_curves(p, r, carved, {}, {});
  EXPECT_LT(outside(free.shape), 1e-4) << free.why;
  FunctionalBound bound{"stress", {"stress_pnorm", {stress_pnorm(power, {}, false)}}, 0};
  bound.at_most = 1e9;
  r.bounds = {bound};
  const Told without = told(p, r, free.shape);
  r.bounds[0].at_most = 0.93 * without.norm;
  const FinishedCurves bounded = finish_curves(p, r, carved, {}, {});
  EXPECT_LT(outside(bounded.shape), 1e-4) << bounded.why;
  const Told with = told(p, r, bounded.shape);
  RecordProperty("norm", std::to_string(with.norm / r.bounds[0].at_most));
  RecordProperty("compliance", std::to_string(with.compliance / without.compliance));
  EXPECT_LT(with.norm, 1.01 * r.bounds[0].at_most) << bounded.why;
  EXPECT_LT(with.compliance, 1.05 * without.compliance) << bounded.why;
  EXPECT_LT(area(bounded.shape), carved.area * (1 + 1e-4));
}

}  // namespace

}  // namespace kerf::stress_bound_test
