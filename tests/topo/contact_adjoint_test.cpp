// The adjoint on the tangent cone of the contact, against finite holes: where part of a crack is closed, where a whole
// crack carries neither gap nor pressure, and along its growth.

#include "kerf/recover.hpp"
#include "kerf/shape_gradient.hpp"
#include "tests/topo/validation.hpp"
#include "topo/changes.hpp"
#include "topo/functional/integrate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::contact_adjoint_test {
namespace {

using namespace scenes;

const Vec2 at(0.15, 0.35), tip(0.4, 0);
const std::vector<Vec2> there = {at};
const Material material = plane_strain(1, 0.3);
constexpr std::array<double, 2> ring = {0.06, 0.2};

Body partly_closed(int degree = 1) {
  return {cracked_square(), pulled(material, closes_half), {.size = 0.1}, element("bdms", degree)};
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
double map_there(const Analysis& a, const Functional& j) {
  return map_at(a, j, {}, there)[0].value;
}

struct Named {
  const char* name;
  Term term;
};
class PartlyClosed : public testing::TestWithParam<Named> {};

// Orders of every pair of radii above what the mesh leaves. The mesh is so fine where contact ends that the end moves
// with every radius, smoothly.
TEST_P(PartlyClosed, TheRemainderIsOfOrderFour) {
  const Validation v = validated(partly_closed(), {"", {GetParam().term}}, at, {}, {0.08, 0.04, 0.02, 0.01, 0.005});
  SCOPED_TRACE(text(v));
  EXPECT_EQ(v.verdict, Verdict::Holds);
  EXPECT_NEAR(v.intercept / v.coefficient, 1, 3e-4);
  // The remainder of the boundary tracking changes its sign: its order says nothing.
  if (std::string(GetParam().name) == "btrack") return;
  EXPECT_GT(v.order, 3.7);
  EXPECT_LT(v.order, 4.3);
  int pairs = 0;
  for (std::size_t i = 0; i + 1 < v.rows.size(); ++i) {
    if (std::abs(v.rows[i + 1].remainder / v.rows[i + 1].predicted) < 2e-3) continue;
    EXPECT_GT(v.rows[i].order, 3.7);
    EXPECT_LT(v.rows[i].order, 4.3);
    ++pairs;
  }
  EXPECT_GE(pairs, 2);
}

// What the closed part holds matters: the adjoint of the fully open crack is far from what finite holes do.
TEST_P(PartlyClosed, TheOpenAdjointIsWrong) {
  const Functional j{"", {GetParam().term}};
  const Validation v = validated(partly_closed(2), j, at, {}, {0.04, 0.02, 0.01, 0.005});
  EXPECT_NEAR(v.coefficient / v.intercept, 1, 1e-3) << text(v);
  Body finer = partly_closed(2);
  finer.sizing.size /= 2;
  const Solved b = solved(finer);
  const Analysis right = analyze(j, b.model, b.state);
  if (!right.adjoint) return;  // compliance needs none
  const std::vector<ContactStatus> status = contact_status(b.model, b.state);
  EXPECT_GT(std::count(status.begin(), status.end(), ContactStatus::Closed), 10);
  EXPECT_GT(std::count(status.begin(), status.end(), ContactStatus::Open), 10);
  Analysis open = analyze(j, b.model, b.state);
  open.fields = {};
  open.adjoint = solve_adjoint(b.model, open.derivative, std::vector<bool>(status.size(), false));
  // Another mesh, on which the contact ends elsewhere by up to an edge.
  EXPECT_NEAR(map_there(right, j) / v.intercept, 1, 0.01);
  EXPECT_GT(std::abs(map_there(open, j) / v.intercept - 1), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Functionals, PartlyClosed,
                         testing::Values(Named{"comp", compliance()}, Named{"track", displacement_tracking({}, {})},
                                         Named{"btrack", boundary_tracking(2, {}, {})},
                                         Named{"G", energy_release_rate(tip, {1, 0}, ring, {})}),
                         [](const auto& info) { return std::string(info.param.name); });

// Uniaxial tension or pressure along a straight crack: neither gap nor pressure anywhere on it.
Body stretched(double q) {
  const auto roller = [](Index label) {
    return Support{label, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }};
  };
  Scene s;
  s.material = material;
  s.laws.resize(1);
  s.supports = {roller(0), roller(3)};
  s.tractions = {{1, [q](const Vec2&, const Vec2&) { return Vec2(q, 0); }}};
  return {cracked_square(), s, {.size = 0.2, .crack_tip_size = 0.02}, element("bdms", 1)};
}

// Both loads have a one-sided derivative of their own, each confirmed by finite holes; neither is that of a crack that
// may open and close (linear in the load: opposite values), nor that of a closed one (no opening at all).
TEST(Biactive, LoadsAlongACrackHaveOneSidedDerivatives) {
  const Functional opening{"", {crack_opening(0, {})}};
  std::array<double, 2> value{}, linear{};
  for (const int side : {0, 1}) {
    const Body b = stretched(side == 0 ? 1 : -1);
    const Solved s = solved(b);
    const Analysis a = analyze(opening, s.model, s.state);
    EXPECT_NEAR(a.biactive_length, 0.8, 1e-12);
    EXPECT_NEAR(a.value, 0, 1e-12);
    Analysis without = analyze(opening, s.model, s.state);
    without.biactive = {};
    linear[side] = map_there(without, opening);
    const Validation v = validated(b, opening, at, {}, {0.08, 0.04, 0.02, 0.01, 0.005});
    SCOPED_TRACE(text(v));
    EXPECT_EQ(v.verdict, Verdict::Holds);
    EXPECT_NEAR(v.intercept / v.coefficient, 1, 1e-3);
    EXPECT_NEAR(map_there(a, opening) / v.coefficient, 1, 0.03);  // the coarse mesh of the map
    value[side] = v.coefficient;
  }
  EXPECT_NEAR(linear[0], -linear[1], 1e-9);
  EXPECT_GT(value[0], 1.1 * linear[0]);  // 0.69 against 0.60
  EXPECT_GT(value[1], 0.2);              // 0.27 against -0.60
  EXPECT_LT(value[1], 0.5 * value[0]);
}

// A body force along the crack, in a material that does not contract: the stress varies, the faces touch everywhere. In
// the hole the force is lost, which moves the faces, too.
TEST(Biactive, ABodyForceAlongTheCrackGoesWithTheHole) {
  Body b = stretched(-1.55);  // little stress at the hole: 2 (1 - 0.15) against it
  b.scene.material = plane_stress(1, 0);
  b.scene.body = [](const Vec2&) { return Vec2(2, 0); };
  b.sizing = {.size = 0.25, .crack_tip_size = 0.075};
  const Functional opening{"", {crack_opening(0, {})}};
  const Solved s = solved(b);
  const Analysis a = analyze(opening, s.model, s.state);
  EXPECT_NEAR(a.biactive_length, 0.8, 1e-12);
  const auto quotient = [&](double radius) {
    const std::vector<SmallChange> one{{at, radius}};
    const Meshing meshing{b.shape, b.sizing};
    return changes_at({meshing, b.element, std::span(&b.scene, 1), opening}, {}, one).difference(0, 0) /
           (pi * radius * radius);
  };
  const double limit = (4 * quotient(0.02) - quotient(0.04)) / 3, T = map_there(a, opening);
  EXPECT_NEAR(T / limit, 1, 0.045);
  // Without its part in what opens the faces T is another one.
  Model bare = s.model;
  bare.scene.body = {};
  Analysis other = a;
  other.model = &bare;
  const Vec2 moved = recovered_displacement(s.model, *a.adjoint, locate(s.model.mesh, there)[0], at).col(0);
  EXPECT_GT(std::abs(map_there(other, opening) - b.scene.body(at).dot(moved) - T), 0.09 * limit);
}

TEST(Biactive, DisplacementsOfTheTopSeeTheSide) {
  const Functional top{"", {boundary_tracking(2, [](const Vec2&, const Vec2&) { return Vec2(0, -1); }, {})}};
  std::array<double, 2> value{};
  for (const int side : {0, 1}) {
    const Validation v = validated(stretched(side == 0 ? 1 : -1), top, at);
    SCOPED_TRACE(text(v));
    EXPECT_EQ(v.verdict, Verdict::Holds);
    EXPECT_NEAR(v.intercept / v.coefficient, 1, 1e-3);
    EXPECT_GT(v.order, 3.7);
    EXPECT_LT(v.order, 4.3);
    value[side] = v.coefficient;
  }
  EXPECT_GT(value[1], 1.5 * value[0]);
}

// A pressure on the faces in the ring, and a strain without stress, add terms that it does not have.
TEST(Growth, EnergyReleaseRateRefusesWhatItDoesNotCount) {
  const Functional rate{"", {energy_release_rate(tip, {1, 0}, ring, {})}};
  const Body plain{cracked_square(), pulled(material, opens)};
  const auto refused = [&](const Scene& scene) {
    const Model model = prepare(triangulate(plain.shape, plain.sizing), plain.element, scene, 2);
    try {
      analyze(rate, model, solve(model));
      return std::string();
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      return std::string(e.what());
    }
  };
  Scene pressed = plain.scene, strained = plain.scene;
  pressed.laws[0].pressure = [](const Vec2&, const Vec2&) { return Vec2(0.1, 0); };
  const VectorField uniform = [](const Vec2&) { return Vec2(0.01, 0.01); };
  strained.eigenstrain = {{uniform, uniform}};
  EXPECT_EQ(refused(plain.scene), "");
  EXPECT_NE(refused(pressed).find("pressure in the crack"), std::string::npos);
  EXPECT_NE(refused(strained).find("eigenstrain"), std::string::npos);
  // The energy has a map there, but no derivative by the shape.
  const Functional potential{"", {energy()}};
  const Model model = prepare(triangulate(plain.shape, plain.sizing), plain.element, strained, 2);
  const State state = solve(model);
  const Analysis a = analyze(potential, model, state);
  EXPECT_THROW(shape_gradient(a, potential), Error);
  EXPECT_THROW(boundary_gradient(a, potential), Error);
}

// [theory: T.25]: T_G = d/dl (1/2 H(sigma, sigma)(x0)) = -dT/dl of the energy. The tip moves
// with its ring, the rest of the mesh stays: what is left is the element, not the mesher.
TEST(Growth, DerivativeOfTheEnergyReleaseRateIsThatOfTheMapAlongTheCrack) {
  const Functional rate{"", {energy_release_rate(tip, {1, 0}, ring, {})}}, potential{"", {energy()}};
  for (const bool closing : {false, true}) {
    const Body b{cracked_square(), pulled(material, closing ? closes_half : opens)};
    const Mesh mesh = triangulate(b.shape, b.sizing);
    const auto grown = [&](double by) {
      Mesh m = mesh;
      for (Vec2& x : m.points) {
        const double t = std::clamp(((x - tip).norm() - ring[0]) / (ring[1] - ring[0]), 0.0, 1.0);
        x.x() += by * (1 - t * t * t * (10 - 15 * t + 6 * t * t));
      }
      const Model model = prepare(m, b.element, b.scene, 2);
      const State s = solve(model);
      const Analysis a = analyze(potential, model, s);
      return Vec2(-map_there(a, potential), -a.value);  // 1/2 H there, -Pi
    };
    const auto slope = [&](double by) -> Vec2 { return (grown(by) - grown(-by)) / (2 * by); };
    const Vec2 richardson = (4 * slope(0.01) - slope(0.02)) / 3;
    const Model model = prepare(mesh, b.element, b.scene, 2);
    const State s = solve(model);
    const Analysis a = analyze(rate, model, s);
    EXPECT_NEAR(map_there(a, rate) / richardson[0], 1, 1e-3) << closing;
    EXPECT_NEAR(a.value / richardson[1], 1, 1e-4) << closing;
  }
}

// The adjoint of the work of the loads is the state, whatever the contact; found through the generic path.
TEST(Reciprocity, AdjointOfTheComplianceIsTheState) {
  for (const double nu : {0.3, 0.5})
    for (const bool closing : {false, true}) {
      Body b{cracked_square(), pulled(plane_strain(1, nu), closing ? closes_half : opens)};
      b.scene.body = [](const Vec2& x) { return Vec2(0.2, -0.5 * x.y()); };
      b.element = element("bdms", 1);
      const Solved s = solved(b);
      const Field z =
          solve_adjoint(s.model, derivative(compliance(), s.model, s.state), tied(contact_status(s.model, s.state)));
      const auto apart = [](const auto& x, const auto& y) {
        return (x - y).cwiseAbs().maxCoeff() / y.cwiseAbs().maxCoeff();
      };
      EXPECT_LT(apart(z.interior, s.state.interior), 1e-10) << nu << closing;
      EXPECT_LT(apart(z.skeleton, s.state.skeleton), 1e-10) << nu << closing;
    }
}

// A support that moves a little sends the compliance through the adjoint: T changes as little.
TEST(Reciprocity, PrescribedDisplacementsTakeTheAdjoint) {
  const Functional j{"", {compliance()}};
  Body b = partly_closed();
  const Solved fixed = solved(b);
  const Analysis of_fixed = analyze(j, fixed.model, fixed.state);
  EXPECT_FALSE(of_fixed.adjoint);
  b.scene.supports[0].value = [](const Vec2& x, const Vec2&) { return Vec2(0, 1e-9 * x.x()); };
  const Solved moved = solved(b);
  const Analysis of_moved = analyze(j, moved.model, moved.state);
  EXPECT_TRUE(of_moved.adjoint);
  EXPECT_NEAR(map_there(of_moved, j) / map_there(of_fixed, j), 1, 1e-7);
  // And in earnest.
  b.scene.supports[0].value = [](const Vec2& x, const Vec2&) { return Vec2(0, 0.2 * x.x()); };
  const Validation v = validated(b, j, at);
  EXPECT_EQ(v.verdict, Verdict::Holds) << text(v);
  EXPECT_NEAR(v.intercept / v.coefficient, 1, 1e-3) << text(v);
}

}  // namespace
}  // namespace kerf::contact_adjoint_test
