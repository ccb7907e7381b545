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

/// Primal-dual active set (every wrong point changes sides) from the solution with `closed` held shut (all open when
/// empty). When ten exchanges in a row do not lower the number of wrong points, a projected Newton method, which lowers
/// the energy in every step, goes on. `converged` is false when the budget of steps runs out.
Contact solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, std::vector<bool> closed = {});

/// The jumps with the closed points held at 0: S_OO j_O = r_O, j_C = 0.
Eigen::VectorXd open_jumps(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<bool>& closed);

}  // namespace kerf
