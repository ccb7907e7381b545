// The sparse Cholesky factor against dense factors and inverses; its last block is that of the Schur complement; losses
// of stiffness and signals.

#include "solver/factor.hpp"

#include "solver/system/generator.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <numeric>
#include <random>
#include <thread>

namespace kerf::factor_test {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

LowerTriangle lower_triangle(SparseMatrix a) {
  a.makeCompressed();
  const auto n = a.nonZeros();
  return {static_cast<Index>(a.cols()),
          {a.outerIndexPtr(), a.outerIndexPtr() + a.cols() + 1},
          {a.innerIndexPtr(), a.innerIndexPtr() + n},
          {a.valuePtr(), a.valuePtr() + n}};
}

// A grid Laplacian plus a diagonal, with some dense rows at the end.
SparseMatrix lower_grid(Index side, Index dense) {
  const Index n = side * side + dense;
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j) {
      const Index k = i * side + j;
      entries.emplace_back(k, k, 4.1);
      if (j + 1 < side) entries.emplace_back(k + 1, k, -1);
      if (i + 1 < side) entries.emplace_back(k + side, k, -1);
    }
  for (Index d = 0; d < dense; ++d) {
    const Index row = side * side + d;
    entries.emplace_back(row, row, 6 + d);
    for (Index k = d; k < side * side; k += 7) entries.emplace_back(row, k, 0.1);
  }
  SparseMatrix a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

TEST(Factor, OtherValuesInTheSamePattern) {
  const Index dense = 3;
  SparseMatrix lower = lower_grid(8, dense);
  Factor factor(lower_triangle(lower), dense);
  for (Index k = 0; k < static_cast<Index>(lower.cols()); ++k) lower.coeffRef(k, k) += 1 + k % 3;
  factor.refactor(lower_triangle(lower));
  const Factor fresh(lower_triangle(lower), dense);
  const Eigen::MatrixXd full = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(full.cols(), -1, 2);
  EXPECT_LT((full * factor.solve(b) - b).norm(), 1e-12);
  EXPECT_EQ(factor.contact_factor(), fresh.contact_factor());
  EXPECT_THROW(factor.refactor(lower_triangle(lower_grid(7, dense))), std::invalid_argument);
  lower.coeffRef(3, 3) = -1;
  EXPECT_THROW(factor.refactor(lower_triangle(lower)), Error);
}

TEST(Factor, TrailingBlockIsTheFactorOfTheSchurComplement) {
  const Index dense = 5;
  const SparseMatrix lower = lower_grid(9, dense);
  const Index n = static_cast<Index>(lower.cols()), m = n - dense;
  const Factor factor(lower_triangle(lower), dense);
  const Eigen::MatrixXd full = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd K = full.topLeftCorner(m, m), B = full.bottomLeftCorner(dense, m);
  const Eigen::MatrixXd schur = full.bottomRightCorner(dense, dense) - B * K.llt().solve(B.transpose());
  EXPECT_LT((factor.contact_complement() - schur).norm(), 1e-13 * schur.norm());

  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 2);
  EXPECT_LT((full * factor.solve(b) - b).norm(), 1e-12);
  EXPECT_LT((multiply(lower_triangle(lower), b) - full * b).norm(), 1e-13 * (full * b).norm());
  const Eigen::VectorXd y = factor.forward(b);
  const Eigen::VectorXd condensed = b.tail(dense) - B * K.llt().solve(b.head(m));
  const Eigen::VectorXd found = factor.contact_factor().triangularView<Eigen::Lower>() * y.tail(dense);
  EXPECT_LT((found - condensed).norm(), 1e-13);
}

TEST(Factor, NotPositiveDefiniteIsALossOfStiffness) {
  SparseMatrix a = lower_grid(4, 0);
  a.coeffRef(7, 7) = -1;
  try {
    Factor factor(lower_triangle(a), 0);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_NE(std::string(e.what()).find("eaten the stiffness"), std::string::npos) << e.what();
  }
}

struct Graph {
  std::vector<Index> start{0}, neighbors;
};

Graph grid(Index side) {
  Graph g;
  const Index n = side * side;
  for (Index k = 0; k < n; ++k) {
    if (k % side > 0) g.neighbors.push_back(k - 1);
    if (k % side + 1 < side) g.neighbors.push_back(k + 1);
    if (k >= side) g.neighbors.push_back(k - side);
    if (k + side < n) g.neighbors.push_back(k + side);
    g.start.push_back(static_cast<Index>(g.neighbors.size()));
  }
  return g;
}

TEST(Factor, DissectionIsAPermutationThatSavesFill) {
  const Index side = 40, n = side * side;
  const auto [start, neighbors] = grid(side);
  std::vector<Index> order = dissection(start, neighbors);
  std::vector<Index> place(n);
  for (Index k = 0; k < n; ++k) place[order[k]] = k;
  const SparseMatrix natural = lower_grid(side, 0);
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (Index j = 0; j < n; ++j)
    for (SparseMatrix::InnerIterator it(natural, j); it; ++it)
      entries.emplace_back(std::max(place[it.row()], place[j]), std::min(place[it.row()], place[j]), it.value());
  SparseMatrix permuted(n, n);
  permuted.setFromTriplets(entries.begin(), entries.end());
  EXPECT_LT(Factor(lower_triangle(permuted), 0).entries(), 0.7 * Factor(lower_triangle(natural), 0).entries());
  std::sort(order.begin(), order.end());
  for (Index k = 0; k < n; ++k) ASSERT_EQ(order[k], k);
}

// Both METIS that there are, libmetis and the one within CHOLMOD, draw the same numbers then, and order alike.
TEST(Factor, DissectionDrawsFromTheGeneratorOfItsThread) {
  const auto [start, neighbors] = grid(40);
  const unsigned before = seeds_of_metis();
  dissection(start, neighbors);
  EXPECT_GT(seeds_of_metis(), before);
}

// METIS has handlers of its own for SIGTERM, which jump out of it, or anywhere on a thread that it does not run on.
TEST(Factor, DissectionLeavesSignalsToTheProgram) {
  const auto [start, neighbors] = grid(180);
  const std::vector<Index> undisturbed = dissection(start, neighbors, 2);
  static std::atomic<int> seen;
  seen = 0;
  struct sigaction count = {}, before = {};
  count.sa_handler = [](int) { ++seen; };
  ASSERT_EQ(sigaction(SIGTERM, &count, &before), 0);
  {
    const std::jthread sender([](const std::stop_token& end) {
      while (!end.stop_requested()) {
        kill(getpid(), SIGTERM);
        std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
    });
    // On a busy machine the first orderings may see few signals.
    EXPECT_TRUE(test::eventually([&] {
      for (const int threads : {1, 2, 2}) EXPECT_EQ(dissection(start, neighbors, threads), undisturbed) << threads;
      return seen > 10;
    }));
  }
  struct sigaction now = {};
  sigaction(SIGTERM, &before, &now);
  EXPECT_EQ(now.sa_handler, count.sa_handler);
}

// The rounding error of a product is a unit in the last place of these.
TEST(Factor, SizesOfAProductHaveNoSigns) {
  // 3 -1 / -1 2 in its lower triangle
  const LowerTriangle K{2, {0, 2, 3}, {0, 1, 1}, {3, -1, 2}};
  EXPECT_EQ(multiply(K, Eigen::Vector2d(1, -4)), Eigen::VectorXd(Eigen::Vector2d(7, -9)));
  EXPECT_EQ(multiply_sizes(K, Eigen::Vector2d(1, -4)), Eigen::VectorXd(Eigen::Vector2d(7, 9)));
  EXPECT_EQ(multiply_sizes(K, Eigen::Vector2d(1, 4)), Eigen::VectorXd(Eigen::Vector2d(7, 9)));
}

TEST(Factor, EmptySystemSolvesToNothing) {
  const Factor factor(LowerTriangle{}, 0);
  EXPECT_EQ(factor.solve(Eigen::VectorXd(0)).size(), 0);
}

}  // namespace
}  // namespace kerf::factor_test
