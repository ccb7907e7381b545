#pragma once
// Contact and friction on crack faces: the jumps at the crack points, all else eliminated [theory: C.5, C.10].

#include "kerf/state.hpp"

#include <Eigen/Cholesky>

#include <functional>
#include <optional>
#include <vector>

namespace kerf {

/// The law at one point of a crack, on rows of p = S j - r (j jumps, p contact forces): j_n >= 0, p_n >= 0, p_n j_n = 0
/// and, with a tangential row, |p_t| <= limit = slip_bound + friction p_n, p_t = -limit sign(j_t) where j_t != 0. The
/// slip bound is a force (stress times the point's share of the length) and acts on open points too, so that without
/// friction (Tresca) j minimizes 1/2 j'S j - r'j + sum slip_bound |j_t| over j_n >= 0. Friction (Coulomb) is for loads
/// that grow in proportion. Rows of no point have p = 0.
struct ContactPoint {
  Index normal = none, tangential = none;
  double slip_bound = 0, friction = 0;
};

/// What a row does. Held (closed, or stick): jump 0, force unknown. The others have a known force: 0 (normal row,
/// Forward = open) or -limit (Forward, slip with j_t > 0) or +limit (Backward, j_t < 0).
enum class Motion : signed char { Backward = -1, Held = 0, Forward = 1 };

struct Contact {
  Eigen::VectorXd jump, force;  // per row
  std::vector<Motion> motion;
  int iterations = 0;  // sets of motions tried; steps of Uzawa
  int solves = 0;      // linear solves; for Uzawa products with S
  bool converged = true;
  double kkt = 0;  // largest |p - P(p - j)|, P onto the admissible forces, S j - r = p over max|r|, j over max|j|
};

/// S symmetric positive definite (`converged` is false when it is not) and small: `active_set` on it, with the Cholesky
/// factor of the moving rows kept and extended between the sets [Belhachmi 2008, the modified algorithm].
Contact dual_qp(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<ContactPoint>& points,
                const std::vector<Motion>& guess = {});

/// The set in which a path through the inside of the admissible jumps and forces ends, by Newton's method with
/// prediction and correction [Mehrotra 1992; theory: C.34]: a factor of S per step, in a number of steps that neither
/// its condition nor the first set matter to. No friction that follows the pressure.
std::vector<Motion> interior_set(const Eigen::MatrixXd& S, const Eigen::VectorXd& r,
                                 const std::vector<ContactPoint>& points);

/// The whole system behind the rows: jumps and forces p = S j - r of all rows (as computed, moving ones too) when the
/// held rows have jump 0 and the others the force given for them.
struct Response {
  Eigen::VectorXd jump, force;
};
/// Everything that the active set knows of S: a solve per set. `rows` counts those in contact.
struct Eliminated {
  Index rows = 0;
  std::function<Response(const std::vector<Motion>&, const Eigen::VectorXd& force)> solve;
  int most_iterations = 500;
  bool trusts_guess = false;  // no solution of the bonded crack beside a guess: forces are judged by those of the guess
  /// Another way to a set, where exchanges take long: for points without Coulomb's friction.
  std::function<std::vector<Motion>(const std::vector<ContactPoint>&)> elsewhere = {};
};

/// Elimination of the constraint: primal-dual active set, every row on the wrong side changes sides, starting from the
/// forces of the bonded crack or from `guess`. Coulomb's limits are solved for together with the jumps of a set (GMRES
/// on the pressures of the slipping points), a semismooth Newton method. When ten exchanges in a row do not lower the
/// number of wrong rows: without friction, steps to the first row that turns back [Lawson, Hanson 1974], each of which
/// lowers the energy, so that no set comes twice; with friction, a damped fixed point of such problems with given
/// limits, from which the exchanges start again. `converged` is false when most_iterations end it, or rounding does.
Contact active_set(const Eliminated& system, const std::vector<ContactPoint>& points,
                   const std::vector<Motion>& guess = {});

/// Uzawa's projected iteration j <- prox(j - rho (S j - r)): prox projects normal jumps onto j >= 0 and shrinks
/// tangential ones by rho times the limit at the present pressure. rho = 1/(largest eigenvalue) with the momentum that
/// the condition of S prescribes [Nesterov 2004, (2.2.11)], dropped in steps where it points uphill [O'Donoghue, Candes
/// 2015]: a fifth to a tenth of the steps of rho = 2/(sum of both ends of the spectrum) without it. Scaling by the
/// diagonal gains nothing on cracks. Stops at kkt = 1e-12, or what rounding leaves of it; `converged` is false after
/// 1e11 flops, or 1,000 steps where these are more.
Contact uzawa(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<ContactPoint>& points);

/// Every row a normal one: `dual_qp` from the solution with `closed` held shut.
struct Unilateral {
  Eigen::VectorXd jump, force;
  std::vector<bool> closed;  // the final active set: jump = 0 there, force = 0 elsewhere
  int iterations = 0;
  bool converged = true;
};
Unilateral solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<bool>& closed = {});

/// The jumps with the closed points held at 0: S_OO j_O = r_O, j_C = 0. S_OO is factorized once.
class OpenRows {
 public:
  OpenRows(const Eigen::MatrixXd& S, std::vector<bool> closed);
  const std::vector<bool>& closed() const {
    return closed_;
  }
  Eigen::VectorXd jumps(const Eigen::VectorXd& r) const;

 private:
  std::vector<bool> closed_;
  std::vector<Index> open_;
  std::optional<Eigen::LLT<Eigen::MatrixXd>> factor_;
};

}  // namespace kerf
