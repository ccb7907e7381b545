// The generalized eigenproblem Z g = lambda X g of a piece, by L^-1 Z L^-T with X = L L': densely where it is small,
// else by a block Lanczos process [Golub, Underwood 1977; theory: E.35].

#include "solver/system/primal.hpp"

#include "base/dense.hpp"
#include "kerf/stop.hpp"

#include <algorithm>
#include <cstdint>

namespace kerf {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// The same on every machine.
MatrixXd scattered_matrix(Eigen::Index rows, Eigen::Index columns) {
  MatrixXd x(rows, columns);
  std::uint64_t state = 1;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    x.data()[i] = static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
  }
  return x;
}

/// Of eigenvalues that increase, how many are above the threshold.
Eigen::Index count_above(const VectorXd& values, double threshold) {
  return (values.array() > threshold).count();
}

/// Less what lies along the columns of q, twice for rounding, then orthonormal.
MatrixXd next_block(const MatrixXd& q, MatrixXd w) {
  for (int twice = 0; twice < 2; ++twice) w -= multiply(q, transposed_multiply(q, w));
  MatrixXd block = thin_qr(w).Q;
  for (int twice = 0; twice < 2; ++twice) block -= multiply(q, transposed_multiply(q, block));
  return thin_qr(block).Q;
}

}  // namespace

/// Blocks of 12: eigenvalues come in clusters (motions of a part that nothing holds). It ends when the number above the
/// threshold has stayed for a step and their residuals are below 5 % of the eigenvalues: a check, not a proof, that
/// none is missed.
MatrixXd eigenvectors_above(const MatrixXd& M, double threshold) {
  constexpr Eigen::Index width = 12, small = 10 * width;  // more than motions that are alike
  const Eigen::Index n = M.rows();
  if (n <= small) {
    const auto [values, vectors] = eigenpairs(M);
    return vectors.rightCols(count_above(values, threshold));
  }
  constexpr double near = 0.05;  // of an eigenvalue
  MatrixXd q = next_block(MatrixXd::Zero(n, 0), scattered_matrix(n, width)), mq(n, 0);
  Eigen::Index before = -1;
  while (true) {
    check_stop();
    const Eigen::Index done = mq.cols();
    mq.conservativeResize(n, q.cols());
    mq.rightCols(q.cols() - done) = M.selfadjointView<Eigen::Lower>() * q.rightCols(q.cols() - done);
    const Eigenpairs ritz = eigenpairs(transposed_multiply(q, mq));
    const Eigen::Index above = count_above(ritz.values, threshold);
    const auto y = ritz.vectors.rightCols(above);
    const MatrixXd vectors = multiply(q, y), rest = multiply(mq, y) - vectors * ritz.values.tail(above).asDiagonal();
    const bool settled =
        above == before && (rest.colwise().norm().transpose().array() <= near * ritz.values.tail(above).array()).all();
    if (settled || q.cols() + width > n) return vectors;
    before = above;
    const MatrixXd block = next_block(q, mq.rightCols(width));
    q.conservativeResize(n, q.cols() + width);
    q.rightCols(width) = block;
  }
}

MatrixXd soft_forces(const MatrixXd& Z, const MatrixXd& X, double threshold) {
  const Eigen::LLT<MatrixXd> llt = cholesky(X);
  if (llt.info() != Eigen::Success) return {X.rows(), 0};
  const auto L = llt.matrixL();
  MatrixXd M = Z.selfadjointView<Eigen::Lower>();
  L.solveInPlace(M);
  M.transposeInPlace();
  L.solveInPlace(M);
  const MatrixXd y = eigenvectors_above(M, threshold);
  if (y.cols() == 0) return y;
  return solve_upper(llt, y);
}

}  // namespace kerf
