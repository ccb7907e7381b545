#pragma once
// Monomials x^i y^j, i + j <= k, ordered by degree: 1, x, y, x^2, xy, y^2, ...

#include "kerf/types.hpp"

namespace kerf {

constexpr int dim(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}

/// Place of x^i y^j in the order.
constexpr int place(int i, int j) {
  return dim(i + j - 1) + j;
}

/// Values, dim(degree) x points.
Eigen::MatrixXd monomials(int degree, const Points& x);

/// D with (D c)_m the coefficient of monomial m of dp/dx (axis 0) or dp/dy (axis 1), p = sum c_m monomial_m. Square,
/// dim(degree) rows: the highest degree of the derivative is zero.
Eigen::MatrixXd derivative(int degree, int axis);

}  // namespace kerf
