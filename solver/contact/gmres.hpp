#pragma once
// Small systems that are known by products alone.

#include "base/dense.hpp"

#include <algorithm>

namespace kerf {

/// GMRES [Saad, Schultz 1986] for x - B x = b by products B x, from 0, down to |residual| = enough.
/// Sixty steps at most, without restart. Orthogonalized twice, so that the basis is orthogonal to rounding.
template <typename Product>
Eigen::VectorXd gmres(const Product& product, const Eigen::VectorXd& b, double enough) {
  constexpr Eigen::Index most = 60;
  const double size = b.norm();
  Eigen::MatrixXd basis(b.size(), most + 1), hessenberg = Eigen::MatrixXd::Zero(most + 1, most);
  basis.col(0) = b / size;
  Eigen::VectorXd weights;
  for (Eigen::Index k = 0; k < std::min(most, b.size()); ++k) {
    Eigen::VectorXd w = basis.col(k) - product(basis.col(k));
    for (int pass = 0; pass < 2; ++pass)
      for (Eigen::Index i = 0; i <= k; ++i) {
        const double share = basis.col(i).dot(w);
        hessenberg(i, k) += share;
        w -= share * basis.col(i);
      }
    const double rest = w.norm();
    hessenberg(k + 1, k) = rest;
    constexpr double nothing = 1e-12;
    if (hessenberg.col(k).norm() <= nothing) break;  // x - B x is singular to rounding
    const auto h = hessenberg.topLeftCorner(k + 2, k + 1);
    const Eigen::VectorXd target = size * Eigen::VectorXd::Unit(k + 2, 0);
    weights = solve_least_squares(h, target);
    if ((multiply(h, weights) - target).norm() <= enough || rest <= nothing) break;
    basis.col(k + 1) = w / rest;
  }
  return multiply(basis.leftCols(weights.size()), weights);
}

}  // namespace kerf
