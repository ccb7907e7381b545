// Conjugate gradients on the exact products, with the factor of the assembled matrix for a preconditioner:
//   z = K~^-1 r,   p <- z + (z.(r - r_before)/(z_before.r_before)) p,   x <- x + (r.p/p.K p) p   [theory: E.19],
// two to six steps in bodies whose motions are far larger than their strains. x is carried in twice the precision. Rows
// in contact that are held stay held: their part of the residual is a force. [Polak, Ribiere 1969] instead of the
// shorter formula, because rounding makes the factor a slightly different preconditioner in each step.
// docs/theory/elements.md, section Slender bodies.

#include "solver/system/refine.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace kerf {

namespace {

// The factor of K with the rows held that s.motion holds.
class Frozen {
 public:
  Frozen(const Condensation& condensed, const std::vector<Motion>& motion) : condensed_(condensed), motion_(motion) {
    for (Index i = 0; i < static_cast<Index>(motion.size()); ++i)
      (motion[i] == Motion::Held ? held_ : moving_).push_back(i);
    if (!moving_.empty() && !has_large_contact(condensed.m)) block_.compute(condensed.S(moving_, moving_));
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const {
    const Model& m = condensed_.m;
    if (has_large_contact(m)) return condensed_.solve_frozen(b, motion_);
    Eigen::VectorXd y = m.inner->factor->forward(b);
    const Index rows = m.inner->ordering.contact_rows;
    if (rows == 0) return m.inner->factor->backward(y);
    Eigen::VectorXd jump = Eigen::VectorXd::Zero(rows);
    if (!moving_.empty()) {
      const Eigen::VectorXd load = condensed_.load(y);
      const Eigen::VectorXd part = load(moving_), found = block_.solve(part);
      jump(moving_) = found;
    }
    return condensed_.complete(std::move(y), jump);
  }

  void drop_held(Eigen::VectorXd& rows) const {
    const Index leading = static_cast<Index>(rows.size()) - condensed_.m.inner->ordering.contact_rows;
    for (const Index i : held_) rows[leading + i] = 0;
  }

 private:
  const Condensation& condensed_;
  const std::vector<Motion>& motion_;
  std::vector<Index> held_, moving_;
  Eigen::LLT<Eigen::MatrixXd> block_;
};

}  // namespace

double growth(const Model& m, const Eigen::VectorXd& x, double energy) {
  const LowerTriangle& k = *m.inner->system.K;
  double size = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) size += std::abs(k.values[k.start[i]]) * x[i] * x[i];
  return size > 0 ? 4 * std::numeric_limits<double>::epsilon() * size / std::abs(energy) : 0;
}

Eigen::VectorXd Refinement::rest(const Eigen::VectorXd& F, const std::vector<double>& prescribed,
                                 const PenaltyIterate& s) const {
  return F - on_rows(condensed_.m, product_(on_skeleton(condensed_.m, s, prescribed)).forces);
}

// r'z = r'K^-1 r is the square of the error in the norm of the energy. The steps end when it is nothing, or when two of
// them in a row do not make it smaller: rounding.
int Refinement::solve(const Eigen::VectorXd& F, const std::vector<double>& prescribed, PenaltyIterate& s) const {
  const Model& m = condensed_.m;
  const Frozen factor(condensed_, s.motion);
  if (s.low.size() == 0) s.low.setZero(s.x.size());
  const auto start = product_(on_skeleton(m, s, prescribed));
  Eigen::VectorXd r = F - on_rows(m, start.forces), p;
  factor.drop_held(r);
  constexpr int most = 60, patience = 2;
  constexpr double enough = 1e-26;
  double before = 0, least = infinity, energy = std::abs(start.energy);
  Eigen::VectorXd last;
  int step = 0, without_gain = 0;
  for (; step < most; ++step) {
    const Eigen::VectorXd z = factor.solve(r);
    const double error = r.dot(z), size = std::abs(error);
    without_gain = size < 0.25 * least ? 0 : without_gain + 1;
    least = std::min(least, size);
    if (!(size > enough * energy) || without_gain == patience) break;
    // [Polak, Ribiere 1969]: the factor's own rounding makes it a slightly different preconditioner in every step.
    p = step == 0 ? z : Eigen::VectorXd(z + (error - last.dot(z)) / before * p);
    const auto push = product_({on_skeleton(m, p, nullptr), {}});
    const double share = r.dot(p) / push.energy;
    if (!std::isfinite(share)) break;
    DoubleDouble x{std::move(s.x), std::move(s.low)};
    add(x, share, p);
    s.x = std::move(x.high);
    s.low = std::move(x.low);
    last = r;
    before = error;
    Eigen::VectorXd forces = on_rows(m, push.forces);
    factor.drop_held(forces);
    r -= share * forces;
    energy = std::max(energy, size);
  }
  return step;
}

}  // namespace kerf
