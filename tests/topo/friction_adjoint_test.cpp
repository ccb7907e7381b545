// Derivatives with friction: of the discrete problem by its loads, and topological derivatives against finite changes.

#include "solver/tangent_cone.hpp"
#include "tests/topo/validation.hpp"
#include "topo/functional/integrate.hpp"

#include "kerf/analysis.hpp"
#include "kerf/map.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::friction_adjoint_test {
namespace {

using namespace scenes;

const Vec2 at(0.15, 0.45);

struct Law {
  double friction = 0, slip_bound = 0;
};

/// A crack at an angle in a square that stands on its bottom, under a traction on top.
Body pressed(double degrees, const Law& law, VectorField top, double poisson = 0.3) {
  Body b{rectangle({-1, -1}, {1, 1}), pulled(plane_strain(1, poisson), std::move(top)), {.size = 0.12}, bdms(1)};
  const Vec2 half = 0.4 * Vec2(std::cos(degrees * pi / 180), std::sin(degrees * pi / 180));
  b.shape.cracks = {{"crack", {-half, half}}};
  b.scene.laws[0].friction = law.friction;
  b.scene.laws[0].slip_bound = law.slip_bound;
  b.sizing.mirrored_tips = law.friction > 0;
  return b;
}
Vec2 down(const Vec2&) {
  return {0.05, -1};
}
Vec2 sheared(const Vec2& x) {
  return {0.2 + 0.3 * x.x(), -1};
}
Vec2 lifted(const Vec2& x) {
  return {0.1, -0.1 + 1.5 * x.x()};
}

struct Solved {
  Model model;
  State state;
};
Solved solved(const Body& b) {
  Model m = prepare(triangulate(b.shape, b.sizing), b.element, b.scene, 2);
  State s = solve(m);
  EXPECT_TRUE(certified(s));
  return {std::move(m), std::move(s)};
}

struct Counts {
  int stick = 0, slip = 0, open = 0;
};
Counts counts(const Solved& b) {
  const TangentCone cone = tangent_cone(b.model, b.state);
  Counts c;
  for (const ContactPoint& p : contact_points(b.model)) {
    c.open += !cone.held[p.normal];
    c.stick += cone.held[p.tangential];
    c.slip += !cone.held[p.tangential] && cone.held[p.normal];
  }
  return c;
}

Term pressure() {
  return crack_pressure(0, [](const Vec2&) { return 0.3; }, {});
}

// By a load that changes proportions, in the middle of the differences: what moves is a state, not a set.
class ByLoads : public testing::TestWithParam<Body> {};

TEST_P(ByLoads, AreThoseOfDifferences) {
  const Body& b = GetParam();
  const Solved middle = solved(b);
  constexpr double step = 1e-5;
  const auto moved = [&](double by) {
    Body other = b;
    other.scene.tractions.push_back({1, [by](const Vec2& x, const Vec2&) { return Vec2(by * (1 + x.y()), -2 * by); }});
    return solved(other);
  };
  const Solved before = moved(-step), after = moved(step);
  const Eigen::VectorXd dF = (after.model.inner->system.tractions - before.model.inner->system.tractions) / (2 * step);
  const std::vector<Term> terms = {energy(), compliance(), displacement_tracking({}, {}), pressure(),
                                   crack_opening(0, {})};
  const bool opens = counts(middle).open > 0;
  for (const Term& term : terms) {
    if (term.crack == 0 && term.linear && !opens) continue;  // the opening of closed faces
    const Functional j{term.kind, {term}};
    SCOPED_TRACE(term.kind);
    const auto value = [&](const Solved& s) { return analyze(j, s.model, s.state, true).value; };
    const Analysis a = analyze(j, middle.model, middle.state);
    ASSERT_TRUE(a.adjoint);
    double derivative = a.adjoint->skeleton.dot(dF);
    if (term.energy) derivative -= middle.state.skeleton.dot(dF);
    if (term.work) derivative += middle.state.skeleton.dot(dF);
    EXPECT_NEAR(derivative, (value(after) - value(before)) / (2 * step), 2e-7 * (1 + std::abs(derivative)));
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, ByLoads,
                         testing::Values(pressed(30, {0.3}, down), pressed(0, {0.3}, sheared), pressed(60, {0.8}, down),
                                         pressed(30, {0.1, 0.05}, down), pressed(0, {0, 0.15}, sheared),
                                         pressed(10, {0.3}, lifted), pressed(30, {0.3}, down, 0.4999)));

struct Case {
  const char* name;
  Body body;
  Term term;
  Perturbation p = {};
};
class FiniteChanges : public testing::TestWithParam<Case> {};

TEST_P(FiniteChanges, Hold) {
  const Case& c = GetParam();
  const Validation v = validated(c.body, {"", {c.term}}, at, c.p, {0.08, 0.04, 0.02, 0.01});
  SCOPED_TRACE(text(v));
  EXPECT_EQ(v.verdict, Verdict::Holds);
  EXPECT_NEAR(v.intercept / v.coefficient, 1, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Bodies, FiniteChanges,
                         testing::Values(Case{"slip", pressed(30, {0.3}, down), energy()},
                                         Case{"stick_and_slip", pressed(0, {0.3}, sheared), energy()},
                                         Case{"slip_bound", pressed(30, {0, 0.15}, down), energy()},
                                         Case{"inclusion",
                                              pressed(30, {0.3}, down),
                                              compliance(),
                                              {Perturbation::Kind::Inclusion, plane_strain(3, 0.2)}}),
                         [](const auto& info) { return std::string(info.param.name); });

// Adjoints that are nearly right: the transposed problem's own matrix untransposed, pressures that do not matter, faces
// that all slide, no adjoint at all.
TEST(FrictionMutants, AreFarFromFiniteChanges) {
  const Body b = pressed(30, {0.8}, [](const Vec2&) { return Vec2(-0.45, -1); });
  const Validation v = validated(b, {"", {energy()}}, at, {}, {0.04, 0.02, 0.01, 0.005});
  SCOPED_TRACE(text(v));
  const Solved s = solved(b);
  const Functional j{"", {energy()}};
  const Analysis right = analyze(j, s.model, s.state);
  const auto T = [&](const Analysis& a) { return map_at(a, j, {}, std::span(&at, 1))[0].value; };
  EXPECT_NEAR(T(right) / v.intercept, 1, 5e-3);
  const TangentCone cone = tangent_cone(s.model, s.state);
  ASSERT_GT(cone.sliding.size(), 20U);
  const auto far = [&](Analysis a) {
    a.fields = nullptr;
    return std::abs(T(a) / v.intercept - 1) > 2e-2;
  };
  Analysis wrong = right;
  wrong.adjoint = solve_adjoint(s.model, right.derivative, TangentCone(cone.held));
  EXPECT_TRUE(far(wrong)) << T(wrong);
  const Skeleton& skeleton = s.model.inner->skeleton;
  Eigen::VectorXd of_slips = right.derivative.skeleton;  // what the adjoint sees: forces on held rows move nothing
  for (Index u = 0; u < skeleton.total; ++u)
    if (skeleton.bounded[u]) of_slips[u] = 0;
  wrong.adjoint =
      ConeSolver(s.model, cone).solve(of_slips, std::vector<double>(static_cast<std::size_t>(skeleton.total), 0));
  EXPECT_TRUE(far(wrong)) << T(wrong);
  wrong.adjoint.reset();
  EXPECT_TRUE(far(wrong)) << T(wrong);
}

// Under the load at which the whole crack is about to slide, nothing can be said.
TEST(FrictionUndecided, IsRefusedWithItsPlace) {
  Body b = pressed(0, {0.3}, [](const Vec2&) { return Vec2(0, -1); });
  b.scene.tractions.clear();
  b.scene.supports.clear();
  const Mat2 stress = (Mat2() << 0, 0.3, 0.3, -1).finished();
  for (Index side = 0; side < 4; ++side)
    b.scene.tractions.push_back({side, [stress](const Vec2&, const Vec2& n) { return Vec2(stress * n); }});
  const Solved s = solved(b);
  try {
    analyze({"", {energy()}}, s.model, s.state);
    FAIL() << counts(s).stick << " stick, " << counts(s).slip << " slide";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_NE(std::string(e.what()).find("friction used up"), std::string::npos) << e.what();
  }
  EXPECT_NO_THROW(analyze({"", {energy()}}, s.model, s.state, true));
}

TEST(FrictionStates, AreWhatTheirNamesSay) {
  const Counts slip = counts(solved(pressed(30, {0.3}, down))), both = counts(solved(pressed(0, {0.3}, sheared))),
               parts = counts(solved(pressed(10, {0.3}, lifted)));
  EXPECT_EQ(slip.open + slip.stick, 0);
  EXPECT_GT(both.stick, 10);
  EXPECT_GT(both.slip, 10);
  EXPECT_GT(parts.open, 10);
  EXPECT_GT(parts.slip, 10);
}

}  // namespace
}  // namespace kerf::friction_adjoint_test
