// A density under bounds on largest stresses. Variables x per cell are averaged over discs, m = W x, and projected,
//   rho = (tanh(b/2) + tanh(b (m - 1/2))) / (2 tanh(b/2)),   b = 1, 2, 4, .. 32 [Wang, Lazarov, Sigmund 2011;
// theory: P.9],
// stiff as rho^3. The stress of a cell is sqrt(rho) times that of its solid at its center [Bruggi 2008], over the
// bound, and a load case has one constraint: the p-norm of it, p = 12, times a factor c that follows largest/norm [Le,
// Norato, Bruns, Ha, Tortorelli 2010; theory: P.10]. J and the constraints go to moving asymptotes. It begins with the
// full body, which keeps most bounds: from an even density the norm has no derivative that leads anywhere. A step after
// which a norm has risen by 0.15 is undone and made again with 0.4 of its length. Sharp corners of the frame are void
// from the start, since designs cling to them. What is handed on is m, smooth where rho is a staircase; both cross 1/2
// at the same place.
// docs/theory/density.md, section "Stress".

#include "optimize/density/stress_design.hpp"

#include "geometry/plane.hpp"
#include "kerf/max_stress.hpp"
#include "optimize/constraints/sides.hpp"
#include "optimize/density/mma.hpp"
#include "optimize/density/stage.hpp"
#include "optimize/level_set/solid.hpp"
#include "optimize/loop/evaluate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double cells_in_all = 6000;    // of the lattice
constexpr double filter_of_body = 0.02;  // radius, in diagonals of the body
constexpr double least_filter = 2.5;     // in cells
constexpr double hollow_of_body = 0.025;
constexpr double furthest = 0.1;      // move of a variable,
constexpr double of_sharpness = 0.4;  // and that times the sharpness: of a density
constexpr double rise = 0.15, slight_rise = 0.02, rise_of_sharpening = 0.5, least_sharpening = 1.25, shorter_step = 0.4;
constexpr int most_shortened = 4;
constexpr double sharpest_projection = 32;
constexpr int steps_each = 25, last_steps = 50, most_steps = 400;  // per sharpness, and in all
constexpr double damping = 0.5;                                    // of the factor of a norm
constexpr double enough_of_cell = 0.5;                             // in the body, for its stress to count

/// What is not measured is used: a density would become a neck along a clamp, where cells see little of what is
/// singular there.
Term beside_supports(LargestStress what) {
  std::erase_if(what.zones, [](const StressZone& zone) { return zone.support; });
  return max_stress(what);
}

struct Projection {
  double sharpness = 1;
  double operator()(double m) const {
    const double half = std::tanh(sharpness / 2);
    return (half + std::tanh(sharpness * (m - 0.5))) / (2 * half);
  }
  double slope(double m) const {
    const double t = std::tanh(sharpness * (m - 0.5));
    return sharpness * (1 - t * t) / (2 * std::tanh(sharpness / 2));
  }
};

/// Per load case and stress bound (bounds count fastest), over the bound.
struct StressedValues {
  Eigen::VectorXd compliance, norm, largest;
  Eigen::MatrixXd compliance_by, norm_by;  // per cell, by its density
};

class StressedLattice {
 public:
  StressedLattice(const Problem& p, const OptimizeRequest& r)
      : stage(density_stage(p, r, std::max(density_cells(p, r), cells_in_all))),
        pattern_(lattice_pattern(stage.lattice)),
        stiffness_(stage.lattice, pattern_) {
    for (const FunctionalBound& b : r.bounds)
      for (const Term& term : b.functional.terms)
        if (term.largest)
          bounds_.push_back(
              {beside_supports(*term.largest), stage.lattice.force_unit / stage.lattice.cell / b.at_most});
    const Lattice& l = stage.lattice;
    std::vector<Region> regions;
    for (const Loop& loop : p.frame.regions) regions.emplace_back(loop);
    for (const Index c : l.cells) {
      const Vec2 x = l.origin + l.cell * l.center(c);
      Material material = p.scene.material;
      for (std::size_t i = 0; i < regions.size(); ++i)
        if (regions[i].depth(x) > 0) material = p.scene.regions[i];
      cells_.push_back({x, material});
    }
  }

  StressedValues at(const Eigen::VectorXd& density);

  DensityStage stage;

 private:
  struct Bound {
    Term term;
    double unit;  // stress of the lattice over the bound
  };
  struct CellPlace {
    Vec2 x;
    Material material;
  };
  /// The sum of powers of a bound's stresses for one column of displacements, and its derivatives.
  struct Sum {
    double sum = 0, largest = 0;
    Eigen::VectorXd by_density, by_displacement;
  };
  Sum sum_of(const Bound& b, const Eigen::VectorXd& density, const Eigen::Ref<const Eigen::VectorXd>& u) const;

  LatticePattern pattern_;
  LatticeStiffness stiffness_;
  std::vector<Bound> bounds_;
  std::vector<CellPlace> cells_;
};

StressedLattice::Sum StressedLattice::sum_of(const Bound& b, const Eigen::VectorXd& density,
                                             const Eigen::Ref<const Eigen::VectorXd>& u) const {
  constexpr double p = largest_stress_power;
  constexpr std::array<double, 4> sx{-1, 1, 1, -1}, sy{-1, -1, 1, 1};
  const Lattice& l = stage.lattice;
  Sum s{.by_density = Eigen::VectorXd::Zero(density.size()), .by_displacement = Eigen::VectorXd::Zero(u.size())};
  for (std::size_t k = 0; k < l.cells.size(); ++k) {
    const Index c = l.cells[k];
    if (l.part[c] < enough_of_cell || !(density[c] > 0)) continue;
    const std::array<Index, 4> corners = l.corners(c);
    Mat2 gradient = Mat2::Zero();  // d_j u_i at the center of a cell of length 1
    for (std::size_t i = 0; i < 4; ++i)
      gradient += u.segment<2>(2 * corners[i]) * Vec2(sx[i] / 2, sy[i] / 2).transpose();
    const double mu = b.unit * l.mu[c] / l.part[c], lambda = b.unit * l.lambda[c] / l.part[c];
    FieldPoint at{.x = cells_[k].x, .material = cells_[k].material};
    at.stress = mu * (gradient + gradient.transpose()) + lambda * gradient.trace() * Mat2::Identity();
    const Density d = b.term.density(at);
    if (d.value == 0) continue;
    const double relaxed = std::pow(density[c], p / 2), share = l.part[c] * relaxed;
    s.sum += share * d.value;
    s.largest = std::max(s.largest, std::pow(relaxed * d.value, 1 / p));
    s.by_density[c] = l.part[c] * p / 2 * relaxed / density[c] * d.value;
    const Mat2 by =
        share * (mu * (d.by_stress + d.by_stress.transpose()) + lambda * d.by_stress.trace() * Mat2::Identity());
    for (std::size_t i = 0; i < 4; ++i) s.by_displacement.segment<2>(2 * corners[i]) += by * Vec2(sx[i] / 2, sy[i] / 2);
  }
  return s;
}

// With K a = dS/du the derivative of a sum S is S_rho - E' a.K u + df/drho . a, in the unit of S to keep digits.
StressedValues StressedLattice::at(const Eigen::VectorXd& density) {
  const Lattice& l = stage.lattice;
  const LoadedLattice loads = loaded(l, {}, density);
  const Eigen::VectorXd &relative = loads.stiffness, &slope = loads.slope;
  const Eigen::MatrixXd& force = loads.force;
  const Eigen::MatrixXd u = stiffness_.displacements(relative, force);
  const Eigen::Index cases = force.cols(), bounds = static_cast<Eigen::Index>(bounds_.size());
  StressedValues v{.compliance = force.cwiseProduct(u).colwise().sum().transpose(),
                   .norm = Eigen::VectorXd(cases * bounds),
                   .largest = Eigen::VectorXd(cases * bounds),
                   .compliance_by = Eigen::MatrixXd(density.size(), cases),
                   .norm_by = Eigen::MatrixXd(density.size(), cases * bounds)};
  const auto work_of_body = [&](Eigen::Index k, const Eigen::VectorXd& w) {
    Eigen::VectorXd work = Eigen::VectorXd::Zero(density.size());
    if (!l.body.empty())
      for (const Index c : l.cells)
        for (const Index node : l.corners(c))
          work[c] += w.segment<2>(2 * node).dot(l.body[static_cast<std::size_t>(k)].col(c)) / 4;
    return work;
  };
  Eigen::MatrixXd right(u.rows(), cases * bounds);
  std::vector<Sum> sums;
  for (Eigen::Index k = 0; k < cases; ++k) {
    v.compliance_by.col(k) = -slope.cwiseProduct(cell_energies(l, u.col(k))) + 2 * work_of_body(k, u.col(k));
    for (Eigen::Index b = 0; b < bounds; ++b) {
      sums.push_back(sum_of(bounds_[static_cast<std::size_t>(b)], density, u.col(k)));
      right.col(k * bounds + b) = sums.back().by_displacement / std::max(sums.back().sum, 1e-300);
    }
  }
  const Eigen::MatrixXd adjoint = stiffness_.displacements(relative, right);
  for (Eigen::Index i = 0; i < cases * bounds; ++i) {
    const Sum& s = sums[static_cast<std::size_t>(i)];
    const auto state = u.col(i / bounds);
    // 4 a.K u = (u + a).K (u + a) - (u - a).K (u - a), both of one size.
    const double size = adjoint.col(i).norm() > 0 ? state.norm() / adjoint.col(i).norm() : 1;
    const Eigen::VectorXd a = size * adjoint.col(i);
    const Eigen::VectorXd product = (cell_energies(l, state + a) - cell_energies(l, state - a)) / (4 * size);
    v.norm[i] = std::pow(s.sum, 1 / largest_stress_power);
    v.largest[i] = s.largest;
    v.norm_by.col(i) = v.norm[i] / largest_stress_power *
                       (s.by_density / std::max(s.sum, 1e-300) - slope.cwiseProduct(product) +
                        work_of_body(i / bounds, adjoint.col(i)));
  }
  return v;
}

/// The variables, and the steps.
class StressRun {
 public:
  StressRun(const Problem& p, const OptimizeRequest& r)
      : lattice_(p, r),
        l_(lattice_.stage.lattice),
        mirror_(l_),
        filter_(l_, std::max({least_filter, filter_of_body * extent(p.frame) / l_.cell,
                              0.55 * r.level_set.min_feature / l_.cell})),
        x_(Eigen::VectorXd::Zero(l_.part.size())) {
    fixed_.assign(static_cast<std::size_t>(l_.part.size()), 0);
    void_.assign(fixed_.size(), 0);
    std::vector<Index> loaded, held;
    for (const Scene& scene : scenes_of(p, r))
      for (const Traction& t : scene.tractions) loaded.push_back(t.label);
    for (const Support& s : p.scene.supports) held.push_back(s.label);
    const double size = extent(p.frame);
    const std::vector<Vec2> sharp = sharp_corners(p.frame, loaded, held, 1e-4 * size);
    for (const Index c : l_.cells) {
      const Vec2 at = l_.origin + l_.cell * l_.center(c);
      const bool solid = l_.solid[static_cast<std::size_t>(c)] != 0;
      const bool hollow =
          !solid && std::ranges::any_of(sharp, [&](const Vec2& s) { return (s - at).norm() < hollow_of_body * size; });
      fixed_[static_cast<std::size_t>(c)] = solid || hollow;
      void_[static_cast<std::size_t>(c)] = hollow;
      x_[c] = hollow ? 0 : 1;
      if (!solid && !hollow) free_.push_back(c);
    }
  }

  DensityDesign run();

 private:
  struct Looked {
    Eigen::VectorXd mean, density;
    StressedValues values;
    double area = 0;
  };
  Looked look(const Eigen::VectorXd& x);
  MmaPoint point(const Looked& at);
  Eigen::VectorXd by_variables(const Eigen::VectorXd& by_density, const Eigen::VectorXd& mean) const;
  void rescale(const Looked& at);
  int descend(int most);
  int sharpen();
  /// Whether a design is worse than another by more than a step may make it.
  bool too_stressed(const Looked& there, double before) const {
    return worst(there) > std::max(1 + rise, before + slight_rise);
  }
  double worst(const Looked& at) const {
    return at.values.norm.cwiseProduct(factor_).maxCoeff();
  }

  StressedLattice lattice_;
  const Lattice& l_;
  LatticeMirror mirror_;
  LatticeFilter filter_;
  Projection projection_;
  Eigen::VectorXd x_, factor_;
  std::vector<char> fixed_, void_;
  std::vector<Index> free_;
  double unit_ = 0;
};

StressRun::Looked StressRun::look(const Eigen::VectorXd& x) {
  Looked at{.mean = filter_.average(x), .density = Eigen::VectorXd::Zero(x.size()), .values = {}};
  for (const Index c : l_.cells) {
    const auto i = static_cast<std::size_t>(c);
    at.density[c] = void_[i] ? 0 : fixed_[i] ? 1 : projection_(at.mean[c]);
  }
  at.values = lattice_.at(at.density);
  at.area = l_.part.dot(at.density);
  return at;
}

Eigen::VectorXd StressRun::by_variables(const Eigen::VectorXd& by_density, const Eigen::VectorXd& mean) const {
  Eigen::VectorXd by = by_density;
  for (const Index c : l_.cells) by[c] *= fixed_[static_cast<std::size_t>(c)] ? 0 : projection_.slope(mean[c]);
  const Eigen::VectorXd all = mirror_.symmetrized(filter_.pull_back(by));
  Eigen::VectorXd free(static_cast<Eigen::Index>(free_.size()));
  for (std::size_t i = 0; i < free_.size(); ++i) free[static_cast<Eigen::Index>(i)] = all[free_[i]];
  return free;
}

// In units of the goal at the start; stresses above all else, then compliances and the area.
MmaPoint StressRun::point(const Looked& at) {
  const LatticeGoal& goal = lattice_.stage.goal;
  const StressedValues& v = at.values;
  if (unit_ == 0) unit_ = std::max(std::abs(goal.weights.dot(v.compliance) + goal.price * at.area), 1e-300);
  MmaPoint m;
  m.objective_by = by_variables(v.compliance_by * goal.weights + goal.price * l_.part, at.mean) / unit_;
  std::vector<std::pair<double, Eigen::VectorXd>> bounds;
  for (Eigen::Index i = 0; i < v.norm.size(); ++i)
    bounds.emplace_back(factor_[i] * v.norm[i] - 1, factor_[i] * by_variables(v.norm_by.col(i), at.mean));
  for (Eigen::Index k = 0; k < goal.most.size(); ++k)
    if (goal.most[k] < infinity)
      bounds.emplace_back(v.compliance[k] / goal.most[k] - 1,
                          by_variables(v.compliance_by.col(k), at.mean) / goal.most[k]);
  if (goal.area) bounds.emplace_back(at.area / *goal.area - 1, by_variables(l_.part, at.mean) / *goal.area);
  m.g.resize(static_cast<Eigen::Index>(bounds.size()));
  m.by.resize(m.objective_by.size(), m.g.size());
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    m.g[static_cast<Eigen::Index>(i)] = bounds[i].first;
    m.by.col(static_cast<Eigen::Index>(i)) = bounds[i].second;
  }
  return m;
}

void StressRun::rescale(const Looked& at) {
  const Eigen::VectorXd now = at.values.largest.cwiseQuotient(at.values.norm.cwiseMax(1e-300));
  factor_ = factor_.size() == 0 ? now : Eigen::VectorXd(damping * now + (1 - damping) * factor_);
}

// Steps of one sharpness, each made again within less until no norm rises too much.
int StressRun::descend(int most) {
  const auto n = static_cast<Eigen::Index>(free_.size());
  Mma mma(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Ones(n), furthest);
  const double longest = std::min(furthest, of_sharpness / projection_.sharpness);
  Looked here = look(x_);
  double length = 1;
  int steps = 0;
  while (steps < most) {
    rescale(here);
    Eigen::VectorXd from(n);
    for (std::size_t i = 0; i < free_.size(); ++i) from[static_cast<Eigen::Index>(i)] = x_[free_[i]];
    const MmaPoint now = point(here);
    Eigen::VectorXd next = x_;
    Looked there;
    Mma tried = mma;
    for (int k = 0; k <= most_shortened; ++k) {
      tried = mma;
      tried.move_at_most(length * longest);
      const Eigen::VectorXd to = tried.step(from, now);
      for (std::size_t i = 0; i < free_.size(); ++i) next[free_[i]] = to[static_cast<Eigen::Index>(i)];
      next = mirror_.symmetrized(next);
      round_off(next);
      there = look(next);
      ++steps;
      if (!too_stressed(there, worst(here))) break;
      length *= shorter_step;
    }
    mma = tried;
    const double change = (next - x_).cwiseAbs().maxCoeff();
    x_ = next;
    here = std::move(there);
    length = std::min(1.0, 1.5 * length);
    if (change < 1e-4) break;
  }
  return steps;
}

// Twice as sharp, or by less where that stresses the design too much.
int StressRun::sharpen() {
  const double before = projection_.sharpness, stress = worst(look(x_));
  int looks = 1;
  for (double times = std::min(2.0, sharpest_projection / before);; times = std::sqrt(times)) {
    projection_.sharpness = before * times;
    ++looks;
    if (times < least_sharpening || !too_stressed(look(x_), stress + rise_of_sharpening)) return looks;
  }
}

DensityDesign StressRun::run() {
  int steps = descend(steps_each);
  while (projection_.sharpness < sharpest_projection && steps < most_steps) {
    steps += sharpen();
    steps += descend(steps_each);
  }
  steps += descend(last_steps);
  const Looked end = look(x_);
  Eigen::VectorXd mean = end.mean;
  for (const Index c : l_.cells)
    if (fixed_[static_cast<std::size_t>(c)]) mean[c] = void_[static_cast<std::size_t>(c)] ? 0 : 1;
  DensityDesign d = on_all_cells(l_, {mean, steps});
  d.volume_fraction = end.area / l_.part.sum();
  d.compliance = l_.compliance_unit *
                 (lattice_.stage.goal.weights.dot(end.values.compliance) + lattice_.stage.goal.price * end.area);
  d.name = fmt::format("density under the stress bound, {:.3g} of it in cells", end.values.largest.maxCoeff());
  return d;
}

}  // namespace

bool bounds_largest_stress(const OptimizeRequest& r) {
  return std::ranges::any_of(r.bounds, [](const FunctionalBound& b) {
    return std::ranges::any_of(b.functional.terms, [](const Term& t) { return t.largest != nullptr; });
  });
}

DensityDesign stress_design(const Problem& p, const OptimizeRequest& r) {
  const double cells = std::max(density_cells(p, r), cells_in_all);
  if (const auto why = no_stage(p, r, density_stage(p, r, cells)))
    throw Error(Fault::Usage, fmt::format("no density stage: {}", *why));
  return StressRun(p, r).run();
}

}  // namespace kerf
