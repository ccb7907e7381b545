#pragma once
// The fields of a triangle as coefficients of functions that are orthonormal on it, in place of values at points: far
// fewer, and integrals of products are sums [theory: B.42].

#include "solver/bounds/triangle_bounds.hpp"

namespace kerf {

/// The span of polynomials of some degree, and of the derivatives of what the right inverse makes of them. The
/// polynomials come first, those of lower degree before the others; means of squares over the triangle are 1.
struct Modes {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Modes(const TriangleReference& r, const Element& e, int degree);

  int degree;
  Eigen::Index polynomials, count;
  Points nodes;                 // lattice(degree)
  Matrix to_modes;              // values there -> polynomials
  Matrix derivative;            // polynomials -> d1 q1, d2 q1, d1 q2, d2 q2 of the right inverse, `count` rows each
  Matrix value;                 // polynomials -> q1, q2, projected onto those of degree trace + 1
  Matrix displacement;          // the conforming displacement, or a body force, -> polynomials
  std::array<Matrix, 2> slope;  // its derivatives
  Matrix unseen_force;      // nodal values of a body force -> p1, p2 without normal trace, whose divergence is what the
                            // element does not see of the force
  Matrix strain;            // monomials of an eigenstrain -> polynomials
  Eigen::MatrixXd values;   // at the points of the rule, a column per mode
  Eigen::VectorXd weights;  // of these points
  Eigen::VectorXd peak;     // largest there
  std::array<std::array<Matrix, 2>, 3> at_edge;  // from values at `nodes`

  /// Coefficients (columns) of values at the points of the rule (rows of components).
  template <typename Values>
  Eigen::MatrixXd of(const Values& at_points) const {
    return values.transpose() * weights.asDiagonal() * at_points.transpose();
  }
};

}  // namespace kerf
