// Gauss rules for the weight s^b on [0, 1], from the eigenvalues of the Jacobi matrix [Golub, Welsch 1969].

#include "solver/data/jacobi.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace kerf {

// On [-1, 1] with the exponents 0 and b: a_k = b^2/((2k + b)(2k + b + 2)), b_k^2 = 4 k^2 (k + b)^2/((2k + b)^2 ((2k +
// b)^2 - 1)); for k = 1 the factor 1 + b cancels, which is small for b near -1. Weights are squares of first components
// times int s^b = 1/(1 + b).
EdgeRule gauss_jacobi(double b, int points) {
  Eigen::VectorXd diagonal(points), beside(points - 1);
  for (int k = 0; k < points; ++k) {
    diagonal[k] = k == 0 ? b / (b + 2) : b * b / ((2 * k + b) * (2 * k + b + 2));
    if (k > 0) {
      const double twice = 2 * k + b;
      beside[k - 1] = k == 1 ? std::sqrt(4 * (1 + b) / ((2 + b) * (2 + b) * (3 + b)))
                             : std::sqrt(4 * k * k * (k + b) * (k + b) / (twice * twice * (twice + 1) * (twice - 1)));
    }
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum;
  spectrum.computeFromTridiagonal(diagonal, beside);
  EdgeRule rule{Eigen::VectorXd(points), Eigen::VectorXd(points)};
  rule.s = 0.5 * (1 + spectrum.eigenvalues().array());
  rule.w = spectrum.eigenvectors().row(0).cwiseAbs2().transpose() / (1 + b);
  return rule;
}

}  // namespace kerf
