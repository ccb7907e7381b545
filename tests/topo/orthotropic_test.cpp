// Small holes in orthotropic bodies against holes that are really made, and what is refused there.
#include "topo/orthotropic.hpp"

#include "kerf/map.hpp"
#include "kerf/shape_gradient.hpp"
#include "solver/anisotropic.hpp"
#include "solver/system.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>

namespace kerf::orthotropic_test {
namespace {

using scenes::Body;
using scenes::validated;

constexpr Orthotropy wood{.young = {10, 1}, .poisson = 0.4, .shear = 0.6, .angle = 0.5};

Body body(const Material& m) {
  Body b{scenes::rectangle({-1, -1}, {1, 1}), {.material = m}};
  b.scene.supports = {scenes::clamp(0)};
  b.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.4, 1 + 0.5 * x.x()); }},
                       {1, [](const Vec2& x, const Vec2&) { return Vec2(0.3 * x.y(), 0.2); }}};
  return b;
}

TEST(OrthotropicHole, TendsToTheIsotropicForm) {
  const Mat2 s = (Mat2() << 1, 0.3, 0.3, -0.7).finished(), t = (Mat2() << 0.2, -1, -1, 0.5).finished();
  const Material limit = plane_stress(1, 0.3);
  for (const double off : {1e-2, 1e-5, 1e-8}) {
    const Material m = orthotropic({.young = {1 + off, 1}, .poisson = 0.3, .shear = 1 / 2.6, .angle = 0.7});
    EXPECT_FALSE(isotropic(m));
    EXPECT_NEAR(hole_form(m, s, t), hole_form(limit, s, t), 10 * off);
    EXPECT_NEAR(ellipse_form(m, 3, 0.4, s, t), ellipse_form(limit, 3, 0.4, s, t), 20 * off);
  }
}

TEST(OrthotropicHole, FormIsSymmetricAndTurnsWithTheBody) {
  const Mat2 s = (Mat2() << 1, 0.3, 0.3, -0.7).finished(), t = (Mat2() << 0.2, -1, -1, 0.5).finished();
  const Material m = orthotropic(wood);
  EXPECT_NEAR(hole_form(m, s, t), hole_form(m, t, s), 1e-14);
  EXPECT_NEAR(ellipse_form(m, 3, 0.4, s, t), ellipse_form(m, 3, 0.4, t, s), 1e-13);
  EXPECT_NEAR(ellipse_form(m, 1, 0.4, s, t), hole_form(m, s, t), 1e-14);
  const double angle = 0.8;
  const Mat2 q = (Mat2() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
  Orthotropy turned = wood;
  turned.angle += angle;
  EXPECT_NEAR(ellipse_form(orthotropic(turned), 3, 0.4 + angle, q * s * q.transpose(), q * t * q.transpose()),
              ellipse_form(m, 3, 0.4, s, t), 1e-13);
}

/// A long thin hole is a crack: (s n) . L^-1 (s n) per pi a^2.
TEST(OrthotropicHole, ThinOnesAreCracks) {
  const Material m = orthotropic(wood);
  const Mat2 s = (Mat2() << 1, 0.3, 0.3, 0.7).finished();
  const Vec2 through = s.col(1);
  const double aspect = 1e7;
  EXPECT_NEAR(ellipse_form(m, aspect, 0, s, s) / aspect / through.dot(surface(m).inverse_L * through), 1, 1e-6);
}

void expect_holds(const Validation& v, const std::string& what) {
  EXPECT_EQ(v.verdict, Verdict::Holds) << what << ": " << v.reason;
}

TEST(OrthotropicHole, EnergyMapAgainstHoles) {
  Body b = body(orthotropic(wood));
  b.scene.body = [](const Vec2& x) { return Vec2(0.3, -0.5 + x.x()); };
  const Functional j{.terms = {energy()}};
  expect_holds(validated(b, j, {0.2, -0.1}), "circle");
  expect_holds(validated(b, j, {-0.3, 0.35}, {.kind = Perturbation::Kind::Ellipse, .aspect = 3}), "best ellipse");
  expect_holds(validated(b, j, {0.2, -0.1}, {.kind = Perturbation::Kind::Ellipse, .aspect = 2, .angle = 1.0}),
               "ellipse");
}

// Strong and weak directions, and stress that the isotropic form would get wrong by far.
TEST(OrthotropicHole, EnergyMapOfAStrongMaterial) {
  const Material m = orthotropic({.young = {40, 2}, .poisson = 0.3, .shear = 1, .angle = -0.9});
  const Validation v = validated(body(m), {.terms = {energy()}}, {0.1, 0.2});
  expect_holds(v, "strong");
  EXPECT_NEAR(v.intercept, v.coefficient, 2e-3 * std::abs(v.coefficient));
}

TEST(OrthotropicHole, FunctionalsWithAnAdjointAgainstHoles) {
  const Body b = body(orthotropic(wood));
  const Vec2 at(0.2, -0.1);
  expect_holds(validated(b, {.terms = {compliance()}}, at), "compliance");
  expect_holds(validated(b, {.terms = {displacement_tracking({}, {})}}, at), "displacement_tracking");
  expect_holds(validated(b, {.terms = {boundary_tracking(2, {}, {})}}, at), "boundary_tracking");
}

TEST(OrthotropicHole, CrackedBodiesAndRegionsAgainstHoles) {
  Body b = body(orthotropic(wood));
  b.shape = scenes::cracked_square(0.3);
  b.scene.laws.resize(1);
  expect_holds(validated(b, {.terms = {energy()}}, {0.1, 0.5}), "crack in contact");
  expect_holds(validated(b, {.terms = {crack_opening(0, {})}}, {0.1, 0.5}), "crack_opening");
  b.scene.laws[0].kind = CrackLaw::Kind::Open;
  expect_holds(validated(b, {.terms = {energy_release_rate({0.3, 0}, {1, 0}, {0.06, 0.2}, {})}}, {-0.5, -0.4}),
               "energy_release_rate");
  Body mixed = body(plane_stress(1, 0.3));
  mixed.shape.regions = {circle("r", {0.2, -0.1}, 0.5, none)};
  mixed.scene.regions = {orthotropic(wood)};
  expect_holds(validated(mixed, {.terms = {energy()}}, {0.2, -0.1}, {}, {0.04, 0.02, 0.01, 0.005}), "region");
}

TEST(OrthotropicHole, OthersAreRefusedByName) {
  const Scene wooden{.material = orthotropic(wood)}, mixed{.regions = {orthotropic(wood)}}, plain{};
  const auto words = [](const Scene& s, const Functional& j, const Perturbation& p) {
    return unknown_expansion(s, j, p).value_or("");
  };
  const Functional work{.terms = {energy()}}, stress{.terms = {stress_power(2, {}, false)}};
  for (const Scene& s : {wooden, mixed}) {
    for (const auto kind : {Perturbation::Kind::ClampedHole, Perturbation::Kind::Inclusion, Perturbation::Kind::Crack})
      EXPECT_NE(words(s, work, {.kind = kind}).find(word(kind)), std::string::npos);
    EXPECT_NE(words(s, stress, {}).find("stress_power"), std::string::npos);
    EXPECT_EQ(words(s, work, {}), "");
  }
  for (const auto kind : {Perturbation::Kind::Inclusion, Perturbation::Kind::Crack})
    EXPECT_EQ(words(plain, stress, {.kind = kind}), "");

  // The same by every way in.
  const Body b = body(wooden.material);
  const Model m = prepare(triangulate(b.shape, {.size = 0.5}), bdms(1), b.scene, 1);
  const State s = solve(m);
  const Analysis a = analyze(work, m, s), of_stress = analyze(stress, m, s);
  const std::vector<Vec2> at{{0.1, 0.1}};
  for (const auto kind : {Perturbation::Kind::ClampedHole, Perturbation::Kind::Inclusion, Perturbation::Kind::Crack}) {
    EXPECT_THROW(map_at(a, work, {.perturbation = {.kind = kind}, .radius = 0.05}, at), Error);
    EXPECT_THROW(map_everywhere(a, work, {.perturbation = {.kind = kind}, .radius = 0.05}, split_for_stress(m.mesh)),
                 Error);
    EXPECT_THROW(validated(b, work, at[0], {.kind = kind}), Error);
  }
  EXPECT_THROW(map_at(of_stress, stress, {}, at), Error);
  EXPECT_THROW(validated(b, stress, at[0]), Error);
  EXPECT_THROW(shape_gradient(a, work), Error);
  EXPECT_NO_THROW(map_at(a, work, {}, at));
}

}  // namespace
}  // namespace kerf::orthotropic_test
