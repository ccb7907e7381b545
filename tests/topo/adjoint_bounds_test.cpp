// Intervals of T against exact stresses of the state and of the adjoint.

#include "kerf/derivative_bounds.hpp"

#include "tests/solver/exact_crack.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::adjoint_bounds_test {
namespace {

using Kind = Perturbation::Kind;

constexpr double slope = pi / 6;

double width(const Bounded& b) {
  return b.upper - b.lower;
}

void expect_holds(const Bounded& b, double exact, const std::string& which) {
  EXPECT_LE(b.lower, exact) << which;
  EXPECT_GE(b.upper, exact) << which;
  EXPECT_TRUE(b.guaranteed) << which << ": " << b.note;
  EXPECT_NEAR(b.value, 0.5 * (b.lower + b.upper), 1e-12 * std::abs(exact)) << which;
}

const Perturbation stiff{.kind = Kind::Inclusion, .inclusion = {2000, 1e-4}},
    soft{.kind = Kind::Inclusion, .inclusion = {100, 1e-3}};

/// The work of the tractions of an exact field on the displacement of a label, times a factor.
Term work_of(const exact::ExactField& g, Index label, double factor = 1) {
  Term t{.kind = "work", .factor = factor, .linear = true, .label = label};
  t.on_boundary = [g](const Vec2& x, const Vec2& n, const Vec2& u) {
    const Vec2 traction = g.stress(x, exact::side_of(g, x)) * n;
    return Density{.value = traction.dot(u), .by_displacement = traction};
  };
  return t;
}

/// The crack of `crack_problem` under another stress.
exact::ExactField other_field(const Material& m) {
  return exact::line_crack("other", m, exact::under((Mat2() << 1, 0.3, 0.3, 0.8).finished(), slope));
}

Mat2 stress(const exact::ExactField& f, const Vec2& x) {
  return f.stress(x, exact::side_of(f, x));
}

// The adjoint of the work of the tractions of a second field is that field.
TEST(AdjointBounds, ContainTOfAWorkBesideACrack) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3), g = other_field(f.material);
  Functional j{"work", {}};
  for (const Index label : {0, 1, 2, 3}) j.terms.push_back(work_of(g, label, -3));
  Functional with_energy = j;
  with_energy.kind = "sum";
  with_energy.terms.push_back(energy());
  std::vector<double> widths;
  for (const auto& [degree, n] : {std::pair(1, 8), std::pair(1, 16), std::pair(2, 8), std::pair(2, 16)}) {
    const CrackProblem p = crack_problem(f, n, degree, {});
    const QuantityBounds bounds(p.model, p.state);
    const auto check = [&](const Functional& of, const Perturbation& change, const Vec2& x, double share) {
      const Mat2 s = stress(f, x), z = -3 * stress(g, x) - 0.5 * share * s;
      StressBounds at = bounds.stress(x);
      const Bounded b = DerivativeBounds(of, change, p.model).at(x, at);
      expect_holds(
          b, form(change, f.material, 0, s, z),
          fmt::format("degree {} n {} {} of {} at {} {}", degree, n, word(change.kind), of.kind, x.x(), x.y()));
      widths.push_back(width(b));
    };
    check(j, {}, {0.3, 0.9}, 0);
    check(j, {}, {0.1, -0.4}, 0);
    check(j, stiff, {-1.2, -0.3}, 0);
    check(j, soft, {0.1, -0.4}, 0);
    check(with_energy, {}, {0.3, 0.9}, 1);
  }
  // The order of the gap of the energy with tips that are not resolved.
  constexpr std::size_t each = 5;
  for (const std::size_t from : {std::size_t(0), 2 * each})
    for (std::size_t i = from; i < from + each; ++i) EXPECT_LT(widths[each + i], 0.6 * widths[i]) << i;
}

// A pressure on the faces opens them: the field of the crack without the stress at infinity.
TEST(AdjointBounds, ContainTOfAnOpening) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3),
                          pulled = exact::line_crack("pulled", f.material, {.angle = slope, .p0 = 1});
  const Vec2 across(-std::sin(slope), std::cos(slope));
  exact::ExactField pressed = pulled;
  pressed.stress = [pulled, across](const Vec2& x, int side) -> Mat2 {
    return pulled.stress(x, side) - across * across.transpose();
  };
  Functional j{"sum", {crack_opening(0, {})}};
  for (const Index label : {0, 1, 2, 3}) j.terms.push_back(work_of(pressed, label));
  std::vector<double> widths;
  for (const int n : {8, 16}) {
    const CrackProblem p = crack_problem(f, n, 2, {});
    const QuantityBounds bounds(p.model, p.state);
    const DerivativeBounds T(j, {}, p.model);
    for (const Vec2& x : {Vec2(0.3, 0.9), Vec2(0.1, -0.4)}) {
      StressBounds at = bounds.stress(x);
      const Bounded b = T.at(x, at);
      expect_holds(b, hole_form(f.material, stress(f, x), stress(pressed, x)),
                   fmt::format("n {} at {} {}", n, x.x(), x.y()));
      widths.push_back(width(b));
    }
  }
  for (int i = 0; i < 2; ++i) EXPECT_LT(widths[2 + i], 0.6 * widths[i]) << i;
}

// A displacement weighed with the body force of a field that vanishes on the boundary; the state has prescribed
// displacements, tractions and a body force.
TEST(AdjointBounds, ContainTOfAMeanInTheBody) {
  const exact::ExactField f = exact::exp_field(0.3), g = exact::trig_field(0.3);
  Term mean{.kind = "mean",
            .linear = true,
            .density =
                [g](const FieldPoint& p) {
                  const Vec2 w = g.body(p.x);
                  return Density{.value = w.dot(p.displacement), .by_displacement = w};
                },
            .uses_displacement = true};
  Functional j{"sum", {mean}};
  for (const Index label : {1, 2, 3}) j.terms.push_back(work_of(g, label));
  const Vec2 x(0.45, 0.55);
  const double exact = form(stiff, f.material, 0, stress(f, x), stress(g, x));
  std::vector<double> widths;
  for (const int n : {8, 16}) {
    Scene s{.material = f.material, .body = [f](const Vec2& x) -> Vec2 { return f.body(x); }};
    s.supports.push_back({0, false, true, true, [f](const Vec2& x, const Vec2&) { return f.displacement(x, 0); }});
    for (const Index label : {1, 2, 3})
      s.tractions.push_back({label, [f](const Vec2& x, const Vec2& n) -> Vec2 { return f.stress(x, 0) * n; }});
    const Model m = prepare(exact::unit_square_mesh(n, 0.2), element("bdms", 2), s, 1);
    const State state = solve(m);
    StressBounds at = QuantityBounds(m, state).stress(x);
    const Bounded b = DerivativeBounds(j, stiff, m).at(x, at);
    expect_holds(b, exact, fmt::format("n {}", n));
    widths.push_back(width(b));
    EXPECT_EQ(DerivativeBounds(j, {}, m).at(x, at).note,
              "no bounds: a body force goes with the hole, and the displacement is not bounded");
  }
  EXPECT_LT(widths[1], 0.25 * widths[0]);
}

Model pulled_bar() {
  Scene s{.material = plane_strain(1, 0.3)};
  const auto rest = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  s.supports = {{0, true, true, false, rest}, {3, true, true, false, rest}};
  s.tractions = {{2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  return prepare(exact::unit_square_mesh(6, 0.2), element("bdms", 1), s, 1);
}

// Twice the displacement of a uniform state was measured: T = (H(s, s) - H(2 s, 2 s))/2.
TEST(AdjointBounds, ContainTOfAMisfitAndAVolume) {
  const Model m = pulled_bar();
  const State state = solve(m);
  const Vec2 x(0.4, 0.6);
  StressBounds at = QuantityBounds(m, state).stress(x);
  const Mat2 s = (Mat2() << 0, 0, 0, 1).finished();
  const Material& material = m.scene.material;
  const Term gap = misfit(2, [material, s](const Vec2& x, const Vec2&) -> Vec2 { return 2 * strain(material, s) * x; });
  const Bounded b = DerivativeBounds({"misfit", {gap}}, {}, m).at(x, at);
  expect_holds(b, -1.5 * hole_form(material, s, s), "misfit");
  EXPECT_LT(width(b), 1e-5 * std::abs(b.value));  // the root of rounding: both states are polynomials
  Term half = volume();
  half.factor = 0.5;
  const Bounded v = DerivativeBounds({"volume", {half}}, {}, m).at(x, at);
  expect_holds(v, -0.5, "volume");
  EXPECT_LT(width(v), 1e-12);
}

// Supports that move the body as it is: the stress stays, and the compliance has an adjoint, the state without that
// motion. T = H(s, s) as of the compliance of one at rest.
TEST(AdjointBounds, ContainTOfTheWorkInABodyThatIsMoved) {
  Scene moved{.material = plane_strain(1, 0.3)};
  const auto away = [](const Vec2&, const Vec2&) -> Vec2 { return {0.2, 0}; };
  moved.supports = {{0, true, true, false, away}, {3, true, true, false, away}};
  const auto pull = [](const Vec2&, const Vec2& n) -> Vec2 { return {0, n.y()}; };
  moved.tractions = {{2, pull}};
  const Model m = prepare(exact::unit_square_mesh(6, 0.2), element("bdms", 1), moved, 1);
  const State state = solve(m);
  const Vec2 x(0.4, 0.6);
  StressBounds at = QuantityBounds(m, state).stress(x);
  const Mat2 s = (Mat2() << 0, 0, 0, 1).finished();
  const double exact = hole_form(moved.material, s, s);
  Term half = compliance(), more = half, none = half;
  half.factor = 0.5;
  more.factor = 1.5;
  none.factor = 0;
  for (const auto& [terms, times] :
       {std::pair{std::vector{compliance()}, 1.0}, {{half, more}, 2.0}, {{none, half}, 0.5}}) {
    const Bounded b = DerivativeBounds({"work", terms}, {}, m).at(x, at);
    expect_holds(b, times * exact, fmt::format("{} times", times));
    EXPECT_LT(width(b), 1e-5 * exact);
  }
  EXPECT_EQ(DerivativeBounds({"work", {none}}, {}, m).at(x, at).upper, 0);
}

// T of the energy and of the compliance follows from the stress alone.
TEST(AdjointBounds, OfEnergiesAreSquares) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const CrackProblem p = crack_problem(f, 8, 1, {});
  const QuantityBounds bounds(p.model, p.state);
  const Vec2 x(0.3, 0.9);
  StressBounds at = bounds.stress(x);
  const Bounded b = DerivativeBounds({"energy", {energy()}}, {}, p.model).at(x, at);
  const Interval t = squared(at.trace), d = squared(at.difference), s = squared(at.s12);
  const double share = 0.5 / plane_modulus(f.material);
  EXPECT_NEAR(b.lower, -share * (t.high + 8 * (d.high + s.high)), 1e-14);
  EXPECT_NEAR(b.upper, -share * (t.low + 8 * (d.low + s.low)), 1e-14);
  const Bounded c = DerivativeBounds({"compliance", {compliance()}}, {}, p.model).at(x, at);
  EXPECT_NEAR(c.lower, -2 * b.upper, 1e-14);
  EXPECT_NEAR(c.upper, -2 * b.lower, 1e-14);
}

TEST(AdjointBounds, SayWhyThereAreNone) {
  const Model m = pulled_bar();
  const State state = solve(m);
  const Vec2 x(0.4, 0.6);
  StressBounds at = QuantityBounds(m, state).stress(x);
  const auto note = [&](const Term& term, const Perturbation& p = {}) {
    const Bounded b = DerivativeBounds({"", {term}}, p, m).at(x, at);
    EXPECT_TRUE(std::isnan(b.lower) && std::isnan(b.upper) && !b.guaranteed);
    return b.note;
  };
  EXPECT_EQ(note(displacement_tracking({}, {})),
            "no bounds: the topological derivative is bounded for energies, the compliance, misfits and what is linear "
            "in the displacement, which \"displacement_tracking\" is not");
  // Linear, but not in the displacement; and with a change of its own.
  Term turn = scenes::turning(), strained = compliance();
  turn.linear = true;
  EXPECT_NE(note(turn).find("which \"turning\" is not"), std::string::npos);
  strained.work = false;
  strained.uses_stress = true;
  EXPECT_NE(note(strained).find("which \"compliance\" is not"), std::string::npos);
  strained.uses_stress = false;
  strained.local = [](const Perturbation&, const FieldPoint&) { return 0.0; };
  EXPECT_NE(note(strained).find("which \"compliance\" is not"), std::string::npos);
  EXPECT_EQ(note(stress_pnorm(4, {}, true)), "no bounds: \"stress_pnorm\" is the power of an integral");
  EXPECT_EQ(note(energy(), {.kind = Kind::Crack, .angle = 0.0}),
            "no bounds: the topological derivative is bounded for circular holes and inclusions alone");
  Term mean{.kind = "mean", .linear = true, .uses_displacement = true};
  mean.density = [](const FieldPoint& p) {
    return Density{.value = p.displacement.y(), .by_displacement = Vec2::UnitY()};
  };
  EXPECT_EQ(note(mean), "no bounds: the functional weighs the displacement in the hole, which is not bounded");
  EXPECT_TRUE(std::isfinite(DerivativeBounds({"", {mean}}, stiff, m).at(x, at).upper));
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const CrackProblem closing = crack_problem(f, 8, 1, {0}, CrackLaw::Kind::Unilateral);
  EXPECT_EQ(
      DerivativeBounds({"", {crack_opening(0, {})}}, {}, closing.model).at({0.3, 0.9}, at).note,
      "no bounds: the adjoint is tied where the faces of a crack are closed, which only the exact solution knows");
  EXPECT_TRUE(std::isnan(DerivativeBounds({"", {energy()}}, {}, m).at({2, 2}, at).lower));  // outside
  // Bonded faces open nowhere, whatever the place of a hole.
  const CrackProblem whole = crack_problem(f, 8, 1, {0}, CrackLaw::Kind::Bonded);
  const Bounded shut = DerivativeBounds({"", {crack_opening(0, {})}}, {}, whole.model).at({0.3, 0.9}, at);
  EXPECT_LE(shut.lower, 0);
  EXPECT_NEAR(shut.lower, -shut.upper, 1e-9);
}

}  // namespace
}  // namespace kerf::adjoint_bounds_test
