#pragma once
// One linear solve with the factor of the model, and the penalty iteration around it: what the state and its adjoint
// share.

#include "solver/contact/sliding.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/elementwise.hpp"
#include "solver/system/uniform_pressure.hpp"

#include <functional>
#include <optional>

namespace kerf {

/// What one round of the penalty iteration gives.
struct PenaltyIterate {
  Eigen::VectorXd x, force;    // per row; forces of contact, 0 on the other rows
  Eigen::VectorXd low;         // of x in twice the precision, or nothing: then products run triangle by triangle
  std::vector<Motion> motion;  // per row in contact
  Eigen::VectorXd theta;       // per triangle, with a penalty
  double penalty_error = 0;    // what this round still changed in theta/a, the pressures, relative
  Certificate certificate;
};

/// What acts besides the matrix: F without the penalty's share, per triangle the share of mean(tr s) that the loads
/// have (Condensed::own), the values of the unknowns that are not solved for.
struct Loads {
  Eigen::VectorXd F, own;
  std::vector<double> prescribed;
};
Loads loads_of(const Model& m);

/// All skeleton unknowns from the free ones; the others as given, or 0.
Eigen::VectorXd on_skeleton(const Model& m, const Eigen::VectorXd& rows, const std::vector<double>* elsewhere);

/// The part on the free rows.
Eigen::VectorXd on_rows(const Model& m, const Eigen::VectorXd& skeleton);

/// All skeleton unknowns of an iterate.
DoubleDouble on_skeleton(const Model& m, const PenaltyIterate& s, const std::vector<double>& elsewhere);

/// What a change of theta/a, the pressures, is judged by: the largest, and the largest of the terms that they sum.
struct ThetaChange {
  double change = 0, size = 0;
};
/// theta = a mean(tr s) of the solution with these values of the skeleton.
ThetaChange move_theta(const Model& m, const Loads& loads, const DoubleDouble& skeleton, Eigen::VectorXd& theta);
/// The same of the present solution.
void update_theta(const Model& m, const Loads& loads, PenaltyIterate& s);

/// F with the penalty paid back.
Eigen::VectorXd right_hand_side(const Model& m, const Loads& loads, const PenaltyIterate& s);

/// The rows in contact condensed: S once for all iterations, and the two halves of a solve around them. With large
/// contact there is no S, and only `solve_frozen` and `energy_of` solve.
struct Condensation {
  explicit Condensation(const Model& model);
  const Model& m;
  Eigen::MatrixXd S;
  std::vector<ContactPoint> points;

  /// Right-hand side on the rows in contact after the first half, y = L^-1 b.
  Eigen::VectorXd load(const Eigen::VectorXd& y) const;
  /// The second half with given jumps on the rows in contact.
  Eigen::VectorXd complete(Eigen::VectorXd y, const Eigen::VectorXd& jump) const;
  /// Jumps under a load when the held rows stay at 0.
  Eigen::VectorXd moving_jumps(const Eigen::VectorXd& r, const std::vector<Motion>& motion) const;
  /// K x = b with the held rows at 0, or as given, and no change of force on the others.
  Eigen::VectorXd solve_frozen(const Eigen::VectorXd& b, const std::vector<Motion>& motion,
                               const Eigen::VectorXd* held = nullptr) const;
  /// With large contact: the same, on the rows in contact and those beside them alone.
  Eigen::VectorXd solve_at_contact(const Eigen::VectorXd& b, const std::vector<Motion>& motion) const;
  /// With it solve_frozen is that of a tangent cone with sliding points: forces of moving rows follow pressures, or for
  /// the adjoint, transposed, jumps of normal rows those of tangential ones.
  std::optional<Sliding> sliding = {};
  /// b'x for the solution of K x = b; with large contact with the held rows at 0.
  double energy_of(const Eigen::VectorXd& b, const std::vector<Motion>& motion) const;

 private:
  mutable std::optional<OpenRows> open_rows_ = {};  // of the last call: one thread at a time
  mutable std::optional<SlidingRows> sliding_rows_ = {};
};

/// What rounding alone may leave of K x - F, relative to `load`: no solve shrinks that.
double rounding_of(const Model& m, const Eigen::VectorXd& x, double load);

/// The two steps that differ between a state and its adjoint, and when to stop.
struct PenaltySteps {
  /// K x = F under the law of the rows in contact: from nothing while x is empty, then from the last x.
  std::function<void(const Eigen::VectorXd& F, PenaltyIterate& s)> solve;
  /// Forces, and the certificate of x under F.
  std::function<void(const Eigen::VectorXd& F, PenaltyIterate& s)> certify;
  int most = 0;       // rounds
  double enough = 0;  // of Certificate::kkt
  /// `rounding_of` the iterate; not asked for with a penalty.
  std::function<double(const PenaltyIterate& s)> rounding = {};
};

/// When rounds end of which each removes what the one before has left: they no longer halve the error. With a penalty F
/// is as large as 1/a, so that they go on until rounding stops them; before they shrink the error they may raise it,
/// while a pressure builds up or contacts change.
class RoundsEnd {
 public:
  static constexpr double settled = 1e-9;  // an error from which it is rounding alone that is left
  explicit RoundsEnd(bool penalized) : penalized_(penalized) {}
  /// Of the next round; whether its error is the least so far.
  bool take(double error);
  bool stalls() const {
    return without_gain_ == patience_;
  }
  double least() const {
    return least_;
  }

 private:
  bool penalized_, begins_ = true;
  double least_ = infinity;
  int without_gain_ = 0, patience_ = 1;
};

/// The best of these rounds, and whether it is the last one.
template <typename Iterate>
struct BestRound {
  Iterate best;
  bool is_last = true;
};
/// At most so many: `round(iterate)` moves it on and returns its error, `enough(iterate, error)` ends them.
template <typename Iterate, typename Round, typename Enough>
BestRound<Iterate> best_round(Iterate next, bool penalized, int most, const Round& round, const Enough& enough) {
  BestRound<Iterate> found{next};
  RoundsEnd end(penalized);
  for (int k = 0; k < most; ++k) {
    const double error = round(next);
    found.is_last = end.take(error);
    if (found.is_last) found.best = next;
    if (enough(next, error) || end.stalls()) break;
  }
  return found;
}

/// One solve, then rounds that remove the residual: of rounding, and of the penalty when there is one. Gives the best
/// round; starts from the motions in `next`.
PenaltyIterate iterate(const Condensation& condensed, const Loads& loads, PenaltyIterate next, UniformPressure& uniform,
                       const PenaltySteps& steps);

}  // namespace kerf
