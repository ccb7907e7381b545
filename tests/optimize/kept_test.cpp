// Whole optimizations by a level set keep what was asked for, on the design that they draw: random frozen discs that
// bear nothing, random mirrors under loads on one side.

#include "optimize/constraints.hpp"
#include "tests/support/dice.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::kept_test {
namespace {

/// [0, 2] x [0, 1], clamped on the left, pulled at a place of the right side.
Problem cantilever(double low, const Vec2& pull) {
  Problem p;
  p.frame.labels = {"free", "load", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, low}, {2, low + 0.2}, {2, 1}, {0, 1}}, 0);
  p.frame.outline.sides[2].label = 1;
  p.frame.outline.sides[5].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{.label = 1, .value = [pull](const Vec2&, const Vec2&) { return pull; }}};
  p.plane_strain = false;
  p.sizing.size = 0.08;
  p.objective = {"compliance", {compliance()}};
  return p;
}

OptimizeResult optimized(const Problem& p, const OptimizeRequest& r) {
  return optimize_level_set(p, r, {}, {});
}

using test::Dice;

TEST(LevelSetKeeps, FrozenDiscs) {
  Dice dice(1);
  for (int k = 0; k < 5; ++k) {
    const Problem p = cantilever(dice.between(0.1, 0.7), {dice.between(-1, 1), -10});
    OptimizeRequest r;
    r.volume_at_most = 0.5;
    r.max_iterations = 30;
    for (int i = 0; i < 3; ++i)
      r.level_set.frozen.push_back(
          circle("disc", {dice.between(0.2, 1.8), dice.between(0.1, 0.9)}, dice.between(0.05, 0.15), none));
    const OptimizeResult result = optimized(p, r);
    ASSERT_EQ(result.constraints.size(), 4u);
    for (const KeptConstraint& c : result.constraints)
      EXPECT_TRUE(c.kept || result.ending == Ending::Infeasible) << k << ": " << c.note;
    int kept = 0;
    for (const KeptConstraint& c : result.constraints) kept += c.kept;
    EXPECT_EQ(kept, 4) << k << ": " << result.stopped;
  }
}

TEST(LevelSetKeeps, MirrorsUnderLoadsOnOneSide) {
  Dice dice(2);
  for (int k = 0; k < 5; ++k) {
    Problem p = cantilever(dice.between(0.1, 0.7), {dice.between(-5, 5), -10});
    OptimizeRequest r;
    r.volume_at_most = dice.between(0.35, 0.6);
    r.max_iterations = 30;
    r.level_set.mirror = Mirror{{0, 0.5}, {1, 0}};
    const OptimizeResult result = optimized(p, r);
    ASSERT_EQ(result.constraints.size(), 2u);
    for (const KeptConstraint& c : result.constraints) EXPECT_TRUE(c.kept) << k << ": " << c.note;
    EXPECT_LE(asymmetry(result.shape, *r.level_set.mirror).distance, 2e-12);
    EXPECT_FALSE(find_problem(result.shape));
    EXPECT_NE(result.ending, Ending::Infeasible) << result.stopped;
  }
}

}  // namespace
}  // namespace kerf::kept_test
