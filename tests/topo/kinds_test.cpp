// Every functional at every Poisson's ratio, and every kind of change, against finite sizes.

#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::kinds_test {
namespace {

using namespace scenes;
using Kind = Perturbation::Kind;

// Away from the supports and tips, where powers of the stress are not integrable.
double middle(const Vec2& x) {
  const double t = std::clamp(x.y() - 0.1, 0.0, 0.5) * std::clamp(0.9 - x.y(), 0.0, 0.5);
  return 100 * t * t;
}
Vec2 pull(const Vec2& x) {
  return {0.2, -0.1 + 0.1 * x.x()};
}
const BoundaryField measured = [](const Vec2& x, const Vec2&) { return Vec2(0.1, 1.5 * x.x()); };

struct Named {
  const char* name;
  Term term;
};
std::vector<Named> terms(const VectorField& body = {}) {
  return {{"energy", energy()},
          {"compliance", compliance()},
          {"volume", volume()},
          {"displacement_tracking", displacement_tracking({}, {})},
          {"boundary_tracking", boundary_tracking(2, {}, {})},
          {"displacement", boundary_displacement(2, [](const Vec2& x, const Vec2&) { return Vec2(x.x(), 0.5); }, {})},
          {"stress_power_2", stress_power(2, middle, true)},
          {"stress_power_4", stress_power(4, middle, true)},
          {"stress_pnorm", stress_pnorm(4, middle, true)},
          {"misfit", misfit(2, measured)},
          {"energy_release_rate", energy_release_rate({0.4, 0}, {1, 0}, {0.06, 0.2}, body)},
          {"opening_mode", stress_intensity({.along = {1, 0}}, {0.4, 0}, {0.06, 0.2}, body, 0)},
          {"sliding_mode", stress_intensity({TipQuantity::SlidingMode, {1, 0}}, {0.4, 0}, {0.06, 0.2}, body)},
          {"equivalent_intensity", stress_intensity({TipQuantity::Equivalent, {1, 0}}, {0.4, 0}, {0.06, 0.2}, body)},
          {"crack_opening", crack_opening(0, {})},
          {"crack_pressure", crack_pressure(0, {}, {})}};
}

Body partly_closed(const Material& m) {
  return {cracked_square(), pulled(m, closes_half), {.size = 0.2}, element("bdms", 1)};
}
// Below the radii at which the contact set moves.
const std::vector<double> radii = {0.04, 0.02, 0.01, 0.005};

void expect_holds(const Validation& v, const std::string& name) {
  EXPECT_EQ(v.verdict, Verdict::Holds) << name << ' ' << text(v);
  EXPECT_NEAR(v.intercept / v.coefficient, 1, 2e-3) << name << ' ' << text(v);
}

class Incompressible : public testing::TestWithParam<double> {};
TEST_P(Incompressible, EveryFunctionalHolds) {
  for (const Named& n : terms()) {
    Body b = partly_closed(plane_strain(1, GetParam()));
    // Here T of the opening is a 35th of its parts, and the end of contact is free to move.
    if (std::string(n.name) == "crack_opening") b.sizing.size = 0.1;
    expect_holds(validated(b, {"", {n.term}}, {0.15, 0.45}, {}, radii), n.name);
  }
}
INSTANTIATE_TEST_SUITE_P(Poisson, Incompressible, testing::Values(0.3, 0.49, 0.4999999, 0.5),
                         [](const auto& info) { return "case" + std::to_string(info.index); });

TEST(BodyForce, LeavesWithTheHole) {
  for (const Named& n : terms(pull)) {
    if (std::string(n.name) == "crack_pressure") continue;
    Body b = partly_closed(plane_strain(1, 0.3));
    b.scene = pulled(b.scene.material, opens);
    b.scene.body = pull;
    expect_holds(validated(b, {"", {n.term}}, {0.15, 0.45}, {}, radii), n.name);
  }
}

// Partly closed all the same. The ball's own problem has no load of the crack.
TEST(FluidInTheCrack, WorkAndFunctionalsOfTheCrackHold) {
  for (const Named& n : terms()) {
    const std::string name = n.name;
    if (name != "compliance" && name != "crack_opening" && name != "crack_pressure") continue;
    Body b = partly_closed(plane_strain(1, 0.3));
    b.scene.laws[0].pressure = [](const Vec2& x, const Vec2&) { return Vec2(0.1 + 0.1 * x.x(), 0); };
    expect_holds(validated(b, {"", {n.term}}, {0.15, 0.45}, {}, radii), name);
  }
}

struct Change {
  const char* name;
  Perturbation p;
};
class Kinds : public testing::TestWithParam<Change> {};
// A linear functional, the energy, and quadratic ones.
TEST_P(Kinds, Hold) {
  for (const Named& n : terms()) {
    const std::string name = n.name;
    if (name == "volume" || name == "crack_pressure") continue;
    Body b = partly_closed(plane_strain(1, 0.3));
    if (name == "crack_opening") b.sizing.size = 0.1;  // as above
    expect_holds(validated(b, {"", {n.term}}, {0.15, 0.45}, GetParam().p, radii), GetParam().name + (" " + name));
  }
}
INSTANTIATE_TEST_SUITE_P(Changes, Kinds,
                         testing::Values(Change{"soft", {Kind::Inclusion, plane_strain(0.1, 0.2)}},
                                         Change{"stiff_incompressible", {Kind::Inclusion, plane_strain(10, 0.5)}},
                                         Change{"ellipse", {Kind::Ellipse, {}, 3}}),
                         [](const auto& info) { return std::string(info.param.name); });

// A small crack that opens, and one that the load presses together.
TEST(SmallCrack, OpenAndClosed) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports = {clamp(0)};
  for (const double sign : {1., -1.}) {
    s.tractions = {{2, [=](const Vec2& x, const Vec2&) { return Vec2(0.4, sign * (2 + 0.3 * x.x())); }}};
    const Body b{rectangle({-1, -1}, {1, 1}), s};
    for (const Named& n : {Named{"compliance", compliance()}, Named{"tracking", boundary_tracking(2, {}, {})}}) {
      const Validation v = validated(b, {"", {n.term}}, {0.1, 0.2}, {.kind = Kind::Crack});
      SCOPED_TRACE(std::string(n.name) + (sign > 0 ? " open " : " closed ") + text(v));
      EXPECT_EQ(v.verdict, Verdict::Holds);
      EXPECT_NEAR(v.intercept / v.coefficient, 1, 6e-3);
    }
  }
}

TEST(Misfit, WithoutACrackAndUnderABodyForce) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports = {clamp(0)};
  s.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.4, 2 + 0.3 * x.x()); }}};
  for (const bool loaded : {false, true}) {
    Body b{rectangle({-1, -1}, {1, 1}), s, {.size = 0.1}, element("bdms", 1)};
    if (loaded) b.scene.body = pull;
    const Validation v = validated(b, {"", {misfit(2, measured)}}, {0.1, 0.2});
    expect_holds(v, "misfit");
    EXPECT_GT(v.order, 3.7) << text(v);
    EXPECT_LT(v.order, 4.3) << text(v);
  }
}

}  // namespace
}  // namespace kerf::kinds_test
