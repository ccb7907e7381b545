// Gauss rules for the weight s^b on [0, 1], from the eigenvalues of the Jacobi matrix [Golub, Welsch 1969].

#include "solver/data/jacobi.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace kerf {

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
