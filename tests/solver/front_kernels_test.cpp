// Elimination in a dense front against Eigen's Cholesky factor and the Schur complement; the same bits in any order of
// its parts.

#include "solver/system/front_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>
#include <vector>

namespace kerf::front_kernels_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const Each in_order = [](Index count, const std::function<void(Index)>& body) {
  for (Index i = 0; i < count; ++i) body(i);
};

/// A definite matrix, its parts as a front has them, and memory that holds no numbers.
struct Front {
  Index height, width;
  Eigen::MatrixXd all, panel, rest;
  std::vector<double> packed;

  Front(Index h, Index w) : height(h), width(w), packed(packed_size(h), nan) {
    std::mt19937 generator(static_cast<unsigned>(1000 * h + w));
    std::uniform_real_distribution<double> number(-1, 1);
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(h, h, [&] { return number(generator); });
    all = a * a.transpose() + Eigen::MatrixXd::Identity(h, h);
    panel = all.leftCols(w).triangularView<Eigen::Lower>();
    rest = all.bottomRightCorner(h - w, h - w).triangularView<Eigen::Lower>();
  }
  bool eliminate(const Each& each = in_order) {
    return kerf::eliminate({height, width, panel.data(), rest.data(), true}, packed.data(), each);
  }
};

// Whole and broken strips, fours and blocks, of own columns and of rows behind.
const std::vector<std::pair<Index, Index>> sizes = {{1, 1},   {5, 1},    {5, 5},     {12, 4},   {13, 12},   {24, 11},
                                                    {37, 13}, {96, 96},  {97, 96},   {100, 97}, {109, 95},  {192, 96},
                                                    {211, 7}, {230, 99}, {300, 193}, {401, 30}, {500, 211}, {600, 96}};

TEST(FrontKernels, MakeTheCholeskyFactorAndWhatItLeaves) {
  for (const auto& [height, width] : sizes) {
    SCOPED_TRACE(testing::Message() << height << " x " << width);
    Front f(height, width);
    ASSERT_TRUE(f.eliminate());
    const Index m = height - width;
    const Eigen::MatrixXd own = f.all.topLeftCorner(width, width).llt().matrixL();
    Eigen::MatrixXd L(height, width);
    L.topRows(width) = own;
    if (m > 0)
      L.bottomRows(m) =
          own.triangularView<Eigen::Lower>().solve(f.all.bottomLeftCorner(m, width).transpose()).transpose();
    const double size = f.all.norm();
    EXPECT_LT((f.panel - L).norm(), 1e-13 * size);  // zeros above the diagonal, too
    if (m == 0) continue;
    const Eigen::MatrixXd left = f.all.bottomRightCorner(m, m) - L.bottomRows(m) * L.bottomRows(m).transpose();
    const Eigen::MatrixXd wrong = (f.rest - left).triangularView<Eigen::Lower>();
    EXPECT_LT(wrong.norm(), 1e-13 * size);
  }
}

TEST(FrontKernels, LeaveTheSameBitsInALowerHalf) {
  for (const auto& [height, width] : sizes) {
    Front f(height, width), g(height, width);
    const Index m = height - width;
    std::vector<double> half(LowerHalf::size(m));
    const auto at = [&](Index i, Index j) -> double& {
      return half[static_cast<std::size_t>(LowerHalf::place(m, j) + i)];
    };
    for (Index j = 0; j < m; ++j)
      for (Index i = j; i < m; ++i) at(i, j) = g.rest(i, j);
    ASSERT_TRUE(f.eliminate());
    ASSERT_TRUE(eliminate({height, width, g.panel.data(), half.data()}, g.packed.data(), in_order));
    EXPECT_TRUE(f.panel == g.panel);
    for (Index j = 0; j < m; ++j)
      for (Index i = j; i < m; ++i) ASSERT_EQ(at(i, j), f.rest(i, j));
  }
}

TEST(FrontKernels, MakeTheSameBitsInAnyOrderOfTheirParts) {
  const Each backwards = [](Index count, const std::function<void(Index)>& body) {
    for (Index i = count; i-- > 0;) body(i);
  };
  for (const auto& [height, width] : sizes) {
    Front f(height, width), g(height, width);
    ASSERT_TRUE(f.eliminate());
    ASSERT_TRUE(g.eliminate(backwards));
    EXPECT_TRUE(f.panel == g.panel);
    EXPECT_TRUE(f.rest == g.rest);
  }
}

TEST(FrontKernels, FindAPivotThatIsNotPositiveWhereverItIs) {
  for (const double pivot : {-1.0, 0.0, nan})
    for (Index k = 0; k < 110; ++k) {
      Front f(130, 110);
      f.panel.row(k).head(k).setZero();
      f.panel(k, k) = pivot;
      EXPECT_FALSE(f.eliminate()) << k << ": " << pivot;
    }
}

}  // namespace
}  // namespace kerf::front_kernels_test
