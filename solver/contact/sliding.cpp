#include "solver/contact/sliding.hpp"

#include "base/dense.hpp"

namespace kerf {

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
