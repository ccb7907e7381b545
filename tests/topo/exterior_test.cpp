// Integrals of stress powers around cuts against half their form where the power is an energy, against the circle's own
// formulas, against hand values and finer quadrature.

#include "topo/formulas/exterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::exterior_test {
namespace {

const std::vector<Mat2> stresses = {(Mat2() << 1.2, 0.4, 0.4, -0.3).finished(),
                                    (Mat2() << 0.2, 0.9, 0.9, 1.1).finished(),
                                    (Mat2() << -1, 0.05, 0.05, 0.1).finished(), Mat2::Identity()};
double mean(const Mat2& s) {
  return 0.5 * s.trace();
}

// With a share of 12 mu c the square is 6 mu times the energy density, whose integral under dead loads has T =
// 1/2 form: the adjoint has no stress, and all of T is local.
TEST(Exterior, TheEnergyOfEveryCutIsHalfItsForm) {
  for (const Material& m : {plane_strain(1, 0.3), plane_stress(2, 0.45), plane_strain(1, 0.499)}) {
    const VonMises law{12 * m.mu * m.c};
    for (const double aspect : {1., 2., 10., 100.}) {
      const CutTable table = tabulate(law, 2, {CutShape::Kind::Ellipse, aspect});
      for (const Mat2& s : stresses)
        for (const double angle : {0., 0.7, 2.5}) {
          const double local = power(law, 2, s) + exterior(table, s, angle),
                       half = 0.5 * ellipse_form(m, aspect, angle, s, s);
          EXPECT_NEAR(local / (6 * m.mu * half), 1, 3e-5) << aspect << ' ' << angle;
        }
    }
    const CutTable open = tabulate(law, 2, {CutShape::Kind::Open}), closed = tabulate(law, 2, {CutShape::Kind::Closed});
    for (const Mat2& s : stresses)
      for (const double angle : {0., 0.7, 2.5}) {
        const Vec2 n(-std::sin(angle), std::cos(angle));
        const CutTable& table = n.dot(s * n) > 0 ? open : closed;
        EXPECT_NEAR(exterior(table, s, angle), 6 * m.mu * 0.5 * crack_form(m, angle, s, s),
                    6 * m.mu * 1e-6 * s.squaredNorm())
            << angle;
      }
  }
}

// An ellipse of aspect 1 is the circle, whose table has other formulas.
TEST(Exterior, OfACircleIsTheOneInPowersOfTheRadius) {
  for (const double p : {2., 3., 7.3})
    for (const double share : {1., 0.16}) {
      const PowerTable circle = tabulate({share}, p);
      const CutTable cut = tabulate({share}, p, {CutShape::Kind::Ellipse, 1});
      for (const Mat2& s : stresses)
        EXPECT_NEAR(exterior(cut, s, 0.7) / exterior(circle, s), 1, p > 5 ? 3e-4 : 3e-5) << p << ' ' << share;
    }
}

// Pressure alone is no stress of an incompressible body; around a hole it is one all the same: 3 p^2 in the mean of the
// square, by hand, and 3 p^4 of the fourth power.
TEST(Exterior, OfAPressureInAnIncompressibleBody) {
  const Mat2 pressure = -1.3 * Mat2::Identity();
  for (const double p : {2., 4.}) {
    const CutTable table = tabulate({0}, p, {CutShape::Kind::Ellipse, 1});
    EXPECT_NEAR(exterior(table, pressure, 0.4) / (3 * std::pow(1.3, p)), 1, 3e-5) << p;
    EXPECT_EQ(exterior(table, Mat2::Zero(), 0.4), 0);
  }
}

// Against twice as many points, and between the nodes of the tables.
TEST(Exterior, QuadratureAndTablesAreFineEnough) {
  struct Case {
    double share, p;
    CutShape cut;
  };
  for (const auto& [share, p, cut] :
       {Case{1, 3, {CutShape::Kind::Ellipse, 3}}, Case{0.16, 8, {CutShape::Kind::Ellipse, 10}},
        Case{0.16, 3, {CutShape::Kind::Open}}, Case{1, 2.5, {CutShape::Kind::Closed}},
        Case{1, 3.9, {CutShape::Kind::Open}}}) {
    const CutTable table = tabulate({share}, p, cut);
    const Exterior fine({share}, p, cut, 2);
    for (const Mat2& s : stresses) {
      const double exact = fine(mean(s), 0.5 * (s(0, 0) - s(1, 1)), s(0, 1));
      const double size = cut.kind == CutShape::Kind::Ellipse ? exact : std::pow(s.norm(), p);
      ASSERT_TRUE(std::isfinite(exact));
      EXPECT_LT(std::abs(exterior(table, s, 0) - exact), (p > 5 ? 3e-4 : 3e-5) * size)
          << share << ' ' << p << ' ' << cut.aspect;
    }
  }
}

TEST(Exterior, RefusesPowersThatTipsCannotIntegrate) {
  EXPECT_THROW(tabulate({1}, 4, {CutShape::Kind::Open}), Error);
  EXPECT_THROW(tabulate({1}, 5, {CutShape::Kind::Closed}), Error);
  EXPECT_NO_THROW(tabulate({1}, 5, {CutShape::Kind::Ellipse, 2}));
}

}  // namespace
}  // namespace kerf::exterior_test
