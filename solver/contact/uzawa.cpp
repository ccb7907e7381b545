// Uzawa's projected iteration for contact and friction, the reference that the active set is checked with:
//   j <- prox(y - rho (S y - r)),   rho = 0.99/lambda_max,   y = j + beta (j - j_before),
//   beta = (1 - q)/(1 + q),   q = (lambda_min/lambda_max)^(1/2)   [Nesterov 2004, (2.2.11); theory: C.9].
// prox projects normal jumps onto j >= 0 and shrinks tangential ones by rho times their limit at the present pressure.
// The momentum is dropped in steps where it points uphill [O'Donoghue, Candes 2015]. The number of steps grows like the
// root of the condition of S, about 1/h. Derived in docs/theory/contact.md, section Algorithms.

#include "kerf/stop.hpp"
#include "solver/contact/law.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

struct Spectrum {
  double lowest = 0, highest = 0;
};

// Ends of the spectrum of S by Lanczos, reorthogonalized, from a start without symmetry: highest from
// below and lowest from above, until both stand to 1e-3.
// Eigenvalues of the Lanczos matrix lie inside the spectrum; 0.99/highest leaves room for what the largest one lacks. A
// lowest one that is too large costs steps, not the solution.
Spectrum spectrum(const Eigen::MatrixXd& S, int& products) {
  const Eigen::Index n = S.rows(), most = std::min<Eigen::Index>(n, 200);
  Eigen::MatrixXd basis(n, most);
  Eigen::VectorXd diagonal(most), beside(most);
  basis.col(0) = Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return 1 + std::sin(1.0 + 7.0 * double(i)); });
  basis.col(0).normalize();
  Spectrum ends;
  for (Eigen::Index k = 0; k < most; ++k) {
    Eigen::VectorXd w = S * basis.col(k);
    ++products;
    diagonal[k] = basis.col(k).dot(w);
    for (int pass = 0; pass < 2; ++pass) w -= basis.leftCols(k + 1) * (basis.leftCols(k + 1).transpose() * w);
    beside[k] = w.norm();
    const bool last = k + 1 == most || !(beside[k] > 1e-12 * diagonal.head(k + 1).maxCoeff());
    if (last || k % 10 == 9) {
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
      ritz.computeFromTridiagonal(diagonal.head(k + 1), beside.head(k), Eigen::EigenvaluesOnly);
      const Spectrum before = ends;
      ends = {ritz.eigenvalues()[0], ritz.eigenvalues()[k]};
      const bool still = std::abs(ends.lowest - before.lowest) <= 1e-3 * ends.lowest &&
                         std::abs(ends.highest - before.highest) <= 1e-3 * ends.highest;
      if (last || still) return ends;
    }
    basis.col(k + 1) = w / beside[k];
  }
  return ends;
}

}  // namespace

// Rounding of S x, epsilon |S| |x|, bounds what kkt can reach: looked at every hundred steps, since it costs a product.
Contact uzawa(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<ContactPoint>& points) {
  const Eigen::Index n = r.size();
  Contact c;
  c.jump = c.force = Eigen::VectorXd::Zero(n);
  c.motion.assign(n, Motion::Held);
  const double load = n > 0 ? r.cwiseAbs().maxCoeff() : 0;
  if (load == 0) return c;
  const Spectrum ends = spectrum(S, c.solves);
  const double ratio = std::sqrt(std::max(ends.lowest / ends.highest, 0.0)), momentum = (1 - ratio) / (1 + ratio);
  const double step = 0.99 / ends.highest;

  constexpr double most_work = 1e11, target = 1e-12;
  const int most = static_cast<int>(std::clamp(most_work / (2.0 * double(n) * double(n)), 1e3, 1e5));
  Eigen::VectorXd x = c.jump, product = Eigen::VectorXd::Zero(n), y = x, product_y = product;
  double floor = 0;  // of kkt, by the rounding of S x
  c.converged = false;
  while (!c.converged && std::isfinite(c.kkt) && c.iterations < most) {
    check_stop();
    ++c.iterations;
    const Eigen::VectorXd raw = y - step * (product_y - r);
    Eigen::VectorXd next = raw;
    for (const ContactPoint& p : points) {
      next[p.normal] = std::max(raw[p.normal], 0.0);
      if (p.tangential == none) continue;
      const double pressure = (next[p.normal] - raw[p.normal]) / step;
      const double give = step * (p.slip_bound + p.friction * pressure);
      next[p.tangential] = raw[p.tangential] - std::clamp(raw[p.tangential], -give, give);
    }
    const Eigen::VectorXd next_product = S * next, move = next - x;
    ++c.solves;
    const bool uphill = (y - next).dot(move) > 0;
    const double beta = uphill ? 0 : momentum;
    y = next + beta * move;
    product_y = next_product + beta * (next_product - product);
    x = next;
    product = next_product;
    if (c.iterations % 100 == 0)
      floor = std::numeric_limits<double>::epsilon() * (S.cwiseAbs() * x.cwiseAbs()).maxCoeff() / load;
    c.kkt = optimality(points, x, product - r, load);
    c.converged = c.kkt <= std::max(target, 4 * floor);
  }
  c.jump = x;
  c.force = product - r;
  const Admissible allowed = admissible(points, c.force);
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool free = allowed.low[i] == allowed.high[i];
    c.motion[i] = x[i] > 0 || (free && x[i] == 0) ? Motion::Forward : x[i] < 0 ? Motion::Backward : Motion::Held;
    if (c.motion[i] != Motion::Held) c.force[i] = x[i] < 0 ? allowed.high[i] : allowed.low[i];
  }
  return c;
}

}  // namespace kerf
