#include "solver/contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <random>

namespace kerf {
namespace {

// The conditions of optimality themselves, whatever found the point.
void expect_optimal(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const Contact& c) {
  const double jump = std::max(c.jump.cwiseAbs().maxCoeff(), 1e-300), load = r.cwiseAbs().maxCoeff();
  EXPECT_TRUE(c.converged);
  EXPECT_GE(c.jump.minCoeff(), -1e-13 * jump);
  EXPECT_GE(c.force.minCoeff(), -1e-12 * load);
  EXPECT_LT((S * c.jump - r - c.force).cwiseAbs().maxCoeff(), 1e-11 * load);
  EXPECT_LT(std::abs(c.jump.dot(c.force)), 1e-11 * load * jump);
}

TEST(Contact, RandomProblemsSatisfyTheOptimalityConditions) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 40;
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    const Eigen::MatrixXd S = a * a.transpose() + 1e-3 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd r = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
    expect_optimal(S, r, solve_unilateral(S, r));
  }
}

TEST(Contact, ExchangesThatCycleGiveWayToProjectedNewton) {
  // Not an M-matrix: the primal-dual iteration alternates on some loads; the answer must still be optimal.
  int handed_over = 0;
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 12;
    Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    const Eigen::MatrixXd S = a * a.transpose() + 1e-2 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd r = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
    const Contact c = solve_unilateral(S, r);
    if (c.iterations > 11) ++handed_over;
    expect_optimal(S, r, c);
  }
  EXPECT_GT(handed_over, 0) << "the test has lost its point: no problem cycles any more";
}

TEST(Contact, AllOpenAllClosedAndNoLoad) {
  const Eigen::MatrixXd S = 2 * Eigen::MatrixXd::Identity(3, 3);
  const Contact open = solve_unilateral(S, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(open.closed, std::vector<bool>({false, false, false}));
  EXPECT_LT((open.jump - Eigen::Vector3d(0.5, 1, 1.5)).norm(), 1e-15);
  const Contact closed = solve_unilateral(S, Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(closed.closed, std::vector<bool>({true, true, true}));
  EXPECT_EQ(closed.jump.norm(), 0);
  EXPECT_LT((closed.force - Eigen::Vector3d(1, 2, 3)).norm(), 1e-15);
  const Contact idle = solve_unilateral(S, Eigen::Vector3d::Zero());
  EXPECT_EQ(idle.jump.norm() + idle.force.norm(), 0);
  EXPECT_EQ(solve_unilateral(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)).jump.size(), 0);
}

}  // namespace
}  // namespace kerf
