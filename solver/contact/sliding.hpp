#pragma once
// The contact linearized where points slide against Coulomb's friction: an unsymmetric small problem [theory: A.14].

#include "solver/contact/contact.hpp"

#include <Eigen/LU>

namespace kerf {

/// A closed point that slides against Coulomb's friction, by its rows in contact: the force of the tangential one
/// changes by `share` times that of the normal one, which is held.
struct SlidingPoint {
  Index normal, tangential;
  double share;
};

/// Sliding points of a tangent cone; `transposed` for the adjoint.
struct Sliding {
  std::vector<SlidingPoint> points;
  bool transposed = false;
};

/// The jumps on a tangent cone with sliding points, held rows at 0 or as given. Forward p_t = share p_n, so that with
/// C(n, t) = share the rows that move are those of (S_MM - C'S_HM) j_M = (r - S g)_M - C'(r - S g)_H; transposed
/// j_H = g - C j_M and the matrix is the transpose. Factorized once.
class SlidingRows {
 public:
  SlidingRows(const Eigen::MatrixXd& S, const std::vector<Motion>& motion, Sliding sliding);
  Eigen::VectorXd jumps(const Eigen::VectorXd& r, const Eigen::VectorXd* given) const;

 private:
  const Eigen::MatrixXd& S_;
  Sliding sliding_;
  std::vector<Index> moving_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace kerf
