// The error indicator against the error of exact fields, and recovered displacements against exact ones, against their
// definition, and at the faces of cracks.

#include "kerf/recover.hpp"
#include "base/polynomial.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include "kerf/adaptive.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::recover_test {
namespace {

Scene held(const exact::ExactField& f, bool crack) {
  Scene s;
  s.material = f.material;
  s.body = f.body;
  s.laws.resize(crack ? 1 : 0);
  for (Index label = 0; label < 4; ++label)
    s.supports.push_back({label, false, true, true,
                          [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
  return s;
}

// [theory: R.4, R.6]: efficiency index 4.6 to 6.0 for this element on smooth problems; at tips eta has what the
// estimate adds there.
TEST(Indicator, FollowsTheErrorWithTheMeasuredEfficiencyIndex) {
  for (const double nu : {0.3, 0.4999}) {
    const auto f = exact::wave_field(nu);
    for (const int n : {8, 16, 32}) {
      const Model m = prepare(exact::unit_square_mesh(n), element("bdms"), held(f, false), 2);
      const State s = solve(m);
      const double index = error_indicator(m, s).eta.norm() / exact::stress_error(m, s, f);
      EXPECT_GT(index, 3.5) << nu << ' ' << n;
      EXPECT_LT(index, 6.5) << nu << ' ' << n;
    }
  }
  for (const std::string name : {"I", "II", "III"}) {
    const auto f = exact::crack_case(name);
    const Model m = prepare(exact::crack_mesh(32), element("bdms"), held(f, true), 2);
    const State s = solve(m);
    const Indicator indicator = error_indicator(m, s);
    const double index = indicator.eta.norm() / exact::stress_error(m, s, f);
    EXPECT_GT(index, 4) << name;
    EXPECT_LT(index, 12) << name;
    // Largest in the triangles at a tip.
    Eigen::Index worst = 0;
    indicator.eta.maxCoeff(&worst);
    const Vec2 x = centroid(m.mesh, static_cast<Index>(worst));
    EXPECT_LT(std::min((x - Vec2(1, 0)).norm(), (x - Vec2(-1, 0)).norm()), 0.2) << name;
  }
}

TEST(Indicator, VanishesForConstantStress) {
  const Material material = plane_strain(1, 0.3);
  const Mat2 stress = (Mat2() << 1, 0.5, 0.5, -0.3).finished();
  exact::ExactField f;
  f.material = material;
  f.stress = [=](const Vec2&, int) { return stress; };
  f.displacement = [=](const Vec2& x, int) { return Vec2(strain(material, stress) * x); };
  const Model m = prepare(exact::unit_square_mesh(6, 0.3), element("bdms"), held(f, false), 1);
  const Indicator indicator = error_indicator(m, solve(m));
  EXPECT_LT(indicator.eta.maxCoeff(), 1e-11);
  EXPECT_LT(indicator.relative, 1e-11);
}

TEST(Indicator, DoesNotSeeTheJumpOfAnOpenOrSlidingCrack) {
  // Slip on a closed crack: the tangential jump of D is right there, only the normal part counts.
  const auto f = exact::crack_case("II");
  const Model m = prepare(exact::crack_mesh(32), element("bdms"), held(f, true), 1);
  const Indicator indicator = error_indicator(m, solve(m));
  double on_crack = 0, total = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const double square = indicator.eta[t] * indicator.eta[t];
    total += square;
    const Vec2 x = centroid(m.mesh, t);
    if (std::abs(x.y()) < 0.1 && std::abs(x.x()) < 0.7) on_crack += square;
  }
  EXPECT_LT(on_crack, 0.05 * total);
}

// Post-processed displacement: P2 fields are reproduced, and its gradient is the projected A s + Gamma(omega).
TEST(Recover, DisplacementConvergesOneOrderFasterThanTheElementsOwn) {
  const auto f = exact::exp_field(0.4);
  std::vector<double> own, better;
  for (const int n : {8, 16, 32}) {
    const Model m = prepare(exact::unit_square_mesh(n, 0.2), element("bdms"), held(f, false), 1);
    const State s = solve(m);
    double a = 0, b = 0;
    for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
      a += exact::integrate(triangle(m, t).x, -1, [&](const Vec2& x) {
        return (evaluate(m, s, t, x).displacement.col(0) - f.displacement(x, 0)).squaredNorm();
      });
      b += exact::integrate(triangle(m, t).x, -1, [&](const Vec2& x) {
        return (recovered_displacement(m, s, t, x).col(0) - f.displacement(x, 0)).squaredNorm();
      });
    }
    own.push_back(std::sqrt(a));
    better.push_back(std::sqrt(b));
  }
  EXPECT_NEAR(std::log2(own[1] / own[2]), 1, 0.1);
  EXPECT_GT(std::log2(better[1] / better[2]), 1.9);
}

TEST(Recover, CornerValuesAreContinuousButForTheCrack) {
  const auto f = exact::crack_case("I");
  const Model m = prepare(exact::crack_mesh(32), element("bdms"), held(f, true), 2);
  const State s = solve(m);
  const Corners corners = split_at_cracks(m.mesh);
  const CornerValues v = corner_values(m, s, corners);
  EXPECT_EQ(v.displacement.cols(), static_cast<Eigen::Index>(corners.vertex.size()));
  EXPECT_EQ(corners.vertex.size(), m.mesh.points.size() + m.mesh.cracks[0].size() - 1);
  // The two values at the middle of the crack differ by the exact opening.
  std::vector<double> at_middle;
  for (std::size_t i = 0; i < corners.vertex.size(); ++i)
    if (m.mesh.points[corners.vertex[i]].norm() < 1e-12)
      at_middle.push_back(v.displacement(1, static_cast<Eigen::Index>(i)));
  ASSERT_EQ(at_middle.size(), 2u);
  EXPECT_NEAR(std::abs(at_middle[0] - at_middle[1]) / f.opening(0), 1, 0.02);
}

TEST(Recover, BiactivePointsAreFoundWhenNothingPressesOrPulls) {
  // Tension along the crack: no gap, no pressure.
  const Material material = plane_stress(1, 0);
  const Mat2 stress = (Mat2() << 1, 0, 0, 0).finished();
  exact::ExactField f;
  f.material = material;
  f.stress = [=](const Vec2&, int) { return stress; };
  f.displacement = [=](const Vec2& x, int) { return Vec2(strain(material, stress) * x); };
  const Model m = prepare(exact::crack_mesh(8, 0, 0.2), element("bdms"), held(f, true), 1);
  for (const CrackPoint& p : crack_profile(m, solve(m), 0)) EXPECT_EQ(p.status, CrackPoint::Status::Biactive);
}

TEST(Recover, BondedCrackCarriesTheTractionOfTheBody) {
  const Material material = plane_strain(1, 0.3);
  const Mat2 stress = (Mat2() << 0.2, 0.7, 0.7, 1.1).finished();
  for (const double angle : {0.0, 0.6}) {
    exact::ExactField f;
    f.material = material;
    f.stress = [=](const Vec2&, int) { return stress; };
    f.displacement = [=](const Vec2& x, int) { return Vec2(strain(material, stress) * x); };
    Scene scene = held(f, true);
    scene.laws[0].kind = CrackLaw::Kind::Bonded;
    const Model m = prepare(exact::crack_mesh(8, angle), element("bdms"), scene, 1);
    const Vec2 t(std::cos(angle), std::sin(angle)), n(-t.y(), t.x());
    for (const CrackPoint& p : crack_profile(m, solve(m), 0)) {
      EXPECT_NEAR(p.sigma_n, n.dot(stress * n), 1e-11);
      EXPECT_NEAR(p.sigma_t, t.dot(stress * n), 1e-11);
      EXPECT_EQ(p.jump_n, 0);
      EXPECT_EQ(p.jump_t, 0);
    }
  }
}

/// u* from its definition: among the polynomials of degree D with the mean of the displacement the one whose gradient
/// is closest to that of the strains.
Points defined(const Model& m, const Field& s, Index t, const Points& x) {
  const int degree = m.element.stress + 1, n = dim(degree);
  const Triangle shape = triangle(m, t);
  const Vec2 center = centroid(shape);
  const double h = std::sqrt(2 * area(shape));
  const auto at = [&](const Points& p) -> Eigen::MatrixXd {
    return monomials(degree, (p.colwise() - center) / h).bottomRows(n - 1);
  };
  const TriangleRule rule = triangle_rule(8);
  const Points q = rule_points(rule, shape);
  const Eigen::MatrixXd v = at(q);
  const Fields f = evaluate(m, s, t, q);
  Eigen::MatrixXd rows(2 * q.cols(), n - 1), right(2 * q.cols(), 2);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n - 1);
  Vec2 moved = Vec2::Zero();
  const Eigen::MatrixXd d[2] = {derivative(degree, 0), derivative(degree, 1)};
  const Eigen::MatrixXd all = monomials(degree, (q.colwise() - center) / h);
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    const double root = std::sqrt(rule.w[i]);
    const Eigen::Vector4d g = displacement_gradient(material_of(m.mesh, m.scene, t), f.stress.col(i), f.rotation[i]);
    for (int axis = 0; axis < 2; ++axis) {
      rows.row(2 * i + axis) = root / h * (d[axis].transpose() * all.col(i)).transpose().tail(n - 1);
      right.row(2 * i + axis) << root * g[axis], root * g[2 + axis];
    }
    mean += rule.w[i] * v.col(i);
    moved += rule.w[i] * f.displacement.col(i);
  }
  const Eigen::MatrixXd c = rows.colPivHouseholderQr().solve(right);
  Points u = c.transpose() * (at(x).colwise() - mean);
  return u.colwise() + moved;
}

TEST(Recover, DisplacementIsTheOneOfItsDefinitionAndWeighingIsItsTranspose) {
  const auto f = exact::wave_field(0.3);
  for (const Element& e : {element("bdms", 1), element("bdms", 2), element("bdms", 3), element("peers"),
                           element("afw", 1), element("afw", 2), element("arnold-winther")}) {
    const Model m = prepare(exact::unit_square_mesh(3, 0.3), e, held(f, false), 1);
    const State s = solve(m);
    for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
      const Points x = rule_points(triangle_rule(4), triangle(m, t));
      const Points u = recovered_displacement(m, s, t, x);
      EXPECT_LT((u - defined(m, s, t, x)).norm(), 1e-11 * u.norm()) << e.name << e.degree << ' ' << t;
      const Points weights = (7 * x).array().sin();
      const double by_weights = weigh_recovered(m, t, x, weights).dot(s.interior.col(t));
      EXPECT_NEAR(by_weights, weights.cwiseProduct(u).sum(), 1e-11 * u.norm() * weights.norm()) << e.name << e.degree;
    }
  }
}

}  // namespace
}  // namespace kerf::recover_test
