// The BDMS family at degrees 1 to 4.

#include "kerf/adaptive.hpp"
#include "kerf/recover.hpp"
#include "solver/system.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <cmath>

namespace kerf::degree_test {
namespace {

Scene scene_of(const exact::ExactField& f, bool crack) {
  Scene s;
  s.material = f.material;
  s.body = f.body;
  s.laws.resize(crack ? 1 : 0);
  for (const Index label : {0, 3})
    s.supports.push_back({label, false, true, true,
                          [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
  for (const Index label : {1, 2})
    s.tractions.push_back(
        {label, [f](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, exact::side_of(f, x)) * n); }});
  return s;
}

class Degree : public testing::TestWithParam<int> {};

TEST_P(Degree, SpanHasItsDimensionAndTheCondensedMatrixThreeZeroModes) {
  const Element& e = element("bdms", GetParam());
  const Kernel k = kernel(e);
  Triangle t;
  t.x = {Vec2(0, 0), Vec2(2, 0.3), Vec2(0.4, 1.5)};
  t.forward = {true, false, true};
  for (Mat2& f : t.frame) f.setIdentity();
  const Points x = rule_points(triangle_rule(12), t);
  const int n = stress_count(e);
  Eigen::MatrixXd values(4 * x.cols(), n);
  for (int i = 0; i < n; ++i) {
    const Fields f = evaluate(k, t, Eigen::VectorXd::Unit(interior_count(e), i), x);
    values.col(i) = Eigen::Map<const Eigen::VectorXd>(f.stress.data(), f.stress.size());
  }
  EXPECT_EQ(Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(values).rank(), n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum{
      Eigen::MatrixXd(condense(k, t, plane_strain(1, 0.3), {}).K)};
  const double largest = spectrum.eigenvalues().maxCoeff();
  EXPECT_LT(std::abs(spectrum.eigenvalues()[2]), 1e-12 * largest);
  EXPECT_GT(spectrum.eigenvalues()[3], 1e-4 * largest);
}

TEST_P(Degree, StressAndRecoveredDisplacementConvergeAtTheOrderOfTheDegree) {
  const int k = GetParam();
  for (const double nu : {0.3, 0.499999}) {
    const auto f = exact::wave_field(nu);
    std::vector<double> stress, displacement;
    for (const int n : {4, 8, 16}) {
      const Model m = prepare(exact::unit_square_mesh(n), element("bdms", k), scene_of(f, false), 2);
      const State s = solve(m);
      EXPECT_LT(s.certificate.kkt, 1e-10);
      stress.push_back(exact::stress_error(m, s, f));
      double square = 0;
      for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t)
        square += exact::integrate(triangle(m, t).x, -1, [&](const Vec2& x) {
          return (recovered_displacement(m, s, t, x).col(0) - f.displacement(x, 0)).squaredNorm();
        });
      displacement.push_back(std::sqrt(square));
    }
    EXPECT_NEAR(std::log2(stress[1] / stress[2]), k + 1, 0.15) << nu;
    EXPECT_GT(std::log2(displacement[1] / displacement[2]), k + 0.8) << nu;
  }
}

TEST_P(Degree, ReproducesStressesOfItsDegree) {
  // A divergence-free quadratic stress with compatible strains: the second derivatives of x^4 - 6 x^2 y^2 + y^4
  // (biharmonic) for k >= 2, of x^3 - 3 x y^2 (linear stress) for k = 1.
  const int k = GetParam();
  const Material material = plane_strain(1, 0.3);
  exact::ExactField f;
  f.material = material;
  // Harmonic Airy function: tr s = 0, so that u = -grad(phi)/(2 mu).
  f.stress = [k](const Vec2& x, int) {
    const double a = x.x(), b = x.y();
    Mat2 s;
    if (k == 1)
      s << -6 * a, 6 * b, 6 * b, 6 * a;
    else
      s << -12 * a * a + 12 * b * b, 24 * a * b, 24 * a * b, 12 * a * a - 12 * b * b;
    return s;
  };
  f.displacement = [k, mu = material.mu](const Vec2& x, int) {
    const double a = x.x(), b = x.y();
    const Vec2 gradient = k == 1 ? Vec2(3 * a * a - 3 * b * b, -6 * a * b)
                                 : Vec2(4 * a * a * a - 12 * a * b * b, -12 * a * a * b + 4 * b * b * b);
    return Vec2(-gradient / (2 * mu));
  };
  const Model m = prepare(exact::unit_square_mesh(4, 0.3), element("bdms", k), scene_of(f, false), 1);
  const State s = solve(m);
  if (k >= 2) {
    EXPECT_LT(exact::stress_error(m, s, f), 1e-10);
  }
  EXPECT_LT(exact::stress_error(m, s, f), 0.2);
}

TEST_P(Degree, ContactIsRightOnThePartlyClosedCrack) {
  const auto f = exact::crack_case("III");
  const Model m = prepare(exact::crack_mesh(16), element("bdms", GetParam()), scene_of(f, true), 2);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  EXPECT_LT(s.certificate.kkt, 1e-10);
  const double h = 4.0 / 16;
  const auto profile = crack_profile(m, s, 0);
  EXPECT_EQ(profile.size(), m.mesh.cracks[0].size() * static_cast<std::size_t>(GetParam() + 1));
  for (const CrackPoint& p : profile) {
    if (std::abs(p.s - 1 + 1.0 / 3) > h) {
      EXPECT_EQ(p.status != CrackPoint::Status::Closed, exact::is_open(f, p.s - 1)) << p.s;
    }
  }
  // The tip limits every degree on this mesh: higher ones are better by a factor, not an order.
  EXPECT_LT(exact::stress_error(m, s, f), 0.19);
  EXPECT_GT(error_indicator(m, s).relative, 0);
}

INSTANTIATE_TEST_SUITE_P(Bdms, Degree, testing::Values(1, 2, 3, 4));

}  // namespace
}  // namespace kerf::degree_test
