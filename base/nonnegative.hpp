#pragma once
// Least squares with unknowns that must not be negative.

#include <Eigen/Core>

namespace kerf {

/// min |A x - b| over x >= 0 [Lawson, Hanson 1974, chapter 23].
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace kerf
