// Intervals of T from intervals of the stress: around a free hole, in plane stress, the potential energy has
// T = -((s1 + s2)^2 + 2 (s1 - s2)^2)/(2 E), s1 and s2 the principal stresses.

#include "kerf/derivative_bounds.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
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

struct Solved {
  Model model;
  State state;
};
Solved solved(const Body& b) {
  Solved s{prepare(triangulate(b.shape, b.sizing), b.element, b.scene, 1), {}};
  s.state = solve(s.model);
  return s;
}

Body plate() {
  Scene s;
  s.material = plane_stress(young, poisson);
  s.supports = {clamp(0)};
  s.tractions = {{2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  return {rectangle({-1, -1}, {1, 1}), s, {.size = 0.8}, element("bdms", 1)};
}

TEST(DerivativeBounds, HoldTheFormulaOfAHole) {
  const Solved s = solved(plate());
  const Analysis a = analyze({"", {energy()}}, s.model, s.state);
  for (const auto& [s11, s22, s12] : {std::array{1., 2., 0.5}, {-1., 1., 0.}, {0., 0., 3.}, {2., 2., 0.}}) {
    const double T = exact(s11, s22, s12);
    const Bounded sharp = derivative_bounds(a, {}, {0.1, 0.2}, known(s11, s22, s12, 0));
    EXPECT_NEAR(sharp.lower, T, 1e-12);
    EXPECT_NEAR(sharp.upper, T, 1e-12);
    EXPECT_TRUE(sharp.guaranteed);
    // Every stress within a tenth has its T between the bounds, and the extremes are taken.
    const Bounded wide = derivative_bounds(a, {}, {0.1, 0.2}, known(s11, s22, s12, 0.1));
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
  StressBounds estimate = known(1, 2, 0.5, 0.1);
  estimate.difference = within(0.5, 0.1, false, "an estimate");
  const Bounded t = derivative_bounds(a, {}, {0.1, 0.2}, estimate);
  EXPECT_FALSE(t.guaranteed);
  EXPECT_EQ(t.note, "an estimate");
}

TEST(DerivativeBounds, SayWhyThereAreNone) {
  const auto why = [](const Body& b, const Term& term, const Perturbation& p = {}, const Vec2& x = {0.1, 0.2}) {
    const Solved s = solved(b);
    const Analysis a = analyze({"", {term}}, s.model, s.state);
    StressBounds stress = known(1, 2, 0.5, 0.1);
    stress.s11.note = "the place lies outside the body";
    const Bounded t = derivative_bounds(a, p, x, stress);
    EXPECT_EQ(std::isnan(t.lower), std::isnan(t.upper));
    EXPECT_EQ(std::isnan(t.value), !t.guaranteed);
    return t.note;
  };
  EXPECT_EQ(why(plate(), energy()), "");
  EXPECT_EQ(why(plate(), compliance()), "");
  EXPECT_EQ(why(plate(), energy(), {.kind = Perturbation::Kind::Inclusion, .inclusion = plane_stress(9, 0.25)}), "");
  EXPECT_EQ(why(plate(), energy(), {}, {7, 7}), "the place lies outside the body");
  const std::string shapes = "no bounds: the topological derivative is bounded for circular holes and inclusions alone";
  EXPECT_EQ(why(plate(), energy(), {.kind = Perturbation::Kind::Ellipse, .aspect = 2}), shapes);
  EXPECT_EQ(why(plate(), energy(), {.kind = Perturbation::Kind::Crack}), shapes);
  const std::string functionals =
      "no bounds: the topological derivative is bounded for the energy and the compliance alone";
  EXPECT_EQ(why(plate(), stress_power(2, {}, false)), functionals);
  EXPECT_EQ(why(plate(), volume()), functionals);
  Body heavy = plate();
  heavy.scene.body = [](const Vec2&) { return Vec2(0, -1); };
  EXPECT_EQ(why(heavy, energy()), "no bounds: a body force goes with the hole, and the displacement is not bounded");
  EXPECT_EQ(why(heavy, energy(), {.kind = Perturbation::Kind::Inclusion, .inclusion = plane_stress(9, 0.25)}), "");
  Body warm = plate();
  warm.scene.eigenstrain = {
      {.normal = [](const Vec2&) { return Vec2(1e-3, 0); }, .shear = [](const Vec2&) { return Vec2(0, 0); }}};
  EXPECT_EQ(why(warm, energy()), "no bounds: there is an eigenstrain");
}

}  // namespace
}  // namespace kerf
