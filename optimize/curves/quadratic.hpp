#pragma once
// Small convex quadratic programs.

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace kerf {

struct QuadraticStep {
  Eigen::VectorXd step;
  Eigen::VectorXd multiplier;  // per row, at least 0
};

/// min 1/2 d.H d + g.d under A d <= b, through its dual [Lawson, Hanson 1974]. H by its Cholesky
/// factor. Rows that contradict each other are met as far as they go, in the mean of squares. `soft`: per row what it
/// may be violated by per multiplier; shorter than b: 0 for those behind it.
QuadraticStep quadratic_step(const Eigen::LLT<Eigen::MatrixXd>& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
                             const Eigen::VectorXd& b, const Eigen::VectorXd& soft = {});

}  // namespace kerf
