#pragma once
// Smooth minimization in a box with inequality constraints. NLopt lives in minimize.cpp and nowhere else.

#include "kerf/optimize.hpp"

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

namespace kerf {

/// Those that `minimize` knows.
inline constexpr std::array nlopt_methods{OptimizeMethod::Mma, OptimizeMethod::Ccsaq, OptimizeMethod::Slsqp,
                                          OptimizeMethod::Cobyla};

/// What is known at x: the objective first, then the constraints, which are to be at most 0.
struct Evaluation {
  Eigen::VectorXd x;
  Eigen::VectorXd values;     // 1 + constraints
  Eigen::MatrixXd gradients;  // variables x (1 + constraints); no columns where they were not asked for
  std::string failure = {};   // why x could not be evaluated; values that are unknown are then NaN
};

/// The largest constraint, at least 0.
double violation_of(const Evaluation& e);

/// Minimize values[0] over lower <= x <= upper such that values[1...] <= 0. Variables whose bounds are equal are fixed.
/// Constraints should be relative: 1 is a large violation.
struct Program {
  Eigen::VectorXd lower, upper;
  Eigen::Index constraints = 0;
  /// What it throws ends the minimization and is thrown on. A failed evaluation (Evaluation::failure) is answered
  /// from its nearest neighbor: by its linear model where a constraint that is known is violated, so that
  /// the constraints push back, by values that push towards it otherwise. It never is the result.
  std::function<Evaluation(const Eigen::VectorXd& x, bool gradients)> evaluate;
  bool gradients = true;  // false: `evaluate` has none (cobyla alone)
  /// Called after every evaluation with its KKT residual (NaN without gradients); false: stop.
  std::function<bool(const Evaluation& evaluation, double kkt)> see = {};
};

struct Stop {
  int evaluations = 200;
  double kkt = 1e-3;  // relative to the size of the derivatives: here, at the start, or `scale`, the largest
  double scale = 0;
  double feasibility = 1e-6;  // violations up to here do not count
  double step = 1e-7;         // change of the variables, relative to their boxes; 1e-4 for cobyla
  double value = 1e-8;        // relative change of the objective
  double simplex = 0.1;       // cobyla: its first steps, relative to the boxes
  double reach = 1;           // slsqp: its first step, relative to the boxes, where the slope is as large as J
  bool by_slope = false;      // ... or however small the slope is: to see what lies around a flat place
};

struct Minimum {
  Evaluation best;  // feasible and lowest, or the least violation that was met
  int evaluations = 0;
  double kkt = 0;        // at the best point; NaN: unknown
  double violation = 0;  // largest value of a constraint there, at least 0
  bool feasible = false;
  bool converged = false;            // feasible and kkt small; without gradients: feasible, and NLopt says so
  bool asked_to_stop = false;        // by Program::see
  std::string reason;                // in words
  std::vector<std::string> notes;    // wrong successes, restarts
  std::vector<std::string> failure;  // what failed evaluations said, each text once
};

/// Method: Mma [Svanberg 2002], Ccsaq (the same with quadratic models), Slsqp [Kraft 1994], Cobyla [Powell 1994]
/// without gradients. NLopt calls it a success when steps get short, which happens at wrong points too: kerf ends
/// at a small KKT residual, and goes on with MMA from a point where NLopt stopped and the residual is large.
/// Deterministic: where `evaluate` repeats itself, so does the whole run.
/// Throws Error(Usage) for a method that is not NLopt's, bounds that cross, a start outside of them, gradients that it
/// needs.
Minimum minimize(const Program& program, const Eigen::VectorXd& start, OptimizeMethod method, const Stop& stop);

/// The size of the derivatives of the objective: max(|f|, |df/dx_i| (upper_i - lower_i)).
double scale_of(const Evaluation& e, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

/// Residual of the conditions of Karush, Kuhn and Tucker with the best multipliers: in variables that run from 0 to 1,
/// min over l, m >= 0 of | (grad f + sum l_j grad c_j + sum m_k n_k, l_j c_j, m_k d_k) |, n_k the outward normals of
/// the bounds, d_k the distances to them; the largest that is left of one variable or constraint, over `scale`.
/// Violations of constraints are not part of it.
double kkt_residual(const Evaluation& e, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double scale);

}  // namespace kerf
