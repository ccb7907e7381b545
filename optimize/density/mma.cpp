// The method of moving asymptotes [Svanberg 1987; theory: P.7]: at each point every function is replaced by
//   sum_c p_c/(U_c - x_c) + q_c/(x_c - L_c) + const,   p from positive, q from negative derivatives,
// convex and separable, so that for multipliers lambda the minimizer is known per variable, x = (a L + b U)/(a + b)
// with a^2, b^2 the sums of p, q. The dual is maximized by Newton steps along the path of a barrier. Asymptotes come
// nearer where a variable swings and move away where it keeps going. With `reciprocal` L stays just below the lower
// bound: compliances only fall with density [Fleury 1989], and moving asymptotes lose members at once. Violated
// constraints have a price of 1000, beyond which a quadratic term takes them up, so that there is always a step.
// Derived in docs/theory/density.md, section "Steps".

#include "optimize/density/mma.hpp"

#include "base/dense.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double first_distance = 0.5, shorter = 0.7, longer = 1.2;  // of asymptotes, in ranges of a variable
constexpr double nearest = 0.01, farthest = 10;
constexpr double at_low = 1e-3;   // below the lower bounds, for reciprocal variables
constexpr double elastic = 1000;  // price of a violated constraint, in units of the objective's gradient

/// sum p / (upper - x) + q / (x - lower), columns: the objective, then the constraints; each <= right (y: by how much
/// one is violated).
struct Approximation {
  Eigen::VectorXd lower, upper, low, high;
  Eigen::MatrixXd p, q;
  Eigen::VectorXd right;

  Eigen::VectorXd minimizer(const Eigen::VectorXd& lambda) const;
  /// Of the dual at lambda, with the minimizer x: its gradient and minus its second derivative.
  void dual(const Eigen::VectorXd& lambda, const Eigen::VectorXd& x, Eigen::VectorXd& slope,
            Eigen::MatrixXd& bend) const;
  Eigen::VectorXd solve() const;
};

Eigen::VectorXd weighted(const Eigen::MatrixXd& a, const Eigen::VectorXd& lambda) {
  return a.col(0) + a.rightCols(lambda.size()) * lambda;
}

// Zero of the derivative p/(U - x)^2 - q/(x - L)^2, cut off at the bounds of the step: each variable by itself.
Eigen::VectorXd Approximation::minimizer(const Eigen::VectorXd& lambda) const {
  const Eigen::ArrayXd a = weighted(p, lambda).array().sqrt(), b = weighted(q, lambda).array().sqrt();
  return ((a * lower.array() + b * upper.array()) / (a + b)).max(low.array()).min(high.array());
}

void Approximation::dual(const Eigen::VectorXd& lambda, const Eigen::VectorXd& x, Eigen::VectorXd& slope,
                         Eigen::MatrixXd& bend) const {
  const Eigen::Index m = lambda.size();
  const Eigen::ArrayXd up = upper - x, down = x - lower;
  // The slope of the dual is the value of the constraints; only variables off their bounds move with lambda.
  slope = p.rightCols(m).transpose() * up.inverse().matrix() + q.rightCols(m).transpose() * down.inverse().matrix() -
          right - (lambda.array() - elastic).max(0).matrix();
  const Eigen::ArrayXd second =
      2 * (weighted(p, lambda).array() / up.cube() + weighted(q, lambda).array() / down.cube());
  const Eigen::ArrayXd free = (x.array() > low.array() && x.array() < high.array()).cast<double>();
  const Eigen::MatrixXd by =
      ((p.rightCols(m).array().colwise() / up.square()) - (q.rightCols(m).array().colwise() / down.square())).matrix();
  bend = by.transpose() * (free / second).matrix().asDiagonal() * by;
  for (Eigen::Index i = 0; i < m; ++i)
    if (lambda[i] > elastic) bend(i, i) += 1;
}

/// The dual's maximum over lambda >= 0 by Newton steps on the path of a barrier.
Eigen::VectorXd Approximation::solve() const {
  const Eigen::Index m = right.size();
  Eigen::VectorXd lambda = Eigen::VectorXd::Ones(m), force = Eigen::VectorXd::Ones(m), slope;
  Eigen::MatrixXd bend;
  for (double barrier = 1; barrier > 1e-10; barrier *= 0.1)
    for (int i = 0; i < 40; ++i) {
      dual(lambda, minimizer(lambda), slope, bend);
      const Eigen::VectorXd residual = slope + force;
      const Eigen::VectorXd gap = force.cwiseProduct(lambda).array() - barrier;
      if (std::max(residual.cwiseAbs().maxCoeff(), gap.cwiseAbs().maxCoeff()) < 0.9 * barrier) break;
      Eigen::MatrixXd matrix = bend;
      matrix.diagonal() += force.cwiseQuotient(lambda);
      const Eigen::VectorXd d = solve_symmetric(matrix, slope + (barrier / lambda.array()).matrix());
      const Eigen::VectorXd e =
          (barrier / lambda.array()).matrix() - force - force.cwiseProduct(d).cwiseQuotient(lambda);
      // At most 99 % of the way to where a multiplier or a slack would vanish.
      double share = 1;
      for (Eigen::Index k = 0; k < m; ++k) {
        if (d[k] < 0) share = std::min(share, -0.99 * lambda[k] / d[k]);
        if (e[k] < 0) share = std::min(share, -0.99 * force[k] / e[k]);
      }
      lambda += share * d;
      force += share * e;
    }
  return minimizer(lambda);
}

}  // namespace

Mma::Mma(Eigen::VectorXd low, Eigen::VectorXd high, double move, bool reciprocal)
    : low_(std::move(low)), high_(std::move(high)), move_(move), reciprocal_(reciprocal) {}

/// Nearer where a variable swings, further where it keeps going.
void Mma::move_asymptotes(const Eigen::VectorXd& x) {
  const Eigen::ArrayXd range = high_ - low_;
  // L just below the bound: q/(x - L) is the reciprocal of a density; what grows with one is nearly linear.
  if (reciprocal_) {
    lower_ = low_ - (at_low * range).matrix();
    upper_ = x + (farthest * range).matrix();
    return;
  }
  Eigen::ArrayXd distance = first_distance * range;
  if (steps_ >= 2) {
    const Eigen::ArrayXd trend = (x - before_).cwiseProduct(before_ - before_that_);
    const Eigen::ArrayXd factor =
        (trend < 0).select(shorter, (trend > 0).select(longer, Eigen::ArrayXd::Ones(x.size())));
    distance = (factor * (upper_ - lower_).array() / 2).max(nearest * range).min(farthest * range);
  }
  lower_ = x - distance.matrix();
  upper_ = x + distance.matrix();
}

// With p = (U - x)^2 df+ and q = (x - L)^2 df- the approximation has the derivative of its function at x.
Eigen::VectorXd Mma::step(const Eigen::VectorXd& x, const MmaPoint& at) {
  move_asymptotes(x);
  const Eigen::ArrayXd range = high_ - low_, up = upper_ - x, down = x - lower_;
  Approximation a{.lower = lower_, .upper = upper_, .right = -at.g};
  // No nearer to an asymptote than a tenth of the way, and no farther than the move limit.
  a.low = low_.array().max((x.array() - move_ * range).max(lower_.array() + 0.1 * down));
  a.high = high_.array().min((x.array() + move_ * range).min(upper_.array() - 0.1 * up));
  const Eigen::Index m = at.g.size();
  a.p.resize(x.size(), m + 1);
  a.q.resize(x.size(), m + 1);
  for (Eigen::Index i = 0; i <= m; ++i) {
    const Eigen::ArrayXd by = i == 0 ? at.objective_by : Eigen::VectorXd(at.by.col(i - 1));
    const Eigen::ArrayXd more = by.max(0), less = (-by).max(0);
    // A thousandth of the other sign and 1e-5 per range keep every function strictly convex.
    a.p.col(i) = up.square() * (1.001 * more + 0.001 * less + 1e-5 / range);
    a.q.col(i) = down.square() * (0.001 * more + 1.001 * less + 1e-5 / range);
    // And its value: the constants go to the right-hand side.
    if (i > 0) a.right[i - 1] += a.p.col(i).dot(up.inverse().matrix()) + a.q.col(i).dot(down.inverse().matrix());
  }
  before_that_ = before_;
  before_ = x;
  ++steps_;
  return m == 0 ? a.minimizer({}) : a.solve();
}

}  // namespace kerf
