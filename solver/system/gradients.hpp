#pragma once
// Conjugate gradients on what several processes share.

#include "solver/spread.hpp"

#include <functional>

namespace kerf {

/// A preconditioned solver for one matrix A and many right-hand sides. Each direction is made conjugate to all before
/// it, those of earlier right-hand sides included, which a solve begins with: what rounding and a few eigenvalues far
/// from the others cost is paid once [theory: E.36].
class SharedGradients {
 public:
  using Map = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  /// All processes call the same functions. Vectors are those of the rows here, the same on all who have them; of
  /// products the rows count that are `counted` here, 1 or 0: each on one process.
  SharedGradients(Peers& peers, Eigen::VectorXd counted)
      : peers_(peers), counted_(std::move(counted)), p_(counted_.size(), 0), Ap_(counted_.size(), 0) {}

  struct Solved {
    Eigen::VectorXd x;
    int iterations = 0;
    double condition = 1;  // of the preconditioned matrix, by the Lanczos coefficients
    double left = 0;       // of the energy of the solution, its root, that of the error as the preconditioner has it
  };
  /// Until no more than `tolerance` is left, or no more than `enough` and rounding does not let it shrink.
  Solved solve(const Map& A, const Map& preconditioner, const Eigen::VectorXd& b, double tolerance, double enough,
               int most);

 private:
  void keep(const Eigen::VectorXd& p, const Eigen::VectorXd& Ap, double size);

  Peers& peers_;
  Eigen::VectorXd counted_;
  Eigen::MatrixXd p_, Ap_;  // columns: directions with p' A p = 1, and A p
  Eigen::Index count_ = 0;  // of these
};

}  // namespace kerf
