// Dense linear algebra as thin functions over Eigen, compiled here once (see the header for what each one computes and
// throws).
// Which function an expression goes to decides which of Eigen's kernels runs, and with it the last bits of every
// result. multiply(a, b, c) is (a b) c; solve_from_right takes b a^-1 = (a^-1 b')' of a symmetric a; thin_qr multiplies
// the reflections by the first columns of the identity. The decompositions: LL' (no pivots, definite), LDL' (diagonal
// pivots), LU with row pivots, QR with and without column pivots, complete orthogonal for least norm, and symmetric
// eigenvalue problems.

#include "base/dense.hpp"

#include <Eigen/Eigenvalues>

namespace kerf {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd multiply(const ConstMatrix& a, const ConstMatrix& b) {
  return a * b;
}

VectorXd multiply(const ConstMatrix& a, const ConstVector& x) {
  return a * x;
}

MatrixXd multiply(const ConstMatrix& a, const ConstMatrix& b, const ConstMatrix& c) {
  return multiply(multiply(a, b), c);
}

MatrixXd transposed_multiply(const ConstMatrix& a, const ConstMatrix& b) {
  return a.transpose() * b;
}

VectorXd transposed_multiply(const ConstMatrix& a, const ConstVector& x) {
  return a.transpose() * x;
}

MatrixXd multiply_transposed(const ConstMatrix& a, const ConstMatrix& b) {
  return a * b.transpose();
}

MatrixXd inverse(const ConstMatrix& a) {
  return a.inverse();
}

Eigen::LLT<MatrixXd> cholesky(const ConstMatrix& a) {
  return Eigen::LLT<MatrixXd>(a);
}

MatrixXd solve(const Eigen::LLT<MatrixXd>& a, const ConstMatrix& b) {
  return a.solve(b);
}

VectorXd solve(const Eigen::LLT<MatrixXd>& a, const ConstVector& b) {
  return a.solve(b);
}

MatrixXd solve_from_right(const ConstMatrix& b, const Eigen::LLT<MatrixXd>& a) {
  return a.solve(b.transpose()).transpose();
}

MatrixXd solve_lower(const Eigen::LLT<MatrixXd>& a, const ConstMatrix& b) {
  return a.matrixL().solve(b);
}

VectorXd solve_lower(const Eigen::LLT<MatrixXd>& a, const ConstVector& b) {
  return a.matrixL().solve(b);
}

MatrixXd solve_upper(const Eigen::LLT<MatrixXd>& a, const ConstMatrix& b) {
  return a.matrixU().solve(b);
}

MatrixXd solve_upper_from_right(const ConstMatrix& b, const Eigen::LLT<MatrixXd>& a) {
  return a.matrixL().solve(b.transpose()).transpose();
}

MatrixXd solve_spd(const ConstMatrix& a, const ConstMatrix& b) {
  return solve(cholesky(a), b);
}

VectorXd solve_spd(const ConstMatrix& a, const ConstVector& b) {
  return solve(cholesky(a), b);
}

MatrixXd solve_symmetric(const ConstMatrix& a, const ConstMatrix& b) {
  return a.ldlt().solve(b);
}

VectorXd solve_symmetric(const ConstMatrix& a, const ConstVector& b) {
  return a.ldlt().solve(b);
}

Eigen::PartialPivLU<MatrixXd> lu(const ConstMatrix& a) {
  return Eigen::PartialPivLU<MatrixXd>(a);
}

MatrixXd solve(const Eigen::PartialPivLU<MatrixXd>& a, const ConstMatrix& b) {
  return a.solve(b);
}

VectorXd solve(const Eigen::PartialPivLU<MatrixXd>& a, const ConstVector& b) {
  return a.solve(b);
}

MatrixXd solve_lu(const ConstMatrix& a, const ConstMatrix& b) {
  return solve(lu(a), b);
}

VectorXd solve_lu(const ConstMatrix& a, const ConstVector& b) {
  return solve(lu(a), b);
}

ThinQr thin_qr(const ConstMatrix& a) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  return {qr.householderQ() * MatrixXd::Identity(a.rows(), a.cols()),
          qr.matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>()};
}

Eigen::ColPivHouseholderQR<MatrixXd> pivoted_qr(const ConstMatrix& a, double threshold) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  if (threshold >= 0) qr.setThreshold(threshold);
  return qr;
}

MatrixXd orthonormal(const Eigen::ColPivHouseholderQR<MatrixXd>& a, Eigen::Index columns) {
  return a.householderQ() * MatrixXd::Identity(a.rows(), columns);
}

MatrixXd full_q(const Eigen::ColPivHouseholderQR<MatrixXd>& a) {
  return a.householderQ();
}

MatrixXd solve_upper_transposed(const ConstMatrix& r, const ConstMatrix& b) {
  return r.triangularView<Eigen::Upper>().transpose().solve(b);
}

/// The last columns of the square Q are orthogonal to those of a, which must be independent: there are no pivots.
MatrixXd orthogonal_complement(const ConstMatrix& a) {
  const MatrixXd q = Eigen::HouseholderQR<MatrixXd>(a).householderQ();
  return q.rightCols(a.rows() - a.cols());
}

MatrixXd null_space(const ConstMatrix& a) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(a.transpose());
  return full_q(qr).rightCols(a.cols() - qr.rank());
}

VectorXd solve(const Eigen::ColPivHouseholderQR<MatrixXd>& a, const ConstVector& b) {
  return a.solve(b);
}

VectorXd solve_least_squares(const ConstMatrix& a, const ConstVector& b) {
  return solve(pivoted_qr(a), b);
}

/// The threshold must be set before the decomposition, which counts the rank.
MatrixXd solve_least_norm(const ConstMatrix& a, const ConstMatrix& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  if (threshold >= 0) decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return decomposition.solve(b);
}

VectorXd solve_least_norm(const ConstMatrix& a, const ConstVector& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

MatrixXd pseudo_inverse(const ConstMatrix& a) {
  return a.completeOrthogonalDecomposition().pseudoInverse();
}

Eigenpairs eigenpairs(const ConstMatrix& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigenpairs eigenpairs(const ConstMatrix& a, const ConstMatrix& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(a, b);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace kerf
