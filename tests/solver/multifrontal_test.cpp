// The multifrontal factor on a box of points in space: residuals, the last block against the inverse, and the same bits
// for any number of threads and right-hand sides.

#include "solver/factor.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::multifrontal_test {
namespace {

/// A box of points, each tied to its neighbors, in an order of nested dissection, and last some rows tied to many.
LowerTriangle box(Index side, Index last) {
  const Index n = side * side * side, whole = n + last;
  std::vector<std::vector<Index>> near(static_cast<std::size_t>(n));
  const auto tie = [&](Index a, Index b) {
    near[static_cast<std::size_t>(a)].push_back(b);
    near[static_cast<std::size_t>(b)].push_back(a);
  };
  for (Index k = 0; k < n; ++k) {
    if (k % side + 1 < side) tie(k, k + 1);
    if (k / side % side + 1 < side) tie(k, k + side);
    if (k + side * side < n) tie(k, k + side * side);
  }
  std::vector<Index> start{0}, neighbors;
  for (const auto& of : near) {
    neighbors.insert(neighbors.end(), of.begin(), of.end());
    start.push_back(static_cast<Index>(neighbors.size()));
  }
  const std::vector<Index> order = dissection(start, neighbors);
  std::vector<Index> place(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) place[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])] = k;
  LowerTriangle lower{whole, {0}, {}, {}};
  for (Index k = 0; k < whole; ++k) {
    lower.rows.push_back(k);
    lower.values.push_back(7 + 0.1 * (k % 11));
    std::vector<Index> below;
    if (k < n)
      for (const Index other : near[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])])
        if (place[static_cast<std::size_t>(other)] > k) below.push_back(place[static_cast<std::size_t>(other)]);
    std::sort(below.begin(), below.end());
    for (Index r = n; r < whole; ++r)
      if (k < n ? (k + r) % 13 == 0 : r > k && (k + r) % 3 == 0) below.push_back(r);
    for (const Index row : below) {
      lower.rows.push_back(row);
      lower.values.push_back(row < n ? -1 : 0.01);
    }
    lower.start.push_back(static_cast<Index>(lower.rows.size()));
  }
  return lower;
}

Eigen::VectorXd uneven(Index n) {
  Eigen::VectorXd b(n);
  for (Index k = 0; k < n; ++k) b[k] = 1 + (k * 7) % 23;
  return b;
}

// Wide enough for fronts in several tiles, whose columns and rest end inside one.
TEST(Multifrontal, SolvesWithTheSameBitsForAnyNumberOfThreads) {
  const Index last = 30;
  const LowerTriangle K = box(20, last);
  const Eigen::VectorXd b = uneven(K.size);
  const Factor one(K, last);
  const Eigen::VectorXd x = one.solve(b);
  EXPECT_LT((multiply(K, x) - b).cwiseAbs().maxCoeff(), 1e-12 * b.cwiseAbs().maxCoeff());
  for (const int threads : {2, 3}) {
    const Factor more(K, last, true, 0, threads);
    EXPECT_EQ(more.contact_factor(), one.contact_factor()) << threads;
    EXPECT_EQ(more.solve(b), x) << threads;
  }
}

// Columns at once, alone, and in halves; the last rows wide, so that the large fronts are, too.
TEST(Multifrontal, ManyRightHandSidesAreSolvedAsEachIs) {
  for (const Index last : {5, 400}) {
    const LowerTriangle K = box(last == 5 ? 20 : 14, last);
    Eigen::MatrixXd b(K.size, 7);
    for (Eigen::Index c = 0; c < b.cols(); ++c)
      b.col(c) = uneven(K.size).array().pow(1 + 0.25 * static_cast<double>(c));
    const Factor one(K, last), two(K, last, true, 0, 2);
    const Eigen::MatrixXd x = one.solve_all(b);
    EXPECT_EQ(two.solve_all(b), x);
    for (Eigen::Index c = 0; c < b.cols(); ++c) {
      const double size = b.col(c).cwiseAbs().maxCoeff();
      EXPECT_LT((multiply(K, x.col(c)) - b.col(c)).cwiseAbs().maxCoeff(), 1e-12 * size) << c;
      EXPECT_LT((one.solve(b.col(c)) - x.col(c)).cwiseAbs().maxCoeff(), 1e-12 * x.col(c).cwiseAbs().maxCoeff()) << c;
    }
    // L^-T is the transpose of L^-1, and K^-1 their product: (L^-1 b)'(L^-1 c) = b'K^-1 c.
    const Eigen::VectorXd left = one.forward(b.col(0)), right = one.forward(b.col(1));
    EXPECT_NEAR(left.dot(right), b.col(0).dot(x.col(1)), 1e-12 * std::abs(left.dot(right)));
    EXPECT_NEAR(one.backward(Eigen::VectorXd(b.col(0))).dot(b.col(1)), b.col(0).dot(right),
                1e-12 * left.norm() * b.col(0).norm() * b.col(1).norm());
    EXPECT_LT((one.backward(Eigen::MatrixXd(b)).col(3) - one.backward(Eigen::VectorXd(b.col(3)))).cwiseAbs().maxCoeff(),
              1e-12 * b.col(3).cwiseAbs().maxCoeff());
  }
  const Factor small(box(3, 2), 2);
  EXPECT_EQ(small.solve_all(Eigen::MatrixXd(29, 0)).cols(), 0);
}

// In any order of elimination: the rows that were asked for have the bits of the whole solution.
TEST(Multifrontal, SolvesOnSomeRowsAlone) {
  const LowerTriangle K = box(16, 7);
  std::vector<Index> backwards(static_cast<std::size_t>(K.size));
  for (Index k = 0; k < K.size; ++k) backwards[static_cast<std::size_t>(k)] = K.size - 1 - k;
  const std::vector<Index> asked{3, 4, 1200, 2500, K.size - 2};
  const auto check = [&](const Factor& factor) {
    const Eigen::VectorXd y = factor.forward(uneven(K.size)), x = factor.backward(y);
    const std::vector<bool> fronts = factor.fronts_above(asked);
    EXPECT_LT(std::ranges::count(fronts, true), std::ssize(fronts)) << "some are left out";
    const Eigen::VectorXd part = factor.backward(y, fronts);
    for (const Index row : asked) EXPECT_EQ(part[row], x[row]) << row;
  };
  for (const int threads : {1, 2}) check(Factor(K, 7, true, 0, threads));
  check(Factor(K, std::span<const Index>(backwards)));
  EXPECT_THROW(Factor(K, 0, false).fronts_above(asked), std::invalid_argument);
}

// Flops of the fronts in tiles are those of the product that the last block stands for.
TEST(Multifrontal, TheLastBlockIsTheFactorOfWhatIsLeft) {
  const Index last = 250;
  const LowerTriangle K = box(9, last);
  const Index first = K.size - last;
  const Factor factor(K, last);
  // Column k of S = (K^-1's last block)^-1: S applied to the last block of a column of the inverse gives the identity.
  const Eigen::MatrixXd S = factor.contact_complement();
  Eigen::MatrixXd inverse(last, 3);
  for (Index c = 0; c < 3; ++c)
    inverse.col(c) = factor.solve(Eigen::VectorXd::Unit(K.size, first + 100 * c)).tail(last);
  for (Index c = 0; c < 3; ++c)
    EXPECT_LT((S * inverse.col(c) - Eigen::VectorXd::Unit(last, 100 * c)).cwiseAbs().maxCoeff(), 1e-12) << c;
}

TEST(Multifrontal, APivotThatIsNotPositiveIsFoundWhereverItIs) {
  const Index last = 30;
  const LowerTriangle K = box(20, last);
  for (const Index at : {0, 4000, K.size - 400, K.size - 1}) {
    LowerTriangle lost = K;
    lost.values[static_cast<std::size_t>(lost.start[static_cast<std::size_t>(at)])] = -1;
    for (const int threads : {1, 2}) EXPECT_THROW(Factor(lost, last, true, 0, threads), Error) << at;
    Factor factor(K, last);
    EXPECT_THROW(factor.refactor(lost), Error) << at;
  }
}

}  // namespace
}  // namespace kerf::multifrontal_test
