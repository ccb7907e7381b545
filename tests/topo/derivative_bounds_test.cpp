// Intervals of T from intervals of the stress: around a free hole, in plane stress, the potential energy has
// T = -((s1 + s2)^2 + 2 (s1 - s2)^2)/(2 E), s1 and s2 the principal stresses.

#include "kerf/derivative_bounds.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::derivative_bounds_test {
namespace {

using namespace scenes;

constexpr double young = 3, poisson = 0.25;

Bounded within(double value, double by, bool guaranteed = true, std::string note = "") {
  return {value, value - by, value + by, guaranteed, std::move(note)};
}

/// Of a stress known to `by`.
StressBounds known(double s11, double s22, double s12, double by) {
  StressBounds s;
  s.trace = within(s11 + s22, by);
  s.difference = within(0.5 * (s22 - s11), by);
  s.s12 = within(s12, by);
  return s;
}

double exact(double s11, double s22, double s12) {
  return -(std::pow(s11 + s22, 2) + 2 * (std::pow(s11 - s22, 2) + 4 * s12 * s12)) / (2 * young);
}

Body plate() {
  Scene s;
  s.material = plane_stress(young, poisson);
  s.supports = {clamp(0)};
  s.tractions = {{2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  return {rectangle({-1, -1}, {1, 1}), s, {.size = 0.8}, element("bdms", 1)};
}

TEST(DerivativeBounds, HoldTheFormulaOfAHole) {
  const Body b = plate();
  const Model m = prepare(triangulate(b.shape, b.sizing), b.element, b.scene, 1);
  const DerivativeBounds bounds({"", {energy()}}, {}, m);
  const auto at = [&](StressBounds stress) { return bounds.at({0.1, 0.2}, stress); };
  for (const auto& [s11, s22, s12] : {std::array{1., 2., 0.5}, {-1., 1., 0.}, {0., 0., 3.}, {2., 2., 0.}}) {
    const double T = exact(s11, s22, s12);
    const Bounded sharp = at(known(s11, s22, s12, 0));
    EXPECT_NEAR(sharp.lower, T, 1e-12);
    EXPECT_NEAR(sharp.upper, T, 1e-12);
    EXPECT_TRUE(sharp.guaranteed);
    // Every stress within a tenth has its T between the bounds, and the extremes are taken.
    const Bounded wide = at(known(s11, s22, s12, 0.1));
    EXPECT_NEAR(wide.value, 0.5 * (wide.lower + wide.upper), 1e-12);
    double low = infinity, high = -infinity;
    for (int i = -10; i <= 10; ++i)
      for (int j = -10; j <= 10; ++j)
        for (int k = -10; k <= 10; ++k) {
          const double trace = s11 + s22 + 0.01 * i, difference = s22 - s11 + 0.02 * j;
          const double T_there = exact(0.5 * (trace - difference), 0.5 * (trace + difference), s12 + 0.01 * k);
          low = std::min(low, T_there);
          high = std::max(high, T_there);
        }
    EXPECT_NEAR(wide.lower, low, 1e-12);
    EXPECT_NEAR(wide.upper, high, 1e-12);
  }
  // Indicators of what an adjoint adds: its own, and those of its stress.
  const DerivativeBounds steered(
      {"", {boundary_displacement(2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }, {})}}, {}, m, true);
  StressBounds told = known(1, 2, 0.5, 0.1);
  EXPECT_TRUE(std::isfinite(steered.at({0.1, 0.2}, told).upper));
  ASSERT_GE(told.eta.size(), 2u);
  for (const Eigen::VectorXd& eta : told.eta) {
    EXPECT_EQ(eta.size(), static_cast<Eigen::Index>(m.mesh.triangles.size()));
    EXPECT_GT(eta.norm(), 0);
  }
  StressBounds estimate = known(1, 2, 0.5, 0.1);
  estimate.difference = within(0.5, 0.1, false, "an estimate");
  const Bounded t = at(estimate);
  EXPECT_FALSE(t.guaranteed);
  EXPECT_EQ(t.note, "an estimate");
}

}  // namespace
}  // namespace kerf::derivative_bounds_test
