// Designs to begin with: the nearest to a given one that can be drawn, and a sequence of places that fills the boxes.
// The nearest design minimizes 1/2 |(y - x)/box|^2 under the constraints on the geometry, by slsqp, without any state;
// from where that gets stuck (two things at the same place do not know which way to go) it begins again at up to 12
// other places. Places are x_i = frac(1/2 + k g^-i) with g^(n+1) = g + 1 [Roberts 2018], which fill a box of n
// variables evenly for any number of them. docs/theory/level_set.md, section "Drawn designs".

#include "optimize/parametric/start.hpp"

#include "kerf/optimize.hpp"
#include "optimize/parametric/minimize.hpp"
#include "optimize/parametric/shapes/shape.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;

constexpr double bearable_start = 0.5;  // of a constraint on the geometry: minimizers lead back from there

// Without constraints -infinity.
double worst(const std::vector<Constraint>& all, const VectorXd& x, std::string* name) {
  double most = -infinity;
  for (const Constraint& c : all) {
    const double value = c.value(x, nullptr);
    if (!(value > most)) continue;
    most = value;
    if (name) *name = c.name;
  }
  return most;
}

}  // namespace

double least_distance(const Problem& p, const OptimizeRequest& r) {
  return r.min_distance > 0 ? r.min_distance : mesh_size(p) / 2;
}

// Integrals over a ring around a feature need plain material in it.
std::vector<Forbidden> forbidden_discs(const Problem& p, const OptimizeRequest& r) {
  std::vector<Forbidden> discs;
  const auto look = [&discs](const Functional& j) {
    for (const Term& term : j.terms)
      if (term.feature_radius > 0)
        discs.push_back(
            {fmt::format("the ring of {} at ({:.4g}, {:.4g})", term.kind, term.feature.x(), term.feature.y()),
             term.feature, term.feature_radius});
  };
  look(p.objective);
  for (const FunctionalBound& bound : r.bounds) look(bound.functional);
  return discs;
}

VectorXd place_in(const VectorXd& lower, const VectorXd& upper, int number) {
  // x_i = frac(1/2 + number a_i), a_i = g^-i, g^(n+1) = g + 1 [Roberts 2018].
  const auto n = static_cast<double>(lower.size());
  // 60 iterations of the fixed point: converged to rounding.
  double g = 2;
  for (int i = 0; i < 60; ++i) g = std::pow(1 + g, 1 / (n + 1));
  VectorXd x(lower.size());
  double a = 1;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    a /= g;
    const double part = 0.5 + number * a;
    x[i] = std::clamp(lower[i] + (part - std::floor(part)) * (upper[i] - lower[i]), lower[i], upper[i]);
  }
  return x;
}

std::optional<VectorXd> repaired(const VectorXd& x, const Problem& p, const OptimizeRequest& r, std::string* obstacle) {
  const VectorXd lower = lower_bounds(r.design), upper = upper_bounds(r.design);
  const std::vector<Constraint> all = constraints(r.design, p, least_distance(p, r), forbidden_discs(p, r));
  const auto problem = find_problem(body_of(r.design, x, p).shape);
  std::string first;
  const double violated = worst(all, x, &first);
  if (!problem && violated <= bearable_start) return x;
  if (obstacle) *obstacle = problem.value_or(first);
  Program program{.lower = lower, .upper = upper, .constraints = static_cast<Eigen::Index>(all.size())};
  constexpr double margin = 0.01;  // so that the last digit does not matter
  program.evaluate = [&](const VectorXd& y, bool) {
    Evaluation e{.x = y};
    e.values.resize(1 + program.constraints);
    e.gradients.resize(y.size(), 1 + program.constraints);
    e.values[0] = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const double width = upper[i] - lower[i];
      // Fixed variables have no box to be measured in and stay.
      const double away = width > 0 ? (y[i] - x[i]) / width : 0;
      e.values[0] += 0.5 * away * away;
      e.gradients(i, 0) = width > 0 ? away / width : 0;
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
      VectorXd g;
      const auto column = static_cast<Eigen::Index>(k) + 1;
      e.values[column] = all[k].value(y, &g) + margin;
      e.gradients.col(column) = g;
    }
    return e;
  };
  // Things at the same place do not know where to go: then, and where a minimization gets stuck, from other places.
  std::optional<VectorXd> best;
  double least = infinity;
  constexpr int places = 12;
  // Two at least: the first one may have found a far design. Later ones begin farther away.
  for (int k = 0; k <= places && (k < 2 || !best); ++k) {
    const VectorXd from = k == 0 ? x : VectorXd(x + (place_in(lower, upper, k) - x) * std::min(1.0, 0.1 * k));
    const Minimum found = minimize(program, from, OptimizeMethod::Slsqp, {.evaluations = 200, .scale = 1});
    const VectorXd& y = found.best.x;
    if (!(worst(all, y, nullptr) <= 0) || find_problem(body_of(r.design, y, p).shape)) continue;
    if (found.best.values[0] >= least) continue;
    least = found.best.values[0];
    best = y;
  }
  return best;
}

}  // namespace kerf
