#pragma once
// What straight triangles of one shape, one material and one penalty have in common: their elimination, done once.

#include "solver/element/local.hpp"

namespace kerf {

/// Of a triangle as `turned` has it, without an eigenstrain. All that the elimination gives is linear: in the trace m,
/// the moments of the force, and theta.
struct SharedShape {
  SharedShape(const Kernel& k, const Triangle& of, const Material& material, double penalty, bool forced);

  Condensed condensed(const Kernel& k, const LocalTriangle& t) const;
  /// Fills in t's interior and its forces.
  void recover(const Kernel& k, const LocalTriangle& t, Recovered& to) const;

 private:
  SkeletonMatrix K_;
  SkeletonVector trace_;       // as Condensed::trace, with a penalty
  double by_theta_ = 0;        // as Condensed::by_theta
  Eigen::MatrixXd given_;      // Condensed::F by the moments of the force; no columns without one
  Eigen::VectorXd own_;        // Condensed::own by them
  Eigen::MatrixXd tractions_;  // moments of s n by s
  Eigen::MatrixXd interior_;   // (s, u, r) by the trace, the moments and, with a penalty, theta
};

/// Whether triangle t can share: straight, the frames of its edges across and along them.
bool can_share(const Triangle& t);
/// Elements whose triangles can.
bool can_share(const Kernel& k);
/// The triangle turned by `turn`, all edges counter-clockwise, their frames (outward, along).
Triangle turned(const Triangle& t, int turn);

}  // namespace kerf
