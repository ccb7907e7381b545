#pragma once
// The law of contact and friction as intervals of admissible forces: what the contact algorithms share.

#include "solver/contact/contact.hpp"

namespace kerf {

/// Per row the forces that the law allows at the pressures in `force`. A jump > 0 needs the low end, < 0 the high end.
struct Admissible {
  Eigen::VectorXd low, high;
};
Admissible admissible(const std::vector<ContactPoint>& points, const Eigen::VectorXd& force);

/// Contact::kkt with load = max|r|. Infinite when anything is not finite.
double optimality(const std::vector<ContactPoint>& points, const Eigen::VectorXd& jump, const Eigen::VectorXd& force,
                  double load);

/// How well jumps and forces fit the law on rows that move or are held (none: all are). Rows that move bear what the
/// law has for their motion, and what their force differs from that by is residual; held ones take what there is, which
/// the law judges. Relative to `load`.
struct JudgedContact {
  Eigen::VectorXd bears;
  double residual = 0, law = 0;
};
JudgedContact judge_contact(const std::vector<ContactPoint>& points, const std::vector<Motion>& motion,
                            const Eigen::VectorXd& jump, const Eigen::VectorXd& force, double load);

}  // namespace kerf
