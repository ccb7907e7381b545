// A factor kept in single precision: the same state, to the same residual, in half the memory.

#include "solver/system/rounded.hpp"

#include "kerf/adaptive.hpp"
#include "kerf/mesher.hpp"
#include "solver/system.hpp"
#include "tests/solver/many_cracks.hpp"
#include "tests/solver/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::rounded_test {
namespace {

bool is_single(const Model& m) {
  return m.inner->factor->leading() != nullptr;
}

/// In single precision, and what it is compared with.
void expect_the_same_state(const Mesh& mesh, const Element& e, const Scene& scene, std::string_view which) {
  const Model exact = prepare(mesh, e, scene, 1), m = prepare(mesh, e, scene, 2, {.precision = Precision::Single});
  ASSERT_TRUE(is_single(m)) << which;
  EXPECT_FALSE(is_single(exact));
  const State one = solve(exact), other = solve(m);
  EXPECT_TRUE(certified(other)) << which << " " << other.certificate.kkt;
  EXPECT_LT(other.certificate.kkt, 10 * one.certificate.kkt + 1e-13) << which;
  EXPECT_LT((other.skeleton - one.skeleton).cwiseAbs().maxCoeff(), 1e-10 * one.skeleton.cwiseAbs().maxCoeff()) << which;
  EXPECT_LE((other.force - one.force).cwiseAbs().maxCoeff(), 1e-9 * one.force.cwiseAbs().maxCoeff()) << which;
  const auto effort = solver_effort(m);
  ASSERT_TRUE(effort) << which;
  EXPECT_EQ(effort->parts, 1);
  EXPECT_GE(effort->solves, 2);
  EXPECT_LE(effort->iterations, 12) << which;
}

TEST(Rounded, GivesTheStateOfManyCracksInContact) {
  const Shape shape = random_cracks(8, 3, 7);
  const Mesh mesh = triangulate(shape, {.size = 0.3, .crack_tip_size = 0.05});
  for (const CrackLaw& law : {CrackLaw{}, CrackLaw{.friction = 0.3}, CrackLaw{.kind = CrackLaw::Kind::Open}})
    expect_the_same_state(mesh, element("bdms"), pushed(8, law), std::to_string(law.friction));
  for (const Element& e : {element("bdms", 3), element("afw", 2), element("arnold-winther-nc")})
    expect_the_same_state(mesh, e, pushed(8, {}), title(e));
  expect_the_same_state(mesh, element("bdms"), pushed(8, {}, 0.499999), "nearly incompressible");
  expect_the_same_state(mesh, element("bdms"), pushed(8, {}, 0.5), "incompressible");
}

// The bits of a run do not depend on the number of threads.
TEST(Rounded, TheSameBitsForAnyNumberOfThreads) {
  const Shape shape = random_cracks(4, 2.5, 3);
  const Mesh mesh = triangulate(shape, {.size = 0.08, .crack_tip_size = 0.02});
  const Preparation single{.precision = Precision::Single};
  const State one = solve(prepare(mesh, element("bdms"), pushed(4, {}), 1, single)),
              two = solve(prepare(mesh, element("bdms"), pushed(4, {}), 2, single));
  EXPECT_EQ(one.skeleton, two.skeleton);
  EXPECT_EQ(one.interior, two.interior);
}

/// A strip of this length, one wide, held on its left and pulled down on its right.
struct Strip {
  Mesh mesh;
  Scene scene;
};
Strip strip(double length, double size) {
  Shape shape;
  shape.outline = polygon("outline", {{0, 0}, {length, 0}, {length, 1}, {0, 1}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports.push_back({3, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  s.tractions.push_back({1, [](const Vec2&, const Vec2&) -> Vec2 { return {0, -1e-3}; }});
  return {triangulate(shape, {.size = size}), s};
}

// Where single precision does not serve the factor is double, and a note says so.
TEST(Rounded, LeavesSlenderBodiesToDoublePrecision) {
  const Strip slender = strip(6000, 0.5);
  const Model m = prepare(slender.mesh, element("bdms"), slender.scene, 1, {.precision = Precision::Single});
  EXPECT_FALSE(is_single(m));
  EXPECT_EQ(std::ranges::count_if(m.notes, [](const std::string& n) { return n.find("double precision") != n.npos; }),
            1);
  const State s = solve(m), exact = solve(prepare(slender.mesh, element("bdms"), slender.scene, 1));
  EXPECT_EQ(s.skeleton, exact.skeleton);
  const Strip stout = strip(3, 0.2);
  EXPECT_TRUE(is_single(prepare(stout.mesh, element("bdms"), stout.scene, 1, {.precision = Precision::Single})));
}

/// Dense, with eigenvalues from 1 down to `least`, each the same share of the one before.
std::shared_ptr<LowerTriangle> dense(Index n, double least) {
  Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(n, n);
  for (int k = 1; k <= 3; ++k) {  // reflections
    Eigen::VectorXd v(n);
    for (Index i = 0; i < n; ++i) v[i] = std::sin(k * (i + 1.0) * (i + 2.0));
    Q -= 2 / v.squaredNorm() * (Q * v) * v.transpose();
  }
  const Eigen::VectorXd d = Eigen::ArrayXd::LinSpaced(n, 0, std::log(least)).exp();
  const Eigen::MatrixXd full = Q * d.asDiagonal() * Q.transpose();
  auto k = std::make_shared<LowerTriangle>(LowerTriangle{n, {0}, {}, {}});
  for (Index j = 0; j < n; ++j) {
    for (Index i = j; i < n; ++i) {
      k->rows.push_back(i);
      k->values.push_back(full(i, j));
    }
    k->start.push_back(static_cast<Index>(k->rows.size()));
  }
  return k;
}

// Far below what single precision tells from nothing, too: L is rounded, not K.
TEST(Rounded, SolvesWithTinyEigenvalues) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(60);
  for (const double least : {1e-3, 1e-10}) {
    const auto K = dense(60, least);
    const auto solver = rounded(K, 0, ones, 1);
    ASSERT_TRUE(solver) << least;
    const Eigen::VectorXd x = solver->solve(ones), exact = Factor(*K, 0).solve(ones);
    EXPECT_LT((x - exact).norm(), 1e-15 / least * exact.norm()) << least;
    EXPECT_EQ(solver->effort().solves, 1);
  }
  const auto lost = dense(60, 1e-3);
  lost->values[0] = -1;
  EXPECT_FALSE(rounded(lost, 0, ones, 1)) << "not definite";
}

// S and solves of the leading rows against those of the factor in double precision.
TEST(Rounded, SolvesTheLeadingRowsAndKnowsTheRest) {
  const Shape shape = random_cracks(8, 3, 7);
  const Model m = prepare(triangulate(shape, {.size = 0.3, .crack_tip_size = 0.05}), element("bdms"), pushed(8, {}), 1);
  const Index contact = m.inner->ordering.contact_rows;
  ASSERT_GT(contact, 20);
  const std::shared_ptr<const LowerTriangle> K = m.inner->system.K;
  const auto solver = rounded(K, contact, m.inner->system.F, 1);
  ASSERT_TRUE(solver);
  const Eigen::MatrixXd& known = m.inner->factor->contact_factor();
  EXPECT_LT((solver->contact_factor() - known).norm(), 1e-14 * known.norm());
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(K->size - contact, -1, 2);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(K->size);
  x.head(b.size()) = solver->solve(b);
  // As the other factor, which solves the same rows where those in contact are held by a very stiff spring.
  LowerTriangle held = *K;
  for (Index row = K->size - contact; row < K->size; ++row) held.values[held.start[row]] *= 1e12;
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(K->size);
  whole.head(b.size()) = b;
  const Eigen::VectorXd exact = Factor(held, contact).solve(whole);
  const auto rest = [&](const Eigen::VectorXd& of) { return (multiply(held, of).head(b.size()) - b).norm(); };
  EXPECT_LT(rest(x), 10 * rest(exact) + 1e-14 * b.norm());
  EXPECT_EQ(solver->solve(Eigen::VectorXd::Zero(b.size())), Eigen::VectorXd::Zero(b.size()));
}

}  // namespace
}  // namespace kerf::rounded_test
