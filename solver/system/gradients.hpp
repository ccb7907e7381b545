#pragma once
// Conjugate gradients on what several processes share.

#include "solver/divided_body.hpp"

namespace kerf {

/// A preconditioned solver for one matrix A and many right-hand sides. Each direction is made conjugate to all before
/// it, those of earlier right-hand sides included, which a solve begins with: what rounding and a few eigenvalues far
/// from the others cost is paid once [theory: E.36].
class SharedGradients : public SharedIteration {
 public:
  /// All processes call the same functions. Of products the rows count that are `counted` here: each on one process.
  SharedGradients(Communicator& comm, SharedSystem system)
      : peers_(comm),
        system_(std::move(system)),
        counted_(system_.counted),
        p_(counted_.size(), 0),
        Ap_(counted_.size(), 0) {}
  SharedSolved solve(const Eigen::VectorXd& b) override;

 private:
  void keep(const Eigen::VectorXd& p, const Eigen::VectorXd& Ap, double size);

  Communicator& peers_;
  SharedSystem system_;
  const Eigen::VectorXd& counted_;
  Eigen::MatrixXd p_, Ap_;  // columns: directions with p' A p = 1, and A p
  Eigen::Index count_ = 0;  // of these
};

}  // namespace kerf
