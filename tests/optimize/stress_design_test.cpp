// The density stage under a bound on the largest stress, on an L-bracket with a round inner corner.

#include "optimize/density/stress_design.hpp"

#include "kerf/max_stress.hpp"
#include "optimize/curves/stress_rows.hpp"
#include "optimize/stress_zones.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::stress_design_test {
namespace {

constexpr Index top = 0, load = 1, edge = 2;

Problem bracket() {
  Problem p;
  p.frame.labels = {"top", "load", "edge"};
  const Arc fillet{{0.5, 0.5}, 0.1 * Mat2::Identity(), -pi / 2, -pi};
  p.frame.outline.sides = {{{0, 0}, edge, {}},     {{1, 0}, edge, {}},   {{1, 0.16}, load, {}},
                           {{1, 0.24}, edge, {}},  {{1, 0.4}, edge, {}}, {{0.5, 0.4}, edge, fillet},
                           {{0.4, 0.5}, edge, {}}, {{0.4, 1}, top, {}},  {{0, 1}, edge, {}}};
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{top, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{load, [](const Vec2&, const Vec2&) { return Vec2(0, -10); }}};
  p.sizing.size = 0.02;
  p.objective = {"volume", {volume()}};
  p.plane_strain = false;
  return p;
}

OptimizeRequest bounded(const Problem& p, double at_most) {
  OptimizeRequest r;
  const std::vector<Index> loaded{load};
  r.bounds.push_back({"max_stress",
                      with_zones({"max_stress", {max_stress({})}},
                                 {.shape = p.frame, .supports = p.scene.supports, .loaded = loaded, .frozen = {}}),
                      at_most});
  return r;
}

// The least area of a design that keeps it is at most 0.13, that of the stiffest design 0.2565.
TEST(StressDesign, KeepsTheBoundWithLittleArea) {
  const Problem p = bracket();
  const OptimizeRequest r = bounded(p, 57.3);
  EXPECT_TRUE(bounds_largest_stress(r));
  EXPECT_FALSE(no_density_stage(p, r));
  const DensityDesign d = stress_design(p, r);
  const double area_of_design = d.volume_fraction * area(p.frame);
  EXPECT_GT(area_of_design, 0.1);
  EXPECT_LT(area_of_design, 0.2);
  // It hangs at the top and bears the load.
  EXPECT_GT(density_at(d, {0.99, 0.2}), 0.5);
  EXPECT_LT(density_at(d, {0.2, 0.8}), 0.5);
}

TEST(StressDesign, IsAskedForByLargestStressesAlone) {
  OptimizeRequest r;
  EXPECT_FALSE(bounds_largest_stress(r));
  r.bounds.push_back({"norm", {"stress_pnorm", {stress_pnorm(8, {}, false)}}, 1});
  EXPECT_FALSE(bounds_largest_stress(r));
}

TEST(StressBoxes, CoverTheFrame) {
  const Shape frame = bracket().frame;
  const StressBoxes boxes(frame);
  for (const Vec2& x : {Vec2(0, 0), Vec2(1, 0.4), Vec2(0.4, 1), Vec2(0.33, 0.21), Vec2(1 + 1e-9, -1e-9)}) {
    const auto [low, high] = boxes.box(boxes.of(x));
    EXPECT_TRUE((x.array() >= low.array()).all() && (x.array() < high.array()).all()) << x.transpose();
  }
  const auto [low, high] = boxes.box(boxes.of({0.33, 0.21}));
  EXPECT_NEAR(high.x() - low.x(), 0.035 * std::sqrt(2), 1e-12);
}

TEST(StressBoxes, FactorsStayBetweenLimits) {
  EXPECT_EQ(stress_factor(1.1, 1), 1.1);
  EXPECT_EQ(stress_factor(9, 1), 1.4);
  EXPECT_EQ(stress_factor(0.1, 1), 0.8);
}

}  // namespace
}  // namespace kerf::stress_design_test
