#pragma once
// Which moments of a piece that two parts share must be continuous.

#include <Eigen/Core>

namespace kerf {

/// Forces g on a piece with Z g = lambda X g, lambda > threshold, as columns: those that move it by more than
/// `threshold` times as much when all else that both parts share is free (Z = Z_p + Z_q) as when it is held (X). Both
/// are symmetric and definite; their lower halves are read. Empty when X is not definite to working precision. [theory:
/// E.35]
Eigen::MatrixXd soft_forces(const Eigen::MatrixXd& Z, const Eigen::MatrixXd& X, double threshold);

/// Eigenvectors of a symmetric matrix with eigenvalues above the threshold, of length 1; these need not be exact. The
/// process ends when new blocks add no value above the threshold, so that in all likelihood none is left out. Lower
/// half read by a block Lanczos process with a start that is always the same [Golub, Underwood 1977].
Eigen::MatrixXd eigenvectors_above(const Eigen::MatrixXd& M, double threshold);

}  // namespace kerf
