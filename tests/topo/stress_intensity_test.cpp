// K of a tip as a functional: against the tips of the state, against a hole beside a crack in a sheet in closed form,
// and against G.

#include "kerf/fracture.hpp"
#include "kerf/map.hpp"
#include "kerf/shape_gradient.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::stress_intensity_test {
namespace {

using namespace scenes;

const Material material = plane_strain(1, 0.3);
constexpr std::array<double, 2> ring = {0.06, 0.2};

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

Functional of_tip(TipQuantity quantity, const Vec2& tip, const Vec2& along,
                  const std::array<double, 2>& within = ring) {
  return {"", {stress_intensity({quantity, along}, tip, within, {}, 0)}};
}

// d ln K/d(pi eps^2) of the right tip of the crack from (-1, 0) to (1, 0) under tension, by Bueckner's field.
struct Place {
  Vec2 at;
  double change;
};
const std::vector<Place> beside_a_crack = {{{2, 0.5}, 0.19376108},  {{-2, 0.5}, 0.05382342}, {{1.5, 0.5}, 0.54626360},
                                           {{1, 0.5}, -0.66417300}, {{0, 0.5}, 0.01896929},  {{0, 1}, -0.03978874},
                                           {{0, 2}, -0.07365592},   {{1.2, 0.3}, 1.54056099}};

TEST(StressIntensity, AHoleBesideACrackInASheet) {
  Body sheet{rectangle({-60, -60}, {60, 60}),
             pulled(material, [](const Vec2&) { return Vec2(0, 1); }),
             {.size = 6, .crack_tip_size = 0.02, .grading = 0.12},
             element("bdms", 2)};
  sheet.shape.cracks = {{"crack", {Vec2(-1, 0), Vec2(1, 0)}}};
  sheet.scene.supports = {{0, true, true, false, {}}, {3, true, true, false, {}}};
  for (Support& roller : sheet.scene.supports)
    roller.value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  const Solved s = solved(sheet);
  const Functional K_I = of_tip(TipQuantity::OpeningMode, {1, 0}, {1, 0}, {0.05, 0.18});
  const Analysis a = analyze(K_I, s.model, s.state);
  EXPECT_NEAR(a.value / std::sqrt(pi), 1, 2e-3);
  std::vector<Vec2> at;
  for (const Place& p : beside_a_crack) at.push_back(p.at);
  const auto T = map_at(a, K_I, {}, at);
  for (std::size_t i = 0; i < at.size(); ++i)
    EXPECT_NEAR(T[i].value / a.value, beside_a_crack[i].change, 0.01 * std::abs(beside_a_crack[i].change) + 2e-4)
        << at[i].transpose();
}

// A slanted crack in mixed mode: values as at the tips of the state, and three derivatives that must agree.
TEST(StressIntensity, AgreesWithTheReleaseRate) {
  Body b{cracked_square(), pulled(material, opens), {.size = 0.1}, element("bdms", 2)};
  const Vec2 from(-0.3, -0.2), tip(0.35, 0.15), along = (tip - from).normalized();
  b.shape.cracks = {{"crack", {from, tip}}};
  const Solved s = solved(b);
  const TipIntensity by_state = crack_tips(s.model, s.state).at(1);
  const std::vector<Vec2> at = {{0.6, 0.5}, {0.1, 0.5}, {-0.5, -0.5}};
  const auto analysis = [&](TipQuantity quantity) { return analyze(of_tip(quantity, tip, along), s.model, s.state); };
  const Analysis I = analysis(TipQuantity::OpeningMode), II = analysis(TipQuantity::SlidingMode),
                 both = analysis(TipQuantity::Equivalent);
  EXPECT_GT(std::abs(by_state.K_II), 0.2 * by_state.K_I);
  EXPECT_NEAR(I.value, by_state.K_I, 2e-3 * by_state.K_I);
  EXPECT_NEAR(II.value, by_state.K_II, 2e-3 * by_state.K_I);
  EXPECT_NEAR(both.value, std::hypot(by_state.K_I, by_state.K_II), 2e-3 * by_state.K_I);
  const Functional G{"", {energy_release_rate(tip, along, ring, {})}};
  const Analysis rate = analyze(G, s.model, s.state);
  const auto map = [&](const Analysis& a, TipQuantity quantity) {
    return map_at(a, of_tip(quantity, tip, along), {}, at);
  };
  const auto of_I = map(I, TipQuantity::OpeningMode), of_II = map(II, TipQuantity::SlidingMode),
             of_both = map(both, TipQuantity::Equivalent), of_G = map_at(rate, G, {}, at);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double from_K = 2 * (I.value * of_I[i].value + II.value * of_II[i].value) / plane_modulus(material);
    EXPECT_NEAR(from_K, of_G[i].value, 5e-3 * std::abs(of_G[i].value)) << at[i].transpose();
    EXPECT_NEAR(of_both[i].value, plane_modulus(material) * of_G[i].value / (2 * both.value),
                1e-9 * std::abs(of_both[i].value));
  }
}

// The ring reaches faces in contact, whose pressure opens the tip.
TEST(StressIntensity, KnowsThePressureOfContact) {
  const Body b{cracked_square(), pulled(material, closes_half), {.size = 0.1}, element("bdms", 2)};
  const Solved s = solved(b);
  const TipIntensity by_state = crack_tips(s.model, s.state).at(1);
  const std::array<double, 2> wide = {0.4, 0.58};
  const double with = analyze(of_tip(TipQuantity::OpeningMode, {0.4, 0}, {1, 0}, wide), s.model, s.state, true).value;
  const Functional without{"", {stress_intensity({.along = {1, 0}}, {0.4, 0}, wide, {})}};
  EXPECT_NEAR(with, by_state.K_I, 5e-3 * by_state.K_I);
  EXPECT_GT(std::abs(analyze(without, s.model, s.state, true).value - by_state.K_I), 0.01 * by_state.K_I);
}

// Under a body force the disc inside the ring has a share.
TEST(StressIntensity, KnowsABodyForce) {
  Body b{cracked_square(), pulled(material, opens), {.size = 0.1}, element("bdms", 2)};
  const VectorField force = [](const Vec2& x) { return Vec2(3 + x.y(), 2); };
  b.scene.body = force;
  const Solved s = solved(b);
  const TipIntensity by_state = crack_tips(s.model, s.state).at(1);
  const Functional K_II{"", {stress_intensity({TipQuantity::SlidingMode, {1, 0}}, {0.4, 0}, ring, force)}};
  EXPECT_NEAR(analyze(K_II, s.model, s.state, true).value, by_state.K_II,
              3e-3 * std::hypot(by_state.K_I, by_state.K_II));
}

// A dent in the upper side, against central differences of whole solves.
TEST(StressIntensity, ByTheShape) {
  const Body b{cracked_square(), pulled(material, opens), {.size = 0.2, .crack_tip_size = 0.02}, element("bdms", 2)};
  const Mesh mesh = triangulate(b.shape, b.sizing);
  const auto moved = [&](const Vec2& x) -> Vec2 {
    const double r = (x - Vec2(0.2, 1)).norm() / 0.5;
    return r < 1 ? Vec2(0.3, 1) * std::pow(1 - r * r, 3) : Vec2(Vec2::Zero());
  };
  for (const TipQuantity quantity : {TipQuantity::OpeningMode, TipQuantity::SlidingMode, TipQuantity::Equivalent}) {
    const Functional K = of_tip(quantity, {0.4, 0}, {1, 0});
    const auto value = [&](double step) {
      Mesh other = mesh;
      for (Vec2& x : other.points) x += step * moved(x);
      const Model m = prepare(std::move(other), b.element, b.scene, 2);
      return analyze(K, m, solve(m), true).value;
    };
    const double h = 1e-2, expected = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
    const Model model = prepare(mesh, b.element, b.scene, 2);
    const State state = solve(model);
    const Points gradient = shape_gradient(analyze(K, model, state), K);
    double along = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
      along += gradient.col(static_cast<Eigen::Index>(v)).dot(moved(mesh.points[v]));
    EXPECT_NEAR(along, expected, 1e-5 * std::abs(expected)) << static_cast<int>(quantity);
  }
}

}  // namespace
}  // namespace kerf::stress_intensity_test
