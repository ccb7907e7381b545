// Values and derivatives of the monomials x^i y^j, i + j <= k, in the order of base/polynomial.hpp.

#include "base/polynomial.hpp"

namespace kerf {

Eigen::MatrixXd monomials(int degree, const Points& x) {
  Eigen::MatrixXd value(dim(degree), x.cols());
  value.row(0).setOnes();
  for (int k = 1; k <= degree; ++k) {
    for (int j = 0; j < k; ++j) value.row(place(k - j, j)) = value.row(place(k - j - 1, j)).cwiseProduct(x.row(0));
    value.row(place(0, k)) = value.row(place(0, k - 1)).cwiseProduct(x.row(1));
  }
  return value;
}

Eigen::MatrixXd derivative(int degree, int axis) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(dim(degree), dim(degree));
  for (int k = 1; k <= degree; ++k)
    for (int j = 0; j <= k; ++j) {
      const int i = k - j;
      if (axis == 0 && i > 0) d(place(i - 1, j), place(i, j)) = i;
      if (axis == 1 && j > 0) d(place(i, j - 1), place(i, j)) = j;
    }
  return d;
}

}  // namespace kerf
