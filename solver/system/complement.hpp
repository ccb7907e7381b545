#pragma once
// A dense symmetric matrix and a factor of one that is near it, in the memory of one.

#include <Eigen/Core>

#include <vector>

namespace kerf {

/// S in the lower half, U' D U in the upper one, U with ones on its diagonal.
class Complement {
 public:
  /// The lower half is read.
  explicit Complement(Eigen::MatrixXd S) : s_(std::move(S)) {}

  Eigen::Index size() const {
    return s_.rows();
  }
  /// S x, of one column or of many.
  template <typename Dense>
  Dense multiply(const Dense& x) const {
    return s_.selfadjointView<Eigen::Lower>() * x;
  }
  /// Its block of `count` rows from `begin` on; only the lower half has a meaning.
  auto block(Eigen::Index begin, Eigen::Index count) const {
    return s_.block(begin, begin, count, count);
  }

  /// Columns of length count, of rows from `begin` on.
  struct Forces {
    Eigen::Index begin;
    Eigen::MatrixXd columns;
  };
  /// U' D U = S + diag(shift) + the sum of c c' over columns c. Returns false, and has no factor, when that is not
  /// positive definite.
  bool factorize(const Eigen::VectorXd& shift, const std::vector<Forces>& held);
  /// By the factor.
  template <typename Dense>
  Dense solve(Dense b) const {
    if (b.size() == 0) return b;
    s_.triangularView<Eigen::UnitUpper>().transpose().solveInPlace(b);
    b.array().colwise() /= pivots_.array();
    s_.triangularView<Eigen::UnitUpper>().solveInPlace(b);
    return b;
  }
  /// The block of the inverse of what is factorized, both halves.
  Eigen::MatrixXd inverse_block(Eigen::Index begin, Eigen::Index count) const;

 private:
  Eigen::MatrixXd s_;
  Eigen::VectorXd pivots_;  // D
};

}  // namespace kerf
