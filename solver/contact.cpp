#include "solver/contact.hpp"

#include <Eigen/Cholesky>

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

namespace {

// Lawson, Hanson (1974), chapter 23, for the quadratic form itself: open one point at a time, step back to the first
// constraint that the new jumps would violate. The energy falls strictly, so that no set comes twice.
void lawson_hanson(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, Contact& c) {
  const Eigen::Index n = r.size();
  const double tolerance = 1e-13 * r.cwiseAbs().maxCoeff();
  c.closed.assign(n, true);
  c.jump.setZero(n);
  const int budget = 10 * static_cast<int>(n) + 100;
  for (int step = 0; step < budget; ++step, ++c.iterations) {
    const Eigen::VectorXd force = S * c.jump - r;
    Eigen::Index worst = -1;
    for (Eigen::Index i = 0; i < n; ++i)
      if (c.closed[i] && force[i] < -tolerance && (worst < 0 || force[i] < force[worst])) worst = i;
    if (worst < 0) return;
    c.closed[worst] = false;
    for (Eigen::VectorXd next = open_jumps(S, r, c.closed);; next = open_jumps(S, r, c.closed)) {
      double share = 1;
      Eigen::Index blocking = -1;
      for (Eigen::Index i = 0; i < n; ++i)
        if (!c.closed[i] && next[i] <= 0) {
          const double limit = c.jump[i] / (c.jump[i] - next[i]);
          if (!(limit > share)) {
            share = std::max(limit, 0.0);
            blocking = i;
          }
        }
      c.jump += share * (next - c.jump);
      if (blocking < 0) break;
      for (Eigen::Index i = 0; i < n; ++i)
        if (!c.closed[i] && (i == blocking || c.jump[i] <= 0)) {
          c.closed[i] = true;
          c.jump[i] = 0;
        }
    }
  }
  c.converged = false;
}

}  // namespace

Contact solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, std::vector<bool> closed) {
  constexpr int patience = 30;
  const Eigen::Index n = r.size();
  Contact c;
  c.closed = std::move(closed);
  c.closed.resize(n, false);
  if (n == 0) return c;
  const double stiffness = S.diagonal().maxCoeff();
  bool settled = false;
  for (c.iterations = 1; c.iterations <= patience; ++c.iterations) {
    c.jump = open_jumps(S, r, c.closed);
    c.force = S * c.jump - r;
    settled = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool closed = (c.closed[i] ? c.force[i] : 0) - stiffness * c.jump[i] > 0;
      settled = settled && closed == c.closed[i];
      c.closed[i] = closed;
    }
    if (settled) break;
  }
  if (!settled) lawson_hanson(S, r, c);
  c.force = S * c.jump - r;
  for (Eigen::Index i = 0; i < n; ++i)
    if (!c.closed[i]) c.force[i] = 0;
  return c;
}

}  // namespace kerf
