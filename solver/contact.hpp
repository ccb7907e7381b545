#pragma once
// Unilateral contact on crack faces: one small dense quadratic program.

#include "geometry/types.hpp"

#include <vector>

namespace kerf {

/// min 1/2 j'S j - r'j over j >= 0, S symmetric positive definite: the normal jumps at the crack points, all else
/// eliminated [Belhachmi 2008, the modified algorithm]. p = S j - r >= 0 are the contact forces, p'j = 0.
struct Contact {
  Eigen::VectorXd jump, force;
  std::vector<bool> closed;  // the final active set: jump = 0 there, force = 0 elsewhere
  int iterations = 0;
  bool converged = true;
};

/// Primal-dual active set from the solution with `closed` held shut (all open when empty); when it has not settled
/// after 30 steps, the active-set method of Lawson and Hanson, which cannot cycle, goes on.
Contact solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, std::vector<bool> closed = {});

/// The jumps with the closed points held at 0: S_OO j_O = r_O, j_C = 0.
Eigen::VectorXd open_jumps(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<bool>& closed);

}  // namespace kerf
