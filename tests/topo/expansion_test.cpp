#include "topo/expansion.hpp"

#include "tests/exact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf {
namespace {

Mat2 tensor(double xx, double yy, double xy) {
  Mat2 s;
  s << xx, xy, xy, yy;
  return s;
}

// Lame: an annulus eps < r < 1 under the traction p on r = 1 has the closed-form energy behind the expansion.
TEST(Expansion, HydrostaticDiscAgainstTheClosedForm) {
  for (const double nu : {0.0, 0.3, 0.4999}) {
    const Material m = plane_strain(2, nu);
    const double p = 1.5, kappa = 3 - 4 * nu;
    const double coefficient = hole_energy(m, tensor(p, p, 0), Vec2::Zero(), Vec2::Zero());
    const auto energy = [&](double eps) {  // minus half the work of the traction: compliance/2
      const double e2 = eps * eps;
      return -0.5 * std::numbers::pi * p * p * (kappa - 1 + 2 * e2) / (2 * m.mu * (1 - e2));
    };
    double before = 1;
    for (const double eps : {0.1, 0.05, 0.025}) {
      const double measured = (energy(eps) - energy(0)) / (std::numbers::pi * eps * eps);
      const double error = std::abs(measured / coefficient - 1);
      EXPECT_LT(error, 2 * eps * eps);
      EXPECT_LT(error, 0.3 * before);
      before = error;
    }
  }
}

TEST(Expansion, PureShearDiscAgainstTheClosedForm) {
  for (const double nu : {0.0, 0.3, 0.4999}) {
    const Material m = plane_stress(3, nu);
    const double d = 0.7, k = (3 - nu) / (1 + nu);
    const double coefficient = hole_energy(m, tensor(d, -d, 0), Vec2::Zero(), Vec2::Zero());
    const auto energy = [&](double e) {
      return -0.5 * std::numbers::pi * d * d *
             (1 - 2 * e * e + k * e * e + (k + 4) * std::pow(e, 4) + k * std::pow(e, 6)) /
             (m.mu * std::pow(1 - e * e, 3));
    };
    for (const double eps : {0.02, 0.01}) {
      const double measured = (energy(eps) - energy(0)) / (std::numbers::pi * eps * eps);
      EXPECT_NEAR(measured / coefficient, 1, 20 * eps * eps);
    }
  }
}

TEST(Expansion, FormIsTheOneOfPrincipalStressesAndIgnoresTheSkewPart) {
  const Material m = plane_strain(1000, 0.3);
  const Mat2 s = tensor(1.2, -0.3, 0.4);
  const double mean = 0.45, radius = std::hypot(0.75, 0.4), s1 = mean + radius, s2 = mean - radius;
  const double modulus = 1000 / (1 - 0.09);
  EXPECT_NEAR(hole_form(m, s, s), (std::pow(s1 + s2, 2) + 2 * std::pow(s1 - s2, 2)) / modulus, 1e-15);
  Mat2 skew = s;
  skew(0, 1) += 0.1;
  skew(1, 0) -= 0.1;
  EXPECT_NEAR(hole_form(m, skew, skew), hole_form(m, s, s), 1e-17);
  EXPECT_NEAR(hole_form(m, s, s), -2 * exact::hole_derivative(m, s), 1e-15);
}

TEST(Expansion, BodyForceTermIsItsWorkInTheHole) {
  EXPECT_DOUBLE_EQ(hole_energy(plane_strain(1, 0.2), Mat2::Zero(), Vec2(2, -1), Vec2(0.5, 3)), -2);
}

TEST(Expansion, FiniteInTheIncompressibleLimit) {
  const Material m{1, 0};
  EXPECT_NEAR(plane_modulus(m), 4, 1e-15);  // E' = 4 mu
  EXPECT_NEAR(hole_energy(m, tensor(1, 0, 0), Vec2::Zero(), Vec2::Zero()), -0.5 * 3 / 4, 1e-15);
}

}  // namespace
}  // namespace kerf
