#pragma once
// What a quadratic model says can still be gained.

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace kerf {

/// max over d of -(g.d + 1/2 d.H d) under A d <= max(b, 0) [theory: K.7]: half of g.H^-1 g where nothing is in the way.
/// H by its Cholesky factor. What is violated, b < 0, counts as being at its limit: making up for it is no gain.
double model_gain(const Eigen::LLT<Eigen::MatrixXd>& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
                  const Eigen::VectorXd& b);

}  // namespace kerf
