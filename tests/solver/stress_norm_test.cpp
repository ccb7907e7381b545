// Bounds of the integral of the squared von Mises stress.

#include "solver/stress_norm.hpp"

#include "kerf/mesher.hpp"
#include "kerf/state.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::stress_norm_test {
namespace {

using namespace scenes;

/// Of plane strain with Poisson's ratio nu, or of plane stress.
SquaredVonMises von_mises(bool strain, double nu) {
  return [=](const Material&, const Mat2& s) {
    const double out = strain ? nu * s.trace() : 0, a = s(0, 0), b = s(1, 1);
    return 0.5 * ((a - b) * (a - b) + (b - out) * (b - out) + (out - a) * (out - a)) + 3 * s(0, 1) * s(1, 0);
  };
}

Bounded bounded(const Shape& shape, const Scene& scene, double size, const Element& element, const SquaredVonMises& f) {
  const Model model = prepare(triangulate(shape, {.size = size, .crack_tip_size = 0.3 * size}), element, scene, 1);
  return squared_stress_bounds(model, solve(model), f);
}

TEST(StressNorm, ThreeTimesTheShearModulusIsTheLeastFactor) {
  // vM^2 <= 3 mu A s : s, with equality in shear; A s : s of the principal stresses from Young's modulus.
  for (const bool strain : {true, false})
    for (const double nu : {-0.9, 0.0, 0.3, 0.4999})
      for (int k = 0; k < 36; ++k) {
        const double t = M_PI * k / 36, a = std::cos(t), b = std::sin(t), mu = 0.5 / (1 + nu);
        const Mat2 s = Eigen::Vector2d(a, b).asDiagonal();
        const double out = strain ? nu * (a + b) : 0, work = a * a + b * b - 2 * nu * a * b - (strain ? out * out : 0);
        const double square = von_mises(strain, nu)({}, s);
        EXPECT_LE(square, 3 * mu * work * (1 + 1e-12));
        if (k == 27) {
          EXPECT_NEAR(square, 3 * mu * work, 1e-12);
        }
      }
}

TEST(StressNorm, IsExactForAConstantStress) {
  for (const bool strain : {true, false}) {
    Shape shape = rectangle({0, 0}, {2, 1});
    Scene scene = pulled(strain ? plane_strain(3, 0.3) : plane_stress(3, 0.3), [](const Vec2&) { return Vec2(0, 2); });
    scene.laws.clear();
    scene.supports = {{0, false, false, true, clamp(0).value}, {3, false, true, false, clamp(3).value}};
    const Bounded b = bounded(shape, scene, 0.5, bdms(1), von_mises(strain, 0.3));
    const double exact = 2 * 4 * (strain ? 1 - 0.3 + 0.09 : 1);
    EXPECT_NEAR(b.lower, exact, 1e-4 * exact) << b.note;
    EXPECT_NEAR(b.upper, exact, 1e-4 * exact);
    EXPECT_TRUE(b.guaranteed) << b.note;
  }
}

// No exact solution: intervals of a coarse and of a fine mesh of another element meet, and the fine one is narrow.
TEST(StressNorm, HoldsWhatFinerMeshesSay) {
  for (const VectorField& load : {VectorField(opens), VectorField(closes_half)}) {
    const Shape shape = cracked_square();
    Scene scene = pulled(plane_strain(1, 0.3), load);
    const SquaredVonMises f = von_mises(true, 0.3);
    const Bounded coarse = bounded(shape, scene, 0.3, bdms(1), f), fine = bounded(shape, scene, 0.06, afw(2), f);
    EXPECT_LE(coarse.lower, fine.upper);
    EXPECT_GE(coarse.upper, fine.lower);
    EXPECT_LT(fine.upper - fine.lower, 0.5 * (coarse.upper - coarse.lower));
    EXPECT_GE(fine.value, coarse.lower);
    EXPECT_LE(fine.value, coarse.upper);
    EXPECT_TRUE(coarse.guaranteed) << coarse.note;
  }
}

TEST(StressNorm, WhatHasNoneSaysWhy) {
  Scene scene = pulled(plane_strain(1, 0.5), opens);
  EXPECT_NE(bounded(cracked_square(), scene, 0.3, bdms(1), von_mises(true, 0.5)).note.find("incompressible"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::stress_norm_test
