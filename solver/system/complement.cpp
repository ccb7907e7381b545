// A dense symmetric S in the lower half of one array and the factor U'D U of S + shift + C C' in the upper one: half of
// the memory of two arrays [theory: E.36].

#include "solver/system/complement.hpp"

#include <Eigen/Cholesky>

namespace kerf {

using Eigen::MatrixXd, Eigen::VectorXd;

// The upper half is filled from the lower one, factorized in place, and its rows divided by the roots of the pivots
// (U'DU from R'R); the diagonal, which both halves share, is put back to that of S.
bool Complement::factorize(const VectorXd& shift, const std::vector<Forces>& held) {
  const Eigen::Index n = size();
  if (n == 0) return true;
  const VectorXd diagonal = s_.diagonal();
  for (Eigen::Index j = 0; j < n; ++j) s_.col(j).head(j) = s_.row(j).head(j).transpose();
  s_.diagonal() += shift;
  for (const Forces& f : held) {
    if (f.columns.cols() == 0) continue;
    const Eigen::Index count = f.columns.rows();
    auto upper = s_.block(f.begin, f.begin, count, count);
    upper.triangularView<Eigen::Upper>() += f.columns * f.columns.transpose();
  }
  bool definite = true;
  {
    const Eigen::LLT<Eigen::Ref<MatrixXd>, Eigen::Upper> llt(s_);  // leaves the lower half as it is
    definite = llt.info() == Eigen::Success;
  }
  const VectorXd root = s_.diagonal();
  for (Eigen::Index j = 1; definite && j < n; ++j) s_.col(j).head(j).array() /= root.head(j).array();
  pivots_ = root.cwiseAbs2();
  s_.diagonal() = diagonal;
  return definite;
}

// (U' D U)^-1 on rows F is Y' Y, Y = D^-1/2 U^-T E_F, which is zero above them.
MatrixXd Complement::inverse_block(Eigen::Index begin, Eigen::Index count) const {
  const Eigen::Index below = size() - begin;
  MatrixXd y = MatrixXd::Identity(below, count), inverse = MatrixXd::Zero(count, count);
  s_.bottomRightCorner(below, below).triangularView<Eigen::UnitUpper>().transpose().solveInPlace(y);
  y.array().colwise() /= pivots_.tail(below).array().sqrt();
  inverse.selfadjointView<Eigen::Lower>().rankUpdate(y.transpose());
  return inverse.selfadjointView<Eigen::Lower>();
}

}  // namespace kerf
