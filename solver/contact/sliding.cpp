// The tangent of contact with points that slide against Coulomb's friction, p_t = share p_n, and its transpose for
// adjoints: the dense systems of [theory: A.14, A.15, A.16], by LU since they are not symmetric.

#include "solver/contact/sliding.hpp"

#include "base/dense.hpp"

namespace kerf {

// Rows t of S_MM less share times rows n of S_HM: n is held, and its force follows from the jumps that move.
SlidingRows::SlidingRows(const Eigen::MatrixXd& S, const std::vector<Motion>& motion, Sliding sliding)
    : S_(S), sliding_(std::move(sliding)) {
  std::vector<Index> place(motion.size(), none);
  for (Index i = 0; i < static_cast<Index>(motion.size()); ++i)
    if (motion[i] != Motion::Held) {
      place[i] = static_cast<Index>(moving_.size());
      moving_.push_back(i);
    }
  if (moving_.empty()) return;
  Eigen::MatrixXd forward = S(moving_, moving_);
  for (const SlidingPoint& p : sliding_.points) forward.row(place[p.tangential]) -= p.share * S(p.normal, moving_);
  if (sliding_.transposed)
    factor_ = lu(forward.transpose());
  else
    factor_ = lu(forward);
}

// Forward the right-hand side of row t loses share times that of row n; transposed the held row n gets the jump -share
// times that of t.
Eigen::VectorXd SlidingRows::jumps(const Eigen::VectorXd& r, const Eigen::VectorXd* given) const {
  Eigen::VectorXd jump = given ? *given : Eigen::VectorXd::Zero(r.size());
  if (moving_.empty()) return jump;
  Eigen::VectorXd load = r;
  if (given) load -= S_ * *given;
  if (!sliding_.transposed)
    for (const SlidingPoint& p : sliding_.points) load[p.tangential] -= p.share * load[p.normal];
  const Eigen::VectorXd wanted = load(moving_), moved = kerf::solve(factor_, wanted);
  jump(moving_) += moved;
  if (sliding_.transposed)
    for (const SlidingPoint& p : sliding_.points) jump[p.normal] -= p.share * jump[p.tangential];
  return jump;
}

}  // namespace kerf
