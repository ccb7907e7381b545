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

namespace {

constexpr double rounding = 1e-13;

// Points on the wrong side: closed with tension, open with penetration.
std::vector<Eigen::Index> wrong_points(const Contact& c, double load) {
  const double jump = c.jump.cwiseAbs().maxCoeff();
  std::vector<Eigen::Index> wrong;
  for (Eigen::Index i = 0; i < c.jump.size(); ++i)
    if (c.closed[i] ? c.force[i] < -rounding * load : c.jump[i] < -rounding * jump) wrong.push_back(i);
  return wrong;
}

// Projected Newton method [Bertsekas 1982]: points at zero that the gradient holds there stay, the others take a Newton
// step, shortened until the projection onto j >= 0 lowers the energy. Monotone, so that no set comes twice.
bool projected_newton(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, int budget, Contact& c) {
  const Eigen::Index n = r.size();
  const double load = r.cwiseAbs().maxCoeff();
  const Eigen::VectorXd stiffness = S.diagonal();
  Eigen::VectorXd x = c.jump.cwiseMax(0);
  for (int step = 0; step < budget; ++step) {
    ++c.iterations;
    const Eigen::VectorXd gradient = S * x - r;
    const double away = (x - (x - gradient.cwiseQuotient(stiffness)).cwiseMax(0)).cwiseAbs().maxCoeff();
    const double near = std::min(1e-6 * x.cwiseAbs().maxCoeff(), away);
    for (Eigen::Index i = 0; i < n; ++i) c.closed[i] = x[i] <= near && gradient[i] > 0;
    c.jump = open_jumps(S, r, c.closed);
    c.force = S * c.jump - r;
    if (wrong_points(c, load).empty()) return true;
    const Eigen::VectorXd direction = c.jump - x;
    Eigen::VectorXd next = x;
    double share = 1;
    bool lower = false;
    for (int halving = 0; halving < 50 && !lower; ++halving, share *= 0.5) {
      next = (x + share * direction).cwiseMax(0);
      const Eigen::VectorXd move = next - x;
      const double slope = gradient.dot(move);
      lower = slope < 0 && slope + 0.5 * move.dot(S * move) <= 1e-4 * slope;
    }
    if (!lower) return false;
    x = next;
  }
  return false;
}

}  // namespace

Contact solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, std::vector<bool> closed) {
  const Eigen::Index n = r.size();
  Contact c;
  c.closed = std::move(closed);
  c.closed.resize(n, false);
  if (n == 0) return c;
  // A step costs n^3: a budget in work, so that no contact problem can run for ever.
  constexpr double most_work = 1e12;
  const int budget = static_cast<int>(std::clamp(most_work / std::pow(static_cast<double>(n), 3), 60.0, 5000.0));
  constexpr int trust = 10;  // exchanges in a row that need not help
  const double load = r.cwiseAbs().maxCoeff();
  std::size_t fewest = static_cast<std::size_t>(n) + 1;
  c.converged = false;
  for (int patience = trust; patience > 0;) {
    ++c.iterations;
    c.jump = open_jumps(S, r, c.closed);
    c.force = S * c.jump - r;
    const std::vector<Eigen::Index> wrong = wrong_points(c, load);
    if (wrong.empty()) {
      c.converged = true;
      break;
    }
    patience = wrong.size() < fewest ? trust : patience - 1;
    fewest = std::min(fewest, wrong.size());
    for (const Eigen::Index i : wrong) c.closed[i] = !c.closed[i];
  }
  if (!c.converged) c.converged = projected_newton(S, r, budget, c);
  for (Eigen::Index i = 0; i < n; ++i)
    if (!c.closed[i]) c.force[i] = 0;
  return c;
}

}  // namespace kerf
