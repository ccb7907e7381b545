#pragma once
// The method of moving asymptotes [Svanberg 1987]: separable convex approximations, solved by their dual.

#include "kerf/types.hpp"

namespace kerf {

/// Values and gradients at a point: the objective, and constraints g <= 0 (a column of `by` each).
struct MmaPoint {
  Eigen::VectorXd objective_by;
  Eigen::VectorXd g;
  Eigen::MatrixXd by;
};

class Mma {
 public:
  /// Variables between low and high; none moves further than `move` of that in a step. `reciprocal`: what falls with a
  /// variable is taken as a multiple of 1 / (variable - low) throughout, as a compliance is of the thickness of a bar
  /// [Fleury 1989]; otherwise asymptotes follow the swings of the variables.
  Mma(Eigen::VectorXd low, Eigen::VectorXd high, double move, bool reciprocal = false);

  /// How far a variable may move in a step from now on, a share of its range.
  void move_at_most(double share) {
    move_ = share;
  }

  /// The next point. Constraints that no step can meet are violated as little as possible.
  Eigen::VectorXd step(const Eigen::VectorXd& x, const MmaPoint& at);

 private:
  void move_asymptotes(const Eigen::VectorXd& x);

  Eigen::VectorXd low_, high_, lower_, upper_;  // bounds, asymptotes
  Eigen::VectorXd before_, before_that_;        // points
  double move_;
  bool reciprocal_;
  int steps_ = 0;
};

}  // namespace kerf
