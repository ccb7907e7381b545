// min 1/2 d.H d + g.d under A d <= b by its dual, min 1/2 m.S m - r.m over m >= 0 with S = A H^-1 A', r = -A H^-1 g -
// b, and d = -H^-1 (g + A'm) [Lawson, Hanson 1974].

#include "optimize/curves/quadratic.hpp"

#include "base/dense.hpp"

#include <algorithm>
#include <vector>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// min 1/2 m.S m - r.m over m >= 0, S positive definite: Lawson and Hanson's method on the normal equations.
VectorXd nonnegative(const MatrixXd& S, const VectorXd& r) {
  const Eigen::Index n = r.size();
  VectorXd m = VectorXd::Zero(n), gain = r;
  std::vector<Eigen::Index> passive;
  std::vector<bool> in(std::size_t(n), false);
  const double small = 1e-12 * r.cwiseAbs().maxCoeff();
  for (Eigen::Index round = 0; round < 3 * n + 10; ++round) {
    Eigen::Index enter = -1;
    for (Eigen::Index i = 0; i < n; ++i)
      // The one with the largest multiplier that it would have alone, gain over S_ii.
      if (!in[std::size_t(i)] && gain[i] > small && (enter < 0 || gain[i] / S(i, i) > gain[enter] / S(enter, enter)))
        enter = i;
    if (enter < 0) break;
    passive.push_back(enter);
    in[std::size_t(enter)] = true;
    // On the way from m to the unconstrained minimum of the passive set the first that becomes 0 leaves it.
    while (!passive.empty()) {
      const VectorXd z = solve_symmetric(S(passive, passive), r(passive));
      if (z.minCoeff() > 0) {
        m.setZero();
        m(passive) = z;
        break;
      }
      double part = 1;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        const double from = m[passive[k]], to = z[Eigen::Index(k)];
        if (to <= 0) part = std::min(part, from / (from - to));
      }
      std::vector<Eigen::Index> left;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        double& x = m[passive[k]];
        x += part * (z[Eigen::Index(k)] - x);
        if (x > 1e-300 && !(z[Eigen::Index(k)] <= 0 && x <= 1e-14 * m.cwiseAbs().maxCoeff()))
          left.push_back(passive[k]);
        else
          x = 0, in[std::size_t(passive[k])] = false;
      }
      if (left.size() == passive.size()) break;
      passive = std::move(left);
    }
    gain = r - multiply(S, m);
    for (const Eigen::Index i : passive) gain[i] = 0;
  }
  return m;
}

}  // namespace

QuadraticStep quadratic_step(const Eigen::LLT<MatrixXd>& H, const VectorXd& g, const MatrixXd& A, const VectorXd& b,
                             const VectorXd& soft) {
  // The minimum without constraints; with none that is all.
  const VectorXd free = -solve(H, g);
  if (A.rows() == 0) return {free, VectorXd()};
  // Rows of like size, so that one bound softens all.
  // S = A H^-1 A' = (L^-1 A')' (L^-1 A').
  const MatrixXd half = solve_lower(H, A.transpose());
  const VectorXd size = half.colwise().norm().transpose().cwiseMax(1e-300);
  MatrixXd S = size.cwiseInverse().asDiagonal() * transposed_multiply(half, half) * size.cwiseInverse().asDiagonal();
  // Contradicting rows have a singular S and multipliers without a bound; 1e-9 of each row's own size bounds them.
  S.diagonal().array() += 1e-9;
  for (Eigen::Index k = 0; k < soft.size(); ++k) S(k, k) += soft[k] / (size[k] * size[k]);
  const VectorXd m = nonnegative(S, (multiply(A, free) - b).cwiseQuotient(size)).cwiseQuotient(size);
  return {free - solve(H, transposed_multiply(A, m)), m};
}

}  // namespace kerf
