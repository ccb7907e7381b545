#pragma once
// Polynomials on a reference triangle by their values at lattice points, local right inverses of the divergence
// [theory: B.5].

#include "base/quadrature.hpp"

#include <array>

namespace kerf {

/// Points (l1, l2), i + j <= n, of the lattice (i/n, j/n): the centroid alone when n = 0.
Points lattice(int degree);
constexpr int lattice_place(int degree, int i, int j) {
  return j * (degree + 1) - j * (j - 1) / 2 + i;
}
/// Values at the points `at` (l1, l2) of the polynomials with given values at the lattice: a row per point.
Eigen::MatrixXd interpolation(int degree, const Points& at);
/// Derivatives with respect to the two reference coordinates. The reference triangle is equilateral with side 1.
std::array<Eigen::MatrixXd, 2> differentiation(int degree, const Points& at);
/// d(physical)/d(reference coordinates) of the triangle with these vertices.
Mat2 jacobian(const std::array<Vec2, 3>& x);

/// The triangle split at its centroid into three, with a rule on each: points (l1, l2), weights of sum 1.
TriangleRule split_rule(int degree);

/// q in H^1_0(T)^2, continuous and of degree n + 1 on each third of T, with div q = g for every g in P_n(T) of zero
/// mean; of those the one with the least |grad q| on the reference triangle. From the values of g on lattice(n): values
/// q1, q2 and derivatives d1 q1, d2 q1, d1 q2, d2 q2 at the points of the rule, point by point. On a triangle
/// with Jacobian J: q(x) = J q(X) / det J has div q(x) = div q(X) / det J (Piola). The continuous fields on the split
/// that vanish on the boundary map onto all piecewise polynomials of zero mean [Arnold, Qin 1992; Fu, Guzman, Neilan
/// 2020].
struct RightInverse {
  Eigen::MatrixXd value, derivative;
};
RightInverse right_inverse(int degree, const TriangleRule& split);

/// The same in H(div): p in P_n(T)^2 without normal trace, div p = g for g in P_(n-1)(T) of zero mean, of least |p|.
/// From values of g on lattice(n) to values p1, p2 on lattice(n), point by point; Piola as above.
Eigen::MatrixXd normal_free_right_inverse(int degree);

}  // namespace kerf
