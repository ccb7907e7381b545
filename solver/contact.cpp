#include "solver/contact.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace kerf {

Eigen::VectorXd open_jumps(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<bool>& closed) {
  std::vector<Index> open;
  for (std::size_t i = 0; i < closed.size(); ++i)
    if (!closed[i]) open.push_back(static_cast<Index>(i));
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(r.size());
  if (open.empty()) return jump;
  const Eigen::MatrixXd part = S(open, open);
  const Eigen::VectorXd load = r(open);
  const Eigen::VectorXd value = Eigen::LLT<Eigen::MatrixXd>(part).solve(load);
  for (std::size_t i = 0; i < open.size(); ++i) jump[open[i]] = value[static_cast<Eigen::Index>(i)];
  return jump;
}

Contact solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, std::vector<bool> closed) {
  const Eigen::Index n = r.size();
  Contact c;
  c.closed = std::move(closed);
  c.closed.resize(n, false);
  if (n == 0) return c;
  // Steps are cheap or dear with n^3: a budget in both, so that no contact problem can run for ever.
  constexpr double most_work = 1e12;
  const double cube = std::pow(static_cast<double>(n), 3);
  const int budget = static_cast<int>(std::clamp(most_work / cube, 60.0, 5000.0));
  constexpr double rounding = 1e-13;
  constexpr int trust = 10;  // full exchanges in a row that need not help
  const double load = r.cwiseAbs().maxCoeff();
  Eigen::Index fewest = n + 1;
  int patience = trust;
  std::vector<Eigen::Index> wrong;
  for (c.iterations = 1; c.iterations <= budget; ++c.iterations) {
    c.jump = open_jumps(S, r, c.closed);
    c.force = S * c.jump - r;
    const double jump = c.jump.cwiseAbs().maxCoeff();
    wrong.clear();
    for (Eigen::Index i = 0; i < n; ++i)
      if (c.closed[i] ? c.force[i] < -rounding * load : c.jump[i] < -rounding * jump) wrong.push_back(i);
    const Eigen::Index count = static_cast<Eigen::Index>(wrong.size());
    if (count == 0) break;
    if (count < fewest) {
      fewest = count;
      patience = trust;
    } else if (patience > 0) {
      --patience;
    } else {
      wrong = {wrong.back()};
    }
    for (const Eigen::Index i : wrong) c.closed[i] = !c.closed[i];
  }
  c.converged = wrong.empty();
  for (Eigen::Index i = 0; i < n; ++i)
    if (!c.closed[i]) c.force[i] = 0;
  return c;
}

}  // namespace kerf
