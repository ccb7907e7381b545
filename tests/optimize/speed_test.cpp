// Speeds of the boundary of a tie under uniform tension, where every side gains the same.

#include "optimize/level_set/speed.hpp"

#include "kerf/mesher.hpp"
#include "optimize/level_set/background.hpp"
#include "optimize/loop/evaluate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::speed_test {
namespace {

/// A strip under uniform tension: -density = s^2/E = 4.5 on both sides, of half thickness 0.1.
Problem tie() {
  Problem p;
  p.frame.labels = {"side", "left", "right"};
  p.frame.outline = polygon("outline", {{0, 0.4}, {2, 0.4}, {2, 0.6}, {0, 0.6}}, 0);
  p.frame.outline.sides[1].label = 2;
  p.frame.outline.sides[3].label = 1;
  p.scene.material = plane_stress(2, 0);
  p.scene.supports = {{.label = 1, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {3, 0}; }}};
  p.sizing.size = 0.1;
  p.objective = {"compliance", {compliance()}};
  return p;
}
/// A canvas around it, and the distance to its boundary.
std::pair<BackgroundMesh, Eigen::VectorXd> canvas(const Problem& p) {
  Shape frame = p.frame;
  frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  frame.outline.sides[1].label = 2;
  frame.outline.sides[3].label = 1;
  BackgroundMesh background = background_mesh(triangulate(frame, {.size = 0.04}), {.held = {1, 2}}, {});
  Eigen::VectorXd phi(background.lumped.size());
  for (Eigen::Index v = 0; v < phi.size(); ++v)
    phi[v] = std::abs(background.mesh.points[static_cast<std::size_t>(v)].y() - 0.5) - 0.1;
  Eigen::VectorXd d = signed_distance(background, phi);
  return {std::move(background), std::move(d)};
}

TEST(Speed, IsZeroInATieThatIsStressedToThePrice) {
  const Problem p = tie();
  const Evaluated e = evaluate_design(p, {}, p.frame, {});
  const BoundaryRate rate = boundary_rate(e, analyze_objective(e));
  EXPECT_NEAR(rate.length.sum(), 4, 1e-12);
  EXPECT_LT((rate.density.array() + 4.5).abs().maxCoeff(), 1e-8);  // 3^2 / 2
  const auto [background, d] = canvas(p);
  const MovingDesign body{background, d, rate, {}};
  const StepLimits limits{.radius = 1, .smoothing = 0.05};
  const auto at = [&](double price, double growth) {
    StepLimits l = limits;
    l.price = price;
    l.growth = growth;
    return constrained_step(body, l, nullptr);
  };
  const BoundaryStep still = at(4.5, infinity);
  EXPECT_LT(still.on_background.cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NEAR(still.residual, 0, 1e-3);
  // At a quarter of the price it grows, and J falls by less than the derivative says: 4.5 v / (1 + v / 0.1) per length.
  const BoundaryStep faster = at(4.5 / 4, infinity);
  EXPECT_GT(faster.area, 4 * 0.04);
  EXPECT_LT(faster.objective, -0.5 * 4.5 * faster.area);
  EXPECT_GT(faster.objective, -0.8 * 4.5 * faster.area);
  // Where the area may not grow its price is that of the material in place; it costs nothing where there is room.
  EXPECT_NEAR(at(0, 0).price, 4.5, 0.01);
  EXPECT_NEAR(at(0, 100).price, 0, 1e-12);
}

TEST(Speed, MultipliersOfBoundsArePricesOfArea) {
  // J is the area, and the compliance of a tie may not grow: its multiplier is area per compliance.
  Problem p = tie();
  const Evaluated e = evaluate_design(p, {}, p.frame, {});
  const BoundaryRate compliance = boundary_rate(e, analyze_objective(e));
  BoundaryRate nothing = compliance;
  nothing.density.setZero();
  const auto [background, d] = canvas(p);
  const BoundaryStep step = constrained_step({background, d, nothing, std::span(&compliance, 1)},
                                             {.radius = 1, .smoothing = 0.05, .price = 1, .room = {0}}, nullptr);
  EXPECT_NEAR(step.multiplier[0], 1 / 4.5, 0.01);
  EXPECT_NEAR(step.bounded[0], 0, 1e-3);
}

/// A tie of half thickness 0.1 that gains 4.5 per area; how far its sides move, on average.
struct Moving {
  Problem p = tie();
  Evaluated e = evaluate_design(p, {}, p.frame, {});
  BoundaryRate rate = boundary_rate(e, analyze_objective(e));
  BackgroundMesh background;
  Eigen::VectorXd distance;
  Moving() {
    std::tie(background, distance) = canvas(p);
  }
  BoundaryStep step(const StepLimits& limits, std::span<const BoundaryRate> bounded = {}, Index free_label = 0) const {
    return constrained_step({background, distance, rate, bounded, free_label}, limits, nullptr);
  }
  double way(const StepLimits& limits, Index free_label = 0) const {
    return step(limits, {}, free_label).area / rate.length.sum();
  }
};

TEST(Speed, ThinMembersGrowToTheLeastWidthOrGo) {
  const Moving m;
  // At 0.15 the same force would gain 2 per area: worth it at 4.5, where it would rest otherwise, not at 20.
  StepLimits limits{.radius = 0.2, .smoothing = 0.05, .min_feature = 0.3, .price = 4.5};
  EXPECT_NEAR(m.way(limits), 0.05, 2e-3);  // the canvas tells thicknesses to a twentieth of its edges
  limits.price = 20;
  EXPECT_NEAR(m.way(limits), -0.2, 1e-6);
  limits.min_feature = 0.15;
  limits.price = 4.5;
  EXPECT_NEAR(m.way(limits), 0, 1e-6);
}

TEST(Speed, RimsDoNotGrowAndSolidPartsDoNotShrink) {
  Moving m;
  StepLimits limits{.radius = 0.05, .smoothing = 0.05, .price = 1};
  EXPECT_GT(m.way(limits), 0.02);
  EXPECT_EQ(m.way(limits, 100), 0);                         // all of it lies on the frame
  EXPECT_NEAR(m.step(limits, {}, 100).residual, 0, 1e-12);  // and rests there
  limits.price = 20;
  EXPECT_LT(m.way(limits, 100), -0.02);  // it may shrink
  EXPECT_LT(m.way(limits), -0.02);
  m.background = background_mesh(Mesh(m.background.mesh), {.loops = {{m.p.frame.outline, 0.05}}, .held = {1, 2}}, {});
  EXPECT_EQ(m.way(limits), 0);
  EXPECT_NEAR(m.step(limits).residual, 0, 1e-12);
}

TEST(Speed, WhereMaterialHarmsItGoes) {
  Moving m;
  m.rate.density.setConstant(2);
  const BoundaryStep s = m.step({.radius = 0.05, .smoothing = 0.05});
  EXPECT_LT(s.area, 0);
  EXPECT_NEAR(s.objective, 2 * s.area, 1e-9);  // linear: nothing is stretched
  EXPECT_EQ(s.price, 0);
}

TEST(Speed, NothingGainedIsNothingMoved) {
  Moving m;
  m.rate.density.setZero();
  const BoundaryStep s = m.step({.radius = 0.05, .smoothing = 0.05, .growth = 0});
  EXPECT_EQ(s.area, 0);
  EXPECT_EQ(s.residual, 0);
  EXPECT_EQ(s.price, 0);
  m.rate = {};  // no boundary that can move
  const BoundaryStep none = m.step({.radius = 0.05, .smoothing = 0.05, .price = 3, .room = {}});
  EXPECT_EQ(none.price, 3);
  EXPECT_TRUE(none.on_background.isZero(0));
}

TEST(Speed, SeveralBoundsSettle) {
  Moving m;
  std::vector<BoundaryRate> bounded(3, m.rate);
  bounded[1].density *= 0.5;  // says the same, with more room
  bounded[2].density.setZero();
  m.rate.density.setZero();
  const StepLimits limits{.radius = 1, .smoothing = 0.05, .price = 1, .room = {0, 0.1, 0}};
  const BoundaryStep s = m.step(limits, bounded);
  EXPECT_NEAR(s.multiplier[0], 1 / 4.5, 0.01);
  EXPECT_NEAR(s.multiplier[1], 0, 1e-3);
  EXPECT_EQ(s.multiplier[2], 0);
  // A fall that no step can bring costs all that may be paid, which is finite.
  StepLimits hopeless = limits;
  hopeless.room = {-1e6, 0, 0};
  const BoundaryStep h = m.step(hopeless, bounded);
  EXPECT_GT(h.multiplier[0], 1);
  EXPECT_TRUE(std::isfinite(h.multiplier[0]));
  // Without a price of anything multipliers are told in units of their own.
  StepLimits free = limits;
  free.price = 0;
  EXPECT_NEAR(m.step(free, bounded).multiplier[0], 0, 1e-3);
}

}  // namespace
}  // namespace kerf::speed_test
