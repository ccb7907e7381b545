// The element on one random triangle: rigid motions, linear fields and balance exactly; the condensation against the
// saddle-point system, rules of quadrature against integrals of monomials.

#include "solver/element/local.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <random>

namespace kerf::local_test {
namespace {

Mat2 frame_along(const Vec2& normal) {
  Mat2 f;
  f << normal, Vec2(-normal.y(), normal.x());
  return f;
}

// A triangle of arbitrary shape, size and place; frames turned arbitrarily, edge directions at random.
Triangle random_triangle(std::mt19937& random) {
  std::uniform_real_distribution<double> in(-1, 1);
  Triangle t;
  const double size = std::exp(3 * in(random));
  do {
    for (Vec2& x : t.x) x = Vec2(10, -3) + size * Vec2(in(random), in(random));
  } while (area(t) < 0.1 * size * size);
  for (int e = 0; e < 3; ++e) {
    const double angle = 3 * in(random);
    t.frame[e] = frame_along(Vec2(std::cos(angle), std::sin(angle)));
    t.forward[e] = in(random) > 0;
  }
  return t;
}

SkeletonVector trace_of(const Kernel& k, const Triangle& t, const std::function<Vec2(const Vec2&)>& u) {
  SkeletonVector m(3 * per_edge(k.element));
  for (int e = 0; e < 3; ++e)
    for (int g = 0; g < points_per_edge(k.element); ++g)
      m.segment<2>(per_edge(k.element) * e + 2 * g) = t.frame[e].transpose() * u(trace_point(k, t, e, g));
  return m;
}

class Local : public testing::TestWithParam<double> {};

TEST_P(Local, CondensedMatrixIsSymmetricAndItsKernelIsTheRigidMotions) {
  const Kernel k = kernel(element("bdms"));
  const Material material = plane_strain(3, GetParam());
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Triangle t = random_triangle(random);
    const Condensed c = condense(k, t, material, {});
    const double scale = c.K.cwiseAbs().maxCoeff();
    EXPECT_LT((c.K - c.K.transpose()).cwiseAbs().maxCoeff(), 1e-13 * scale);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum{Eigen::MatrixXd(c.K)};
    EXPECT_GT(spectrum.eigenvalues()[0], -1e-12 * scale);
    EXPECT_LT(spectrum.eigenvalues()[2], 1e-12 * scale);
    EXPECT_GT(spectrum.eigenvalues()[3], 1e-4 * material.mu) << "only three zero modes";
    const Vec2 center = centroid(t);
    for (int motion = 0; motion < 3; ++motion) {
      const auto u = [&](const Vec2& x) {
        return motion == 0 ? Vec2(1, 0) : motion == 1 ? Vec2(0, 1) : Vec2(-(x - center).y(), (x - center).x());
      };
      const SkeletonVector m = trace_of(k, t, u);
      EXPECT_LT((c.K * m).cwiseAbs().maxCoeff(), 1e-12 * scale * m.cwiseAbs().maxCoeff());
    }
  }
}

TEST_P(Local, LinearDisplacementGivesItsConstantStressRotationAndMean) {
  const Kernel k = kernel(element("bdms"));
  const Material material = plane_strain(2, GetParam());
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Triangle t = random_triangle(random);
    Mat2 stress;
    stress << 1.3, -0.4, -0.4, 0.7;
    const double omega = 0.25;
    Mat2 gradient = strain(material, stress);
    gradient(0, 1) += omega;
    gradient(1, 0) -= omega;
    const auto u = [&](const Vec2& x) { return Vec2(gradient * (x - Vec2(10, -3)) + Vec2(0.1, 0.2)); };
    const Eigen::VectorXd inside = interior(k, t, material, {}, trace_of(k, t, u));
    Points x(2, 2);
    x << centroid(t), 0.5 * t.x[0] + 0.3 * t.x[1] + 0.2 * t.x[2];
    const Fields f = evaluate(k, t, inside, x);
    const double tolerance = 1e-11 / (1 - 1.99 * GetParam());  // digits lost near nu = 1/2
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(f.stress(0, i), 1.3, tolerance);
      EXPECT_NEAR(f.stress(1, i), -0.4, tolerance);
      EXPECT_NEAR(f.stress(2, i), -0.4, tolerance);
      EXPECT_NEAR(f.stress(3, i), 0.7, tolerance);
      EXPECT_NEAR(f.rotation[i], omega, tolerance);
      EXPECT_NEAR((f.displacement.col(i) - u(centroid(t))).norm(), 0, tolerance * (1 + u(centroid(t)).norm()));
    }
  }
}

TEST_P(Local, TractionsAreTheMomentsOfTheStressAndBalanceTheForce) {
  const Kernel k = kernel(element("bdms"));
  const Material material = plane_stress(1, GetParam());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-1, 1);
  for (int trial = 0; trial < 10; ++trial) {
    Triangle t = random_triangle(random);
    for (Mat2& f : t.frame) f.setIdentity();
    SkeletonVector m(12);
    for (int i = 0; i < 12; ++i) m[i] = in(random);
    const ForceMoments force = force_moments(k, t, Vec2(2, -1).replicate(1, k.load.w.size()));
    const Condensed c = condense(k, t, material, force);
    const SkeletonVector moments = c.K * m - c.F;
    const Eigen::VectorXd inside = interior(k, t, material, force, m);
    Vec2 total = Vec2::Zero();
    const double scale = moments.cwiseAbs().maxCoeff();
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = t.x[(e + 2) % 3] - t.x[(e + 1) % 3], n(side.y(), -side.x());
      for (int g = 0; g < 2; ++g) {
        const Eigen::Vector4d s = stress_at(k, t, inside, trace_point(k, t, e, g));
        const Vec2 traction(s[0] * n.x() + s[1] * n.y(), s[2] * n.x() + s[3] * n.y());
        EXPECT_LT((0.5 * traction - moments.segment<2>(4 * e + 2 * g)).norm(), 1e-11 * scale);
        total += moments.segment<2>(4 * e + 2 * g);
      }
    }
    EXPECT_LT((total + area(t) * Vec2(2, -1)).norm(), 1e-11 * scale);
  }
}

// The condensation against the saddle-point system itself, built from the evaluated basis and solved by full pivoting.
TEST_P(Local, EliminationAgreesWithTheSaddlePointSystem) {
  const Kernel k = kernel(element("bdms"));
  const Material material = plane_strain(1, GetParam());
  std::mt19937 random(4);
  const Triangle t = random_triangle(random);
  const int s = stress_count(k.element), u = displacement_count(k.element), r = rotation_count(k.element),
            n = s + u + r;
  const TriangleRule rule = triangle_rule(6);
  const Points x = rule_points(rule, t);
  std::vector<Fields> basis;
  for (int i = 0; i < n; ++i) basis.push_back(evaluate(k, t, Eigen::VectorXd::Unit(n, i), x));
  Eigen::MatrixXd saddle = Eigen::MatrixXd::Zero(n, n), moments = Eigen::MatrixXd::Zero(n, 12);
  const auto divergence = [&](int i) {  // constant: by the divergence theorem
    Vec2 sum = Vec2::Zero();
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = t.x[(e + 2) % 3] - t.x[(e + 1) % 3], normal(side.y(), -side.x());
      for (int g = 0; g < 2; ++g) {
        const Eigen::Vector4d v = stress_at(k, t, Eigen::VectorXd::Unit(n, i), trace_point(k, t, e, g));
        sum += 0.5 * Vec2(v[0] * normal.x() + v[1] * normal.y(), v[2] * normal.x() + v[3] * normal.y());
        for (int d = 0; d < 2; ++d)
          moments(i, 4 * e + 2 * g + d) += 0.5 * t.frame[e].col(d).dot(Vec2(v[0] * normal.x() + v[1] * normal.y(),
                                                                            v[2] * normal.x() + v[3] * normal.y()));
      }
    }
    return sum;
  };
  for (int i = 0; i < s; ++i) {
    const Vec2 div = divergence(i);
    for (int j = 0; j < n; ++j)
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const double w = area(t) * rule.w[q];
        const Eigen::Vector4d a = basis[i].stress.col(q);
        if (j < s) {
          Mat2 tensor;
          tensor << basis[j].stress(0, q), basis[j].stress(1, q), basis[j].stress(2, q), basis[j].stress(3, q);
          const Mat2 e = strain(material, tensor);
          saddle(i, j) += w * (a[0] * e(0, 0) + a[1] * e(0, 1) + a[2] * e(1, 0) + a[3] * e(1, 1));
        } else {
          const double value =
              w * (basis[j].displacement.col(q).dot(div) / area(t) + basis[j].rotation[q] * (a[1] - a[2]));
          saddle(i, j) += value;
          saddle(j, i) += value;
        }
      }
  }
  const Eigen::VectorXd m = Eigen::VectorXd::LinSpaced(12, -1, 1);
  const Eigen::VectorXd expected = saddle.fullPivLu().solve(moments * m);
  const Eigen::VectorXd found = interior(k, t, material, {}, m);
  EXPECT_LT((found - expected).norm(), 1e-10 / (1 - 1.99 * GetParam()) * expected.norm());
  const Eigen::VectorXd tractions = moments.transpose() * expected;
  EXPECT_LT((condense(k, t, material, {}).K * m - tractions).norm(),
            1e-10 / (1 - 1.99 * GetParam()) * tractions.norm());
}

INSTANTIATE_TEST_SUITE_P(PoissonRatios, Local, testing::Values(0.0, 0.3, 0.49, 0.4999));

TEST(Quadrature, TriangleRulesIntegrateMonomialsExactly) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  for (int degree = 0; degree <= 14; ++degree) {
    const TriangleRule rule = triangle_rule(degree);
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) {
        double sum = 0;
        for (Eigen::Index q = 0; q < rule.w.size(); ++q)
          sum += rule.w[q] * std::pow(rule.x(0, q), i) * std::pow(rule.x(1, q), j);
        EXPECT_NEAR(sum, 2 * factorial(i) * factorial(j) / factorial(i + j + 2), 1e-14)
            << degree << ' ' << i << ' ' << j;
      }
  }
}

TEST(Quadrature, GaussRulesIntegrateMonomialsExactly) {
  for (int points = 1; points <= 12; ++points) {
    const EdgeRule rule = gauss(points);
    for (int k = 0; k < 2 * points; ++k) {
      double sum = 0;
      for (int q = 0; q < points; ++q) sum += rule.w[q] * std::pow(rule.s[q], k);
      EXPECT_NEAR(sum, 1.0 / (k + 1), 1e-14) << points << ' ' << k;
    }
  }
}

TEST(Elements, UnknownNameListsTheKnownOnes) {
  try {
    element("bdmz");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_NE(std::string(e.what()).find("\"bdms\""), std::string::npos);
  }
}

}  // namespace
}  // namespace kerf::local_test
