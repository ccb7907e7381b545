// The intervals of forces that contact and friction allow, and the residual max |p - P(p - j)| of the law, P the
// projection onto them [theory: C.10, C.12].

#include "solver/contact/law.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

Admissible admissible(const std::vector<ContactPoint>& points, const Eigen::VectorXd& force) {
  Admissible a{Eigen::VectorXd::Zero(force.size()), Eigen::VectorXd::Zero(force.size())};
  for (const ContactPoint& p : points) {
    a.high[p.normal] = infinity;
    if (p.tangential == none) continue;
    a.high[p.tangential] = p.slip_bound + p.friction * std::max(force[p.normal], 0.0);
    a.low[p.tangential] = -a.high[p.tangential];
  }
  return a;
}

// Forces relative to the load, jumps to the largest jump, so that both terms of p - j count alike; a solution has 0
// whatever the scaling.
double optimality(const std::vector<ContactPoint>& points, const Eigen::VectorXd& jump, const Eigen::VectorXd& force,
                  double load) {
  if (!jump.allFinite() || !force.allFinite()) return infinity;
  if (jump.size() == 0 || load == 0) return 0;
  const Admissible a = admissible(points, force);
  const double largest = jump.cwiseAbs().maxCoeff();
  double worst = 0;
  for (Eigen::Index i = 0; i < jump.size(); ++i) {
    const double p = force[i] / load, j = largest > 0 ? jump[i] / largest : 0;
    worst = std::max(worst, std::abs(p - std::clamp(p - j, a.low[i] / load, a.high[i] / load)));
  }
  return worst;
}

JudgedContact judge_contact(const std::vector<ContactPoint>& points, const std::vector<Motion>& motion,
                            const Eigen::VectorXd& jump, const Eigen::VectorXd& force, double load) {
  const Admissible allowed = admissible(points, force);
  JudgedContact judged{.bears = force};
  for (Eigen::Index i = 0; i < force.size(); ++i) {
    if (motion.empty() || motion[static_cast<std::size_t>(i)] == Motion::Held) continue;
    judged.bears[i] = motion[static_cast<std::size_t>(i)] == Motion::Forward ? allowed.low[i] : allowed.high[i];
    judged.residual = std::max(judged.residual, std::abs(force[i] - judged.bears[i]) / load);
  }
  judged.law = optimality(points, jump, force, load);
  return judged;
}

}  // namespace kerf
