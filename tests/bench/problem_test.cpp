// The problems are those of the peers' scripts: their fields and errors against numbers that FreeFem++ printed.

#include "bench/measure/problem.hpp"

#include "tests/support/integral.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::problem_test {
namespace {

/// s1.edp, E = 1.
TEST(Problem, SmoothHasTheSolutionOfThePeers) {
  for (const double nu : {0.3, 0.4999, 0.499999}) {
    const BenchProblem p = problem("smooth", nu);
    const double mu = 1 / (2 * (1 + nu)), lambda = nu / ((1 + nu) * (1 - 2 * nu)), c = 1 / (1 + lambda);
    for (const Vec2& at : {Vec2(0.3, 0.8), Vec2(0.71, 0.12)}) {
      const double x = at.x(), y = at.y();
      const Vec2 u(std::sin(2 * pi * y) * (std::cos(2 * pi * x) - 1) + c * std::sin(pi * x) * std::sin(pi * y),
                   std::sin(2 * pi * x) * (1 - std::cos(2 * pi * y)) + c * std::sin(pi * x) * std::sin(pi * y));
      EXPECT_LT((p.exact->displacement(at, 0) - u).norm(), 1e-12);
      const double divergence = c * pi * std::sin(pi * (x + y));
      const double u1x =
          -2 * pi * std::sin(2 * pi * y) * std::sin(2 * pi * x) + c * pi * std::cos(pi * x) * std::sin(pi * y);
      const double s11 = 2 * mu * u1x + lambda * divergence;
      EXPECT_NEAR(p.exact->stress(at, 0)(0, 0) * mu, s11, 1e-9);  // the field has mu = 1
      const double lap1 = -4 * pi * pi * std::sin(2 * pi * y) * (2 * std::cos(2 * pi * x) - 1) -
                          2 * pi * pi * c * std::sin(pi * x) * std::sin(pi * y);
      const double f1 = -(mu * lap1 + (lambda + mu) * c * pi * pi * std::cos(pi * (x + y)));
      EXPECT_NEAR(p.scene.body(at).x() * mu, f1, 1e-8);
    }
  }
}

/// s3.edp and s4.edp: Westergaard functions z/sqrt(z^2 - 1) and (z' - L/2) sqrt(z' + L)/sqrt(z' - L), z' = z - 1/3.
TEST(Problem, CracksHaveTheSolutionsOfThePeers) {
  const Vec2 ahead(1.7, 0);  // there s11 = s22 = Z
  const double z = ahead.x() - 1.0 / 3, L = 2.0 / 3;
  EXPECT_NEAR(problem("open-crack", 0.3).exact->stress(ahead, 0)(1, 1), 1.7 / std::sqrt(1.7 * 1.7 - 1), 1e-12);
  EXPECT_NEAR(problem("open-crack", 0.3).exact->stress(ahead, 0)(0, 0), 1.7 / std::sqrt(1.7 * 1.7 - 1), 1e-12);
  const Mat2 s = problem("closing-crack", 0.3).exact->stress(ahead, 0);
  EXPECT_NEAR(s(1, 1), (z - L / 2) * std::sqrt((z + L) / (z - L)), 1e-12);
  EXPECT_NEAR(s(0, 0), s(1, 1), 1e-12);
}

TEST(Problem, CookHasTheKnownEnergy) {
  BenchProblem p = problem("cook-stress", 1.0 / 3);
  const Reference r = overkill(p, 5);
  EXPECT_NEAR(r.strain_energy / 12.02080309, 1, 1e-8);  // measured: 3e-10
  EXPECT_NEAR(r.weight.sum(), 0.5 * 48 * (44 + 16), 1e-6);
  EXPECT_LT(r.error, 3e-4);
}

TEST(Problem, ErrorsFallWithTheOrderOfTheElement) {
  const BenchProblem p = problem("smooth", 0.4999);
  const auto error = [&](int degree, double level) {
    const Model m = prepare(bench_mesh(p, Grading::Uniform, degree, level), element("bdms", degree), p.scene, 1);
    return errors(p, m, solve(m)).stress;
  };
  EXPECT_NEAR(std::log2(error(1, 3) / error(1, 7)) / 2, 2, 0.25);
  EXPECT_NEAR(std::log2(error(2, 1) / error(2, 5)) / 2, 3, 0.3);
}

TEST(Problem, GradingBeatsUniformMeshesAtTheTip) {
  const BenchProblem p = problem("open-crack", 0.3);
  const auto error = [&](Grading grading) {
    const Model m = prepare(bench_mesh(p, grading, 2, 2), element("bdms", 2), p.scene, 1);
    return errors(p, m, solve(m));
  };
  const Errors uniform = error(Grading::Uniform), graded = error(Grading::Graded);
  EXPECT_GT(uniform.stress, 0.03);
  EXPECT_LT(graded.stress, 0.003);
  EXPECT_LT(graded.displacement, 1e-3);
}

TEST(Problem, UnknownNamesAreRefused) {
  EXPECT_THROW(problem("cook", 0.3), std::invalid_argument);
}

TEST(Cubature, WeightsSumToTheAreaAndSeeTheTip) {
  const exact::Triangle t{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
  EXPECT_NEAR(exact::cubature(t, -1).w.sum(), 0.5, 1e-15);
  EXPECT_NEAR(exact::cubature(t, 1).w.sum(), 0.5, 1e-15);
  EXPECT_EQ(exact::cubature(t, -1, 6).w.size(), 36);
  // int r^-1 over the triangle about its right angle: sqrt(2) asinh(1).
  EXPECT_NEAR(exact::integrate(t, 0, [](const Vec2& x) { return 1 / x.norm(); }), std::sqrt(2) * std::asinh(1), 1e-9);
}

}  // namespace
}  // namespace kerf::problem_test
