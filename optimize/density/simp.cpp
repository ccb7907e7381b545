// Penalized densities on a lattice: compliances and their derivatives, two methods of steps, and the density made black
// and white.
//   E = eps + (1 - eps) rho^p [Bendsoe 1989; theory: P.2], under body force rho/(1 + q (1 - rho)) [theory: P.3]
//   dC_k/drho = 2 df_k/drho . u_k - E'(rho) u_k.K u_k                                             [theory: P.4]
// Optimality criteria scale each density by (gain/price)^(1/2) with the price that gives the area, found by bisection
// [Sigmund 2001; theory: P.6]. All other goals go to moving asymptotes (mma.cpp), in units of the goal at the start.
// Filter radius and exponent go evenly from their first to their last values. After every step densities are rounded to
// 2^-24, so that the rounding of the solver, which differs between machines, hardly ever changes a bit of them. Black
// and white is the set above a level of the bilinear density, by 16 samples per cell [theory: P.8]. Derived in
// docs/theory/density.md.

#include "optimize/density/simp.hpp"

#include "optimize/density/mma.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double fine = 0x1p24;  // densities are multiples of 1/fine: rounding in the solver rarely changes one

double volume(const Lattice& l, const Eigen::VectorXd& density) {
  return l.part.dot(density);
}

bool solid(const Lattice& l, Index cell) {
  return l.solid[static_cast<std::size_t>(cell)] != 0;
}

/// Solid cells full, the others even.
/// The area that is left is spread evenly, to a density of 1 % at least.
Eigen::VectorXd even_density(const Lattice& l, double area) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(l.part.size());
  double fixed = 0;
  for (const Index c : l.cells)
    if (solid(l, c)) fixed += l.part[c];
  const double even = std::clamp((area - fixed) / std::max(l.part.sum() - fixed, 1e-9), 0.01, 1.0);
  for (const Index c : l.cells) x[c] = solid(l, c) ? 1 : even;
  return x;
}

}  // namespace

void round_off(Eigen::VectorXd& x) {
  x = (x * fine).array().round() / fine;
}

namespace {

double on_the_way(double first, double last, int step, const Schedule& how) {
  return step >= how.change_steps ? last : first + (last - first) * step / how.change_steps;
}

/// The filter of a step; made anew while its radius changes.
class ShrinkingFilter {
 public:
  ShrinkingFilter(const Lattice& l, const Schedule& how) : l_(l), how_(how) {}
  const LatticeFilter& at(int step) {
    const double radius = on_the_way(how_.first_radius, how_.radius, step, how_);
    if (!filter_ || radius != radius_) filter_ = std::make_unique<LatticeFilter>(l_, radius);
    radius_ = radius;
    return *filter_;
  }

 private:
  const Lattice& l_;
  const Schedule& how_;
  double radius_ = 0;
  std::unique_ptr<LatticeFilter> filter_;
};

/// The multiplicative step [theory: P.6] of the price that gives the area.
Eigen::VectorXd criteria_step(const Lattice& l, const Eigen::VectorXd& x, const Eigen::VectorXd& gain, double area,
                              double move) {
  Eigen::VectorXd next = x;
  const auto step = [&](double price) {
    for (const Index c : l.cells)
      if (!solid(l, c))
        next[c] = std::clamp(x[c] * std::sqrt(gain[c] / price), std::max(0.0, x[c] - move), std::min(1.0, x[c] + move));
    return volume(l, next);
  };
  // Bisection in the logarithm: prices span many orders of magnitude.
  double low = 1e-12 * gain.maxCoeff(), high = 1e6 * gain.maxCoeff();
  while (high > (1 + 1e-8) * low) {
    const double price = std::sqrt(low * high);
    (step(price) > area ? low : high) = price;
  }
  return next;
}

}  // namespace

double Stiffening::stiffness(double density) const {
  return least + (1 - least) * (rational ? density / (1 + exponent * (1 - density)) : std::pow(density, exponent));
}

double Stiffening::derivative(double density) const {
  // d/drho of rho/(1 + q (1 - rho)) is (1 + q)/(1 + q (1 - rho))^2.
  const double below = 1 + exponent * (1 - density);
  return (1 - least) * (rational ? (1 + exponent) / (below * below) : exponent * std::pow(density, exponent - 1));
}

LoadedLattice loaded(const Lattice& l, const Stiffening& law, const Eigen::VectorXd& density) {
  LoadedLattice out{Eigen::VectorXd::Zero(density.size()), Eigen::VectorXd::Zero(density.size()), l.force};
  for (const Index c : l.cells) out.stiffness[c] = law.stiffness(density[c]), out.slope[c] = law.derivative(density[c]);
  for (std::size_t k = 0; k < l.body.size(); ++k)
    for (const Index c : l.cells)
      for (const Index v : l.corners(c))
        out.force.block<2, 1>(2 * v, static_cast<Eigen::Index>(k)) += density[c] / 4 * l.body[k].col(c);
  return out;
}

Compliances compliances(const Lattice& l, LatticeStiffness& stiffness, const Stiffening& law,
                        const Eigen::VectorXd& density) {
  const auto [relative, slope, force] = loaded(l, law, density);
  const Eigen::MatrixXd u = stiffness.displacements(relative, force);
  Compliances all{force.cwiseProduct(u).colwise().sum().transpose(), Eigen::MatrixXd(density.size(), force.cols())};
  for (Eigen::Index k = 0; k < force.cols(); ++k) {
    all.by_density.col(k) = -slope.cwiseProduct(cell_energies(l, u.col(k)));
    if (l.body.empty()) continue;
    for (const Index c : l.cells) {
      Vec2 mean = Vec2::Zero();
      for (const Index v : l.corners(c)) mean += u.block<2, 1>(2 * v, k) / 4;
      all.by_density(c, k) += 2 * l.body[static_cast<std::size_t>(k)].col(c).dot(mean);
    }
  }
  return all;
}

// Gains per area; those of the wrong sign, by smoothing, count as none.
Densities optimality_criteria(const Lattice& l, const LatticePattern& pattern, const LatticeGoal& goal,
                              const Schedule& how) {
  const LatticeMirror mirror(l);
  ShrinkingFilter filter(l, how);
  LatticeStiffness stiffness(l, pattern);
  Densities d{how.start.size() > 0 ? how.start : even_density(l, *goal.area), 0};
  Eigen::VectorXd& x = d.density;
  while (d.steps < how.most_steps) {
    const Stiffening law{.exponent = on_the_way(how.first_exponent, how.exponent, d.steps, how)};
    const Compliances now = compliances(l, stiffness, law, x);
    Eigen::VectorXd gain = -mirror.symmetrized(filter.at(d.steps).smooth_derivative(x, now.by_density * goal.weights));
    for (const Index c : l.cells) gain[c] = std::max(gain[c], 0.0) / l.part[c];
    ++d.steps;
    if (!(gain.maxCoeff() > 0)) break;
    Eigen::VectorXd next = mirror.symmetrized(criteria_step(l, x, gain, *goal.area, how.move));
    round_off(next);
    const double change = (next - x).cwiseAbs().maxCoeff();
    x = next;
    if (change < how.least_change && d.steps > how.change_steps) break;
  }
  return d;
}

namespace {

/// A goal as MMA sees it: in variables of the cells that are not solid, in units of its start.
class AsymptoteProblem {
 public:
  AsymptoteProblem(const Lattice& l, const LatticePattern& pattern, const LatticeGoal& goal)
      : l_(l), goal_(goal), mirror_(l), stiffness_(l, pattern) {
    for (const Index c : l.cells)
      if (!solid(l, c)) free_.push_back(c);
  }
  Eigen::VectorXd free_part(const Eigen::VectorXd& x) const {
    Eigen::VectorXd part(static_cast<Eigen::Index>(free_.size()));
    for (std::size_t i = 0; i < free_.size(); ++i) part[static_cast<Eigen::Index>(i)] = x[free_[i]];
    return part;
  }
  void set_free(Eigen::VectorXd& x, const Eigen::VectorXd& part) const {
    for (std::size_t i = 0; i < free_.size(); ++i) x[free_[i]] = part[static_cast<Eigen::Index>(i)];
    x = mirror_.symmetrized(x);
    round_off(x);
  }
  /// Of the variables. Without body force the variables are the densities, and derivatives are smoothed: that leaves
  /// less grey.
  Eigen::VectorXd density(const LatticeFilter& filter, const Eigen::VectorXd& x) const {
    if (l_.body.empty()) return x;
    Eigen::VectorXd density = filter.average(x);
    for (const Index c : l_.cells)
      if (solid(l_, c)) density[c] = 1;
    return density;
  }
  MmaPoint at(const LatticeFilter& filter, const Stiffening& law, const Eigen::VectorXd& x);

 private:
  const Lattice& l_;
  const LatticeGoal& goal_;
  LatticeMirror mirror_;
  LatticeStiffness stiffness_;
  std::vector<Index> free_;
  double unit_ = 0;  // of the goal's gradient
};

MmaPoint AsymptoteProblem::at(const LatticeFilter& filter, const Stiffening& law, const Eigen::VectorXd& x) {
  const Eigen::VectorXd density = this->density(filter, x);
  const Compliances now = compliances(l_, stiffness_, law, density);
  MmaPoint point;
  // By the variables: smoothed where they are the densities, through the averages where these are. Solid cells have
  // none.
  const auto by = [&](Eigen::VectorXd by_density) {
    for (const Index c : l_.cells)
      if (solid(l_, c)) by_density[c] = 0;
    return free_part(
        mirror_.symmetrized(l_.body.empty() ? filter.smooth_derivative(x, by_density) : filter.pull_back(by_density)));
  };
  const Eigen::VectorXd area_by = free_part(l_.body.empty() ? l_.part : mirror_.symmetrized(filter.pull_back(l_.part)));
  point.objective_by = by(now.by_density * goal_.weights) + goal_.price * area_by;
  // Gradients of relative values: the constraints' are of the order of 1 over the number of cells.
  if (unit_ == 0) unit_ = goal_.weights.dot(now.value) + goal_.price * l_.part.sum();
  point.objective_by /= unit_;
  std::vector<std::pair<double, Eigen::VectorXd>> bounds;
  if (goal_.area) bounds.emplace_back(volume(l_, density) / *goal_.area - 1, area_by / *goal_.area);
  for (Eigen::Index k = 0; k < goal_.most.size(); ++k)
    if (goal_.most[k] < infinity)
      bounds.emplace_back(now.value[k] / goal_.most[k] - 1, by(now.by_density.col(k)) / goal_.most[k]);
  point.g.resize(static_cast<Eigen::Index>(bounds.size()));
  point.by.resize(point.objective_by.size(), point.g.size());
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    point.g[static_cast<Eigen::Index>(i)] = bounds[i].first;
    point.by.col(static_cast<Eigen::Index>(i)) = bounds[i].second;
  }
  return point;
}

}  // namespace

// Without an area that bounds it the body begins half full.
Densities moving_asymptotes(const Lattice& l, const LatticePattern& pattern, const LatticeGoal& goal,
                            const Schedule& how) {
  ShrinkingFilter filter(l, how);
  AsymptoteProblem problem(l, pattern, goal);
  Eigen::VectorXd x = how.start.size() > 0 ? how.start : even_density(l, goal.area.value_or(0.5 * l.part.sum()));
  const Eigen::Index n = problem.free_part(x).size();
  Mma mma(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Ones(n), how.move, l.body.empty());
  Densities d;
  while (d.steps < how.most_steps) {
    const Stiffening law{.exponent = on_the_way(how.first_exponent, how.exponent, d.steps, how),
                         .rational = !l.body.empty()};
    const MmaPoint now = problem.at(filter.at(d.steps), law, x);
    ++d.steps;
    const Eigen::VectorXd before = x;
    problem.set_free(x, mma.step(problem.free_part(x), now));
    if ((x - before).cwiseAbs().maxCoeff() < how.least_change && d.steps > how.change_steps) break;
  }
  d.density = problem.density(filter.at(how.change_steps), x);
  return d;
}

// Solid cells are above every level. The level that leaves at most the area, by bisection.
Eigen::VectorXd black_and_white(const Lattice& l, const Eigen::VectorXd& density, double area) {
  constexpr int across = 4;
  constexpr int samples = across * across;
  Eigen::VectorXd continued = density;
  for (Eigen::Index c = 0; c < density.size(); ++c) continued[c] = density[l.inside[static_cast<std::size_t>(c)]];
  Eigen::MatrixXd at(samples, static_cast<Eigen::Index>(l.cells.size()));
  for (std::size_t k = 0; k < l.cells.size(); ++k)
    for (int i = 0; i < samples; ++i) {
      const Vec2 x = l.center(l.cells[k]) + Vec2((i % across + 0.5) / across - 0.5, (i / across + 0.5) / across - 0.5);
      double value = 0;
      for (const auto& [cell, weight] : between_centers(l.columns, l.rows, x)) value += weight * continued[cell];
      at(i, static_cast<Eigen::Index>(k)) = l.solid[static_cast<std::size_t>(l.cells[k])] ? infinity : value;
    }
  Eigen::VectorXd share = Eigen::VectorXd::Zero(density.size());
  const auto above = [&](double level) {
    for (std::size_t k = 0; k < l.cells.size(); ++k)
      share[l.cells[k]] = static_cast<double>((at.col(static_cast<Eigen::Index>(k)).array() > level).count()) / samples;
    return volume(l, share);
  };
  double low = -1e-9, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double level = (low + high) / 2;
    (above(level) > area ? low : high) = level;
  }
  above(high);
  return share;
}

}  // namespace kerf
