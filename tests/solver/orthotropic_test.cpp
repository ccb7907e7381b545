// Orthotropic bodies against closed forms: uniform states, the central crack of Lekhnitskii, the fields of a tip.
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "solver/anisotropic.hpp"
#include "solver/post/orthotropic_tip.hpp"
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"
#include "tests/solver/scenes.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <complex>

namespace kerf::orthotropic_test {
namespace {

using Complex = std::complex<double>;

constexpr Orthotropy wood{.young = {10, 1}, .poisson = 0.4, .shear = 0.6, .angle = 0.5};
Mat2 turn(double angle) {
  return (Mat2() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
}

/// Hooke's law along the axes, turned by hand.
Mat2 hooke(const Orthotropy& o, const Mat2& s) {
  const Mat2 q = turn(o.angle), own = q.transpose() * s * q;
  const double e1 = own(0, 0) / o.young[0] - o.poisson / o.young[0] * own(1, 1),
               e2 = own(1, 1) / o.young[1] - o.poisson / o.young[0] * own(0, 0), half = own(0, 1) / (2 * o.shear);
  return q * (Mat2() << e1, half, half, e2).finished() * q.transpose();
}

TEST(Orthotropic, StrainsAreThoseOfTheConstants) {
  const Mat2 s = (Mat2() << 1, 0.3, 0.3, -0.7).finished();
  for (const double angle : {0.0, 0.5, -1.2, 3.0}) {
    Orthotropy o = wood;
    o.angle = angle;
    const Material m = orthotropic(o);
    EXPECT_FALSE(isotropic(m));
    EXPECT_LT((strain(m, s) - hooke(o, s)).norm(), 1e-14);
    const Eigen::Vector3d e = strain_matrix(m) * Eigen::Vector3d(1, -0.7, 0.3);
    EXPECT_LT((e - Eigen::Vector3d(hooke(o, s)(0, 0), hooke(o, s)(1, 1), 2 * hooke(o, s)(0, 1))).norm(), 1e-14);
    EXPECT_LT((stress_matrix(m) * e - Eigen::Vector3d(1, -0.7, 0.3)).norm(), 1e-13);
    const Mat2 q = turn(0.3);  // the same stress and strain in a turned frame
    EXPECT_LT((q * strain(seen_from(m, 0.3), q.transpose() * s * q) * q.transpose() - hooke(o, s)).norm(), 1e-14);
  }
}

TEST(Orthotropic, ShearModuliAreEigenvalues) {
  for (const double shear : {0.05, 0.6, 20.0}) {
    Orthotropy o = wood;
    o.shear = shear;
    const Material m = orthotropic(o);
    Eigen::Matrix3d C = stress_matrix(m);
    C.col(2) *= std::sqrt(2.0);
    C.row(2) *= std::sqrt(2.0);
    const Eigen::Vector3d values = C.selfadjointView<Eigen::Upper>().eigenvalues();
    EXPECT_NEAR(shear_moduli(m).least / (0.5 * values.minCoeff()), 1, 1e-12);
    EXPECT_NEAR(shear_moduli(m).largest / (0.5 * values.maxCoeff()), 1, 1e-12);
  }
}

TEST(Orthotropic, ConstantsOfAnIsotropicMaterialAreIsotropic) {
  const Material m = orthotropic({.young = {2, 2}, .poisson = 0.25, .shear = 2 / 2.5, .angle = 1});
  const Material same = plane_stress(2, 0.25);
  EXPECT_TRUE(isotropic(m));
  EXPECT_NEAR(m.mu, same.mu, 1e-15);
  EXPECT_NEAR(m.c, same.c, 1e-15);
}

TEST(Orthotropic, WhatNoMaterialHasIsRefused) {
  const auto wrong = [](std::array<double, 2> young, double poisson, double shear) {
    EXPECT_THROW(orthotropic({.young = young, .poisson = poisson, .shear = shear}), Error);
  };
  wrong({1, -1}, 0.3, 1);
  wrong({1, 1}, 0.3, 0);
  wrong({1, 4}, 0.5, 1);
  wrong({1, 1}, 1, 1);
  wrong({1, 1}, nan, 1);
  EXPECT_NO_THROW(orthotropic({.young = {4, 1}, .poisson = 1.9, .shear = 1}));
}

// The state s with the rotation 0.2, in every element.
TEST(Orthotropic, PatchTest) {
  const Material m = orthotropic(wood);
  const Mat2 s = (Mat2() << 1, 0.3, 0.3, -0.7).finished(), e = strain(m, s);
  const Mat2 gradient = e + (Mat2() << 0, 0.2, -0.2, 0).finished();
  const double energy = 0.5 * s.cwiseProduct(hooke(wood, s)).sum();
  Scene scene{.material = m};
  const auto moved = [&](const Vec2& x, const Vec2&) -> Vec2 { return gradient * x; };
  const auto pulled = [&](const Vec2&, const Vec2& n) -> Vec2 { return s * n; };
  scene.supports = {{0, false, true, true, moved}, {3, false, true, true, moved}};
  scene.tractions = {{1, pulled}, {2, pulled}};
  for (const char* name :
       {"peers", "bdms", "bdms-c", "afw", "arnold-winther", "arnold-winther-c", "arnold-winther-nc", "p1", "p2"}) {
    SCOPED_TRACE(name);
    const Model model = prepare(exact::unit_square_mesh(3, 0.2), element(name), scene, 1);
    const State state = solve(model);
    EXPECT_TRUE(certified(state));
    const double off = stress_norm(model, state, [&](const Eigen::Vector4d& v) {
      return (v - Eigen::Vector4d(s(0, 0), s(0, 1), s(1, 0), s(1, 1))).norm();
    });
    EXPECT_LT(off, 1e-11);
    EXPECT_NEAR(strain_energy(model, state), energy, 1e-11 * energy);
    const Vec2 x(0.4, 0.7);
    const Index t = locate(model.mesh, std::array{x})[0];
    const Points at = x;
    EXPECT_LT((recovered_displacement(model, state, t, at).col(0) - gradient * x).norm(), 1e-11);
    EXPECT_NEAR(evaluate(model, state, t, at).rotation[0], 0.2, 1e-10);
    const EnergyBounds b = energy_bounds(model, state);
    if (std::isfinite(b.lower)) {
      EXPECT_NEAR(b.lower, b.upper, 1e-9 * energy);
    }
    if (can_estimate_error(model.element)) {
      EXPECT_LT(error_indicator(model, state).relative, 1e-9);
    }
  }
}

// The same through the saddle point that is not condensed.
TEST(Orthotropic, SaddlePointSaysTheSame) {
  const Material m = orthotropic(wood);
  Scene scene{.material = m};
  scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.2, x.x()); }}};
  const Model model = prepare(exact::unit_square_mesh(4, 0.2), bdms(1), scene, 1);
  const double energy = potential_energy(model, solve(model));
  EXPECT_NEAR(potential_energy(model, solve_saddle_point(model)), energy, 1e-10 * std::abs(energy));
}

/// Lekhnitskii's plate with a crack from (-1, 0) to (1, 0) that is free, under s_yy = normal, s_xy = shear far away and
/// s_xx = along added: functions of x + p y, roots of the equation solved here.
struct CentralCrack {
  Complex p, q;
  double normal = 1, shear = 0.4, along = 0.3;

  explicit CentralCrack(const Orthotropy& o) {
    // Along the axes b11 p^4 + (2 b12 + b66) p^2 + b22 = 0, then turned.
    const double b11 = 1 / o.young[0], b22 = 1 / o.young[1], middle = -2 * o.poisson / o.young[0] + 1 / o.shear;
    const Complex rest = std::sqrt(Complex(middle * middle - 4 * b11 * b22, 0));
    const auto root = [&](double sign) {
      Complex own = std::sqrt((-middle + sign * rest) / (2 * b11));
      if (own.imag() < 0) own = -own;
      return (std::sin(o.angle) + own * std::cos(o.angle)) / (std::cos(o.angle) - own * std::sin(o.angle));
    };
    p = root(1), q = root(-1);
  }

  Mat2 stress(const Vec2& x) const {
    const auto f = [&](const Complex& root) {
      const Complex z = x.x() + root * x.y();
      return z / (std::sqrt(z - 1.0) * std::sqrt(z + 1.0));
    };
    const Complex P = f(p), Q = f(q), d = p - q;
    const double s22 = normal * ((p * Q - q * P) / d).real() - shear * ((P - Q) / d).real(),
                 s12 = normal * (p * q * (P - Q) / d).real() + shear * ((p * P - q * Q) / d).real(),
                 s11 = normal * (p * q * (q * Q - p * P) / d).real() - shear * ((p * p * P - q * q * Q) / d).real() +
                       along;
    return (Mat2() << s11, s12, s12, s22).finished();
  }
};

Scene loaded(const Material& m, const CentralCrack& truth, CrackLaw::Kind kind = CrackLaw::Kind::Open) {
  Scene s{.material = m, .laws = {{.kind = kind}}};
  for (Index label = 0; label < 4; ++label)
    s.tractions.push_back({label, [truth](const Vec2& x, const Vec2& n) -> Vec2 { return truth.stress(x) * n; }});
  return s;
}

// On uniform meshes the error of K is of the order h: halved with h, and gone in what both meshes extrapolate to.
TEST(Orthotropic, CentralCrackHasTheFactorsOfThePlane) {
  for (const double angle : {0.0, 0.5, -1.1}) {
    SCOPED_TRACE(angle);
    Orthotropy o = wood;
    o.angle = angle;
    const CentralCrack truth(o);
    const Material m = orthotropic(o);
    const double unit = std::sqrt(pi);
    const Vec2 K(truth.shear * unit, truth.normal * unit);
    const double G = 0.5 * K.dot(surface(m).inverse_L * K);
    const auto tips = [&](int n) {
      const Model model = prepare(exact::crack_mesh(n), bdms(2), loaded(m, truth), 2);
      return crack_tips(model, solve(model));
    };
    const std::vector<TipIntensity> coarse = tips(16), fine = tips(32);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto expect = [&](double TipIntensity::*value, double exact, double size) {
        EXPECT_LT(std::abs(fine[i].*value - exact), 0.55 * std::abs(coarse[i].*value - exact));
        EXPECT_NEAR(2 * fine[i].*value - coarse[i].*value, exact, 1e-3 * size);
      };
      expect(&TipIntensity::K_I, K[1], unit);
      expect(&TipIntensity::K_II, K[0], unit);
      expect(&TipIntensity::T, truth.along, 1);
      expect(&TipIntensity::G, G, G);
      expect(&TipIntensity::J, G, 2 * G);
    }
  }
}

// Towards isotropy the roots meet, and nothing is lost: the material below has roots that differ by about the square
// root of the deviation.
TEST(Orthotropic, NearIsotropyNothingIsLost) {
  const auto tip_of = [](const Material& m) {
    const CentralCrack truth(wood);  // any load that is the same for all
    const Model model = prepare(exact::crack_mesh(8), bdms(1), loaded(m, truth), 1);
    return crack_tips(model, solve(model)).back();
  };
  const TipIntensity limit = tip_of(plane_stress(1, 0.3));
  for (const double off : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
    const TipIntensity t =
        tip_of(orthotropic({.young = {1 + off, 1}, .poisson = 0.3, .shear = (1 + off) / 2.6, .angle = 0.7}));
    const double allowed = 2 * off + 1e-9;
    EXPECT_NEAR(t.K_I, limit.K_I, allowed) << off;
    EXPECT_NEAR(t.K_II, limit.K_II, allowed) << off;
    EXPECT_NEAR(t.T, limit.T, allowed) << off;
    EXPECT_NEAR(t.G, limit.G, 4 * allowed) << off;
  }
}

// Balance and a single-valued displacement by differences, and the jump between the faces that G wants.
TEST(Orthotropic, FieldsOfATip) {
  for (const Orthotropy& o : {wood, Orthotropy{.young = {1, 1}, .poisson = 0.3, .shear = 1.0001 / 2.6, .angle = 0.7},
                              Orthotropy{.young = {40, 2}, .poisson = 1.5, .shear = 3, .angle = -1.1}}) {
    const Material m = orthotropic(o);
    for (const Vec2& x : {Vec2(0.7, 0.4), Vec2(-0.3, 0.8), Vec2(-0.9, -0.1), Vec2(0.2, -1)})
      for (std::size_t k = 0; k < 3; ++k) {
        constexpr double h = 1e-5;
        const auto at = [&](const Vec2& y) { return orthotropic_tip_fields(m, y, std::atan2(y.y(), y.x()))[k]; };
        const auto slope = [&](int axis) {
          const Vec2 step = h * Vec2::Unit(axis);
          const LocalState a = at(x + step), b = at(x - step);
          return LocalState{(a.stress - b.stress) / (2 * h), (a.gradient - b.gradient) / (2 * h)};
        };
        const LocalState dx = slope(0), dy = slope(1);
        EXPECT_LT((dx.stress.col(0) + dy.stress.col(1)).norm(), 1e-8);
        EXPECT_LT((dy.gradient.col(0) - dx.gradient.col(1)).norm(), 1e-7);
      }
    const auto slide = orthotropic_tip_fields(m, {-1, 0}, pi), below = orthotropic_tip_fields(m, {-1, 0}, -pi);
    const Mat2 inverse_L = surface(m).inverse_L;
    // [u] = sqrt(8 r/pi) L^-1 K, [u_,1] = -[u]/(2 r)
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec2 jump = slide[k].gradient.col(0) - below[k].gradient.col(0);
      EXPECT_LT((jump + 0.5 * std::sqrt(8 / pi) * inverse_L.col(k == 0 ? 1 : 0)).norm(), 1e-12);
      EXPECT_LT((slide[k].stress.col(1)).norm(), 1e-12);
    }
  }
}

// A crack that is pressed together slides, and does not open: K_I follows K_II, of either sign.
TEST(Orthotropic, ClosedTipSlides) {
  const Material m = orthotropic(wood);
  for (const double shear : {0.5, -0.5}) {
    CentralCrack truth(wood);
    truth.normal = -1, truth.shear = shear;
    Scene s = loaded(m, truth, CrackLaw::Kind::Unilateral);
    for (Traction& t : s.tractions)
      t.value = [shear](const Vec2&, const Vec2& n) -> Vec2 { return (Mat2() << 0, shear, shear, -1).finished() * n; };
    const Model model = prepare(exact::crack_mesh(16), bdms(2), s, 2);
    const State state = solve(model);
    const Mat2 inverse_L = surface(m).inverse_L;
    for (const TipIntensity& tip : crack_tips(model, state)) {
      EXPECT_GT(std::abs(tip.K_II), 0.3);
      EXPECT_NEAR(inverse_L(1, 0) * tip.K_II + inverse_L(1, 1) * tip.K_I, 0, 1e-10);
      EXPECT_NEAR(tip.J / tip.G, 1, 2e-2);
      EXPECT_TRUE(std::isnan(tip.T));
    }
  }
}

// Coulomb's friction leaves the power 1/2 in one material: the open plate under S, N with no opening, plus a uniform
// state that presses the faces with p and shears them with f p. The spread says how far the false pressure at the tip
// carries K.
TEST(Orthotropic, ClosedTipSlidesAgainstFriction) {
  constexpr double f = 0.3, p = 1.2;
  for (const double angle : {0.6, -0.9})
    for (const double slip : {1.0, -1.0}) {
      SCOPED_TRACE(fmt::format("{} {}", angle, slip));
      Orthotropy o = wood;
      o.angle = angle;
      const Material m = orthotropic(o);
      const Mat2 inverse_L = surface(m).inverse_L;
      CentralCrack truth(o);
      truth.shear = 0.4 * slip;
      truth.normal = -inverse_L(1, 0) / inverse_L(1, 1) * truth.shear;
      const Mat2 pressed = (Mat2() << 0, slip * f * p, slip * f * p, -p).finished();
      Scene s{.material = m, .laws = {{.friction = f}}};
      for (Index label = 0; label < 4; ++label)
        s.tractions.push_back({label, [truth, pressed](const Vec2& x, const Vec2& n) -> Vec2 {
                                 return (truth.stress(x) + pressed) * n;
                               }});
      const Vec2 K = std::sqrt(pi) * Vec2(truth.normal, truth.shear);
      const Model model = prepare(exact::crack_mesh(32), bdms(2), s, 2);
      const State state = solve(model);
      for (const TipIntensity& tip : crack_tips(model, state)) {
        EXPECT_NEAR(inverse_L(1, 0) * tip.K_II + inverse_L(1, 1) * tip.K_I, 0, 1e-10);
        EXPECT_NEAR(tip.K_I, K[0], 0.03 * K.norm());
        EXPECT_NEAR(tip.K_II, K[1], 0.03 * K.norm());
        EXPECT_LT(std::abs(tip.K_I - K[0]), tip.spread_K_I * K.norm());
        EXPECT_LT(std::abs(tip.K_II - K[1]), tip.spread_K_II * K.norm());
        EXPECT_LT(tip.spread, 0.1);
      }
    }
}

// Of a body without a closed form: the bounds hold the energy of a far better solution, and close in.
TEST(Orthotropic, BoundsHoldTheEnergy) {
  for (const Orthotropy& o : {wood, Orthotropy{.young = {50, 1}, .poisson = 2, .shear = 0.4, .angle = -0.3}}) {
    Scene scene{.material = orthotropic(o)};
    scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
    scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.2, 1 - x.x() * x.x()); }}};
    scene.body = [](const Vec2& x) { return Vec2(x.y(), -1); };
    const Model fine = prepare(exact::unit_square_mesh(24), bdms(3), scene, 2);
    const double truth = potential_energy(fine, solve(fine));
    double width = infinity;
    for (const int n : {4, 8}) {
      const Model model = prepare(exact::unit_square_mesh(n), bdms(1), scene, 1);
      const State state = solve(model);
      const EnergyBounds b = energy_bounds(model, state);
      EXPECT_TRUE(b.guaranteed) << b.note;
      EXPECT_LT(b.lower, truth);
      EXPECT_GT(b.upper, truth);
      EXPECT_LT(b.upper - b.lower, 0.7 * width);
      width = b.upper - b.lower;
    }
    if (o.young == wood.young) {
      EXPECT_LT(width, 0.03 * std::abs(truth));
    }
  }
}

// A clamped square with a strong direction against a finer mesh of a better element: neither far too small nor too
// large.
TEST(Orthotropic, EstimateOfTheError) {
  for (const double ratio : {10., 50.}) {
    Scene scene{.material = orthotropic({.young = {ratio, 1}, .poisson = 0.3, .shear = 0.4, .angle = 0.5})};
    scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
    scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.2, std::sin(3 * x.x())); }}};
    const Model model = prepare(exact::unit_square_mesh(8), bdms(1), scene, 1),
                fine = prepare(exact::unit_square_mesh(48), bdms(2), scene, 2);
    const State state = solve(model), truth = solve(fine);
    const Locator locator = make_locator(model.mesh);
    double off = 0, all = 0;
    for (Index t = 0; t < static_cast<Index>(fine.mesh.triangles.size()); ++t) {
      const Vec2 x = centroid(fine.mesh, t);
      const Eigen::Vector4d a = evaluate(fine, truth, t, x).stress.col(0),
                            b = evaluate(model, state, locate(model.mesh, locator, x), x).stress.col(0);
      off += area(fine.mesh, t) * (a - b).squaredNorm();
      all += area(fine.mesh, t) * a.squaredNorm();
    }
    const double index = error_indicator(model, state).relative / std::sqrt(off / all);
    EXPECT_GT(index, 0.75) << ratio;
    EXPECT_LT(index, 1.6) << ratio;
  }
}

}  // namespace
}  // namespace kerf::orthotropic_test
