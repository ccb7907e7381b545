// Cracks on the bisector of a wedge: known limits, and the fields against equilibrium.

#include "inspect/wedge.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::inspect::wedge_test {
namespace {

constexpr double degree = pi / 180;

// The half plane has Koiter's number in both modes, and of a crack that goes on K stays what it is.
TEST(Wedge, OfAHalfPlaneAndOfACrack) {
  for (const int mode : {0, 1}) EXPECT_NEAR(wedge_intensity(mode, pi / 2, 0), 1.1215222552, 2e-6) << mode;
  const Wedge crack = wedge(pi);
  for (const std::size_t mode : {0u, 1u}) {
    EXPECT_NEAR(crack.lambda[mode], 0.5, 1e-9);
    EXPECT_NEAR(crack.factor[mode], 1, 1e-5);
  }
}

// Exponents of notches [Williams 1952].
TEST(Wedge, Exponents) {
  const Wedge right = wedge(135 * degree);
  EXPECT_NEAR(right.lambda[0], 0.5444837, 1e-6);
  EXPECT_NEAR(right.lambda[1], 0.9085292, 1e-6);
  EXPECT_NEAR(wedge(120 * degree).lambda[0], 0.6157311, 1e-6);
  EXPECT_NEAR(wedge(120 * degree).lambda[1], 1.1489126, 1e-5);
  EXPECT_NEAR(wedge(150 * degree).lambda[0], 0.5122214, 1e-6);
  EXPECT_NEAR(wedge(150 * degree).lambda[1], 0.7309007, 1e-6);
  EXPECT_THROW(wedge(80 * degree), Error);
}

// Sides are free, the scale is that of the bisector, and displacements have the strains of their stresses.
TEST(Wedge, Fields) {
  const Material material = plane_strain(3, 0.3);
  const Wedge w = wedge(130 * degree, 20);
  for (const int mode : {0, 1})
    for (const bool dual : {false, true}) {
      const double r = 0.7, h = 1e-4;
      for (const double side : {-1., 1.}) {
        const PolarField f = wedge_field(mode, w, dual, material, r, side * w.half_angle);
        EXPECT_NEAR(f.tt, 0, 1e-8);
        EXPECT_NEAR(f.rt, 0, 1e-8);
      }
      const auto at = [&](double x, double theta) { return wedge_field(mode, w, dual, material, x, theta); };
      const PolarField f = at(r, 0.6);
      const double rr = (at(r + h, 0.6).u_r - at(r - h, 0.6).u_r) / (2 * h);
      const double tt = (at(r, 0.6 + h).u_t - at(r, 0.6 - h).u_t) / (2 * h * r) + f.u_r / r;
      const double rt = ((at(r, 0.6 + h).u_r - at(r, 0.6 - h).u_r) / (2 * h * r) +
                         (at(r + h, 0.6).u_t - at(r - h, 0.6).u_t) / (2 * h) - f.u_t / r) /
                        2;
      const double trace = f.rr + f.tt, mean = material.c * trace;
      EXPECT_NEAR(rr, (f.rr - trace / 2) / (2 * material.mu) + mean, 1e-6) << mode << dual;
      EXPECT_NEAR(tt, (f.tt - trace / 2) / (2 * material.mu) + mean, 1e-6) << mode << dual;
      EXPECT_NEAR(rt, f.rt / (2 * material.mu), 1e-6) << mode << dual;
      const double lambda = w.lambda[static_cast<std::size_t>(mode)];
      if (!dual) {
        const PolarField ahead = at(r, 0);
        EXPECT_NEAR(mode == 0 ? ahead.tt : ahead.rt, std::pow(2 * pi * r, lambda - 1), 1e-9);
      }
    }
}

}  // namespace
}  // namespace kerf::inspect::wedge_test
