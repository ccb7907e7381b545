#pragma once
// The small problem that all parts share.

#include "solver/divided_body.hpp"
#include "solver/factor.hpp"

namespace kerf {

/// The factor of the sum of small dense matrices, one for each process, on all of them.
/// Every process has the factor of the whole: its unknowns are a few per piece of the interface.
class Coarse {
 public:
  Coarse() = default;
  /// All processes call it. `S`: of this one, onto the unknowns `at` of `total`.
  Coarse(const Eigen::MatrixXd& S, const std::vector<Index>& at, Index total, Communicator& comm);

  Index size() const {
    return total_;
  }
  /// Of the sum over the processes of `own`, the solution on the unknowns of this one.
  Eigen::VectorXd solve(const Eigen::VectorXd& own) const;

 private:
  std::unique_ptr<Factor> factor_;
  std::vector<Index> at_;
  Index total_ = 0;
  Communicator* peers_ = nullptr;
};

}  // namespace kerf
