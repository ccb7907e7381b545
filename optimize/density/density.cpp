// The coarse density stage: two designs of a problem on a lattice within a second, best first, for the level set to
// begin with. J and the bounds count as far as the lattice knows them (compliance, energy, area); other functionals are
// replaced by the compliance. Each design is minimized on a lattice of about 3,200 cells, which decides its topology,
// and continued on one of 5,000 (12,000 at most, for members of 2.5 cells), by optimality criteria where compliances
// under an area are all there is, else by moving asymptotes [theory: P.6, P.7]. The two differ in their filter: 1.4
// cells throughout, or 3 shrinking to 1.4 [theory: P.5]; frames with cracks get one with weak cells along the cracks
// and one without. They are made black and white and judged by another lattice's compliance [theory: P.8]. Derived in
// docs/theory/density.md.

#include "optimize/density/density.hpp"

#include "base/parallel.hpp"
#include "optimize/density/stage.hpp"
#include "optimize/density/stress_design.hpp"
#include "optimize/loop/evaluate.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

namespace {

/// What tells the designs of one body apart: the radius of the filter in cells and the exponent of the penalty go
/// evenly from their first values to 1.4 and 3.
struct Run {
  double first_radius, first_exponent;
  int change_steps;
  bool cracks = false;  // as lines of weak cells
};
constexpr std::array<Run, 2> filters{{{1.4, 2, 20}, {3, 3, 30}}};
// Frames with cracks: what avoids them, and what is best without them.
constexpr std::array<Run, 2> with_and_without_cracks{{{1.4, 2, 20, true}, {1.4, 2, 20, false}}};
// Own weight favors less of everything and knows many local optima: smaller steps, a law that ends sharper.
constexpr std::array<Run, 2> weights{{{1.4, 8, 60}, {3, 3, 80}}};
constexpr double radius = 1.4;
constexpr int coarse_steps = 40, fine_steps = 20;

// Cells inside the frame: of the lattice on which topology is decided, and of one that draws it finer.
constexpr double fine_cells = 5000, coarse_share = 0.64;
constexpr double most_cells = 12000;
constexpr double cells_across = 2.5;  // a member of the smallest width asked for
constexpr double wide = 0.55;         // the filter's radius against the width of members asked for

/// A functional as far as the lattice knows it: compliance * C + volume * area.
struct Known {
  double compliance = 0, volume = 0;
  std::string unknown;  // kind of a term that it does not know; empty mostly
};

// Powers other than 1 and all other functionals are unknown to the lattice.
Known known_part(const Functional& j) {
  Known k;
  for (const Term& term : j.terms)
    if (term.volume && term.power == 1)
      k.volume += term.factor;
    else if (term.work && term.power == 1)
      k.compliance += term.factor;
    else if (term.energy && term.power == 1)
      k.compliance -= term.factor / 2;  // C is twice the energy stored, the potential energy minus that
    else
      k.unknown = term.kind;
  return k;
}

Eigen::VectorXd weights_of(const OptimizeRequest& r) {
  if (r.load_cases.empty()) return Eigen::VectorXd::Ones(1);
  Eigen::VectorXd w(static_cast<Eigen::Index>(r.load_cases.size()));
  for (std::size_t i = 0; i < r.load_cases.size(); ++i) w[static_cast<Eigen::Index>(i)] = r.load_cases[i].weight;
  return w;
}

}  // namespace

double density_cells(const Problem& p, const OptimizeRequest& r) {
  const double thin = r.level_set.min_feature / cells_across;
  return thin > 0 ? std::clamp(area(p.frame) / (thin * thin), fine_cells, most_cells) : fine_cells;
}

double lattice_cell(const Shape& frame) {
  return std::sqrt(area(frame) / fine_cells);
}

// Areas become cells and compliances multiples of force^2/modulus, so that prices and bounds are those of the problem.
DensityStage density_stage(const Problem& p, const OptimizeRequest& r, double cells, bool cracks) {
  DensityStage s{make_lattice(p, r, cells, cracks), {}};
  const Lattice& l = s.lattice;
  // Units of the lattice: areas in cells, compliances over compliance_unit.
  const double whole = l.part.sum(), per_cell = l.cell * l.cell / std::max(l.compliance_unit, 1e-300);
  Known j = known_part(p.objective);
  if (!j.unknown.empty()) {
    s.surrogate = true;
    j = {.compliance = 1};  // bounds on the compliance then keep themselves
  }
  const Eigen::VectorXd weights = weights_of(r);
  s.goal.weights = j.compliance * weights;
  s.goal.price = (r.volume_penalty + j.volume * weights.sum()) * per_cell;
  if (r.volume_at_most) s.goal.area = std::min(*r.volume_at_most, 1.0) * whole;
  s.goal.most = Eigen::VectorXd::Constant(weights.size(), infinity);
  for (const FunctionalBound& bound : r.bounds) {
    const Known b = known_part(bound.functional);
    if (!b.unknown.empty() || (b.volume != 0) == (b.compliance != 0)) {
      s.surrogate = true;
    } else if (b.volume > 0) {
      const double area = bound.at_most / b.volume / (l.cell * l.cell);
      s.goal.area = std::min(s.goal.area.value_or(whole), area);
    } else if (b.compliance > 0 && known_part(p.objective).unknown.empty()) {
      s.goal.most = s.goal.most.cwiseMin(bound.at_most / b.compliance / std::max(l.compliance_unit, 1e-300));
    }
  }
  return s;
}

namespace {

// Sampled at three points of each side: for a refusal to make a start, not for a proof.
bool moves(const Problem& p, const Support& support) {
  std::vector<const Loop*> loops{&p.frame.outline};
  for (const Loop& hole : p.frame.holes) loops.push_back(&hole);
  for (const Loop* loop : loops)
    for (std::size_t i = 0; i < loop->sides.size(); ++i) {
      if (loop->sides[i].label != support.label || !support.value) continue;
      const Vec2 a = loop->sides[i].start, b = loop->sides[(i + 1) % loop->sides.size()].start;
      const Vec2 d = b - a, n = d.norm() > 0 ? Vec2(Vec2(d.y(), -d.x()).normalized()) : Vec2(1, 0);
      for (const double t : {0.0, 0.5, 1.0}) {
        const Vec2 value = support.value(a + t * d, n);
        if ((support.first && value.x() != 0) || (support.second && value.y() != 0)) return true;
      }
    }
  return false;
}

}  // namespace

std::optional<std::string> no_stage(const Problem& p, const OptimizeRequest& r, const DensityStage& s) {
  if (r.method != OptimizeMethod::LevelSet) return "it is made for a level set";
  for (const Support& support : p.scene.supports)
    if (moves(p, support)) return "a support moves, which the coarse lattice does not know";
  if (s.lattice.force.isZero(0) && s.lattice.body.empty()) return "there are no loads";
  if (s.goal.weights.maxCoeff() < 0) return "its J is less the more the body gives way";
  const bool bounded = (s.goal.most.array() < infinity).any() || bounds_largest_stress(r);
  if (!s.goal.area && !(s.goal.price > 0 && (bounded || s.goal.weights.maxCoeff() > 0)))
    return fmt::format("the coarse lattice knows compliance and area, and nothing bounds the area");
  return unsupported(s.lattice);
}

namespace {

/// A density made black and white: at the area allowed; where area has a price or weight, at the area that is best.
struct BlackWhite {
  double area = 0, goal = 0, violation = 0;
};

// At the area wanted, where nothing else counts. With bounds on compliances the least area that keeps them is found by
// bisection, and where area has a price or weight five areas near the density's own are compared.
BlackWhite judged(const DensityStage& s, const LatticePattern& pattern, const Eigen::VectorXd& density) {
  const Lattice& l = s.lattice;
  LatticeStiffness stiffness(l, pattern);
  const auto at = [&](double area) {
    const Eigen::VectorXd share = black_and_white(l, density, area);
    const Eigen::VectorXd c = compliances(l, stiffness, {.exponent = 1}, share).value;
    BlackWhite b{.area = l.part.dot(share)};
    b.goal = s.goal.weights.dot(c) + s.goal.price * b.area;
    b.violation = std::max(0.0, (c.array() / s.goal.most.array()).maxCoeff() - 1);
    return b;
  };
  const double most = s.goal.area.value_or(l.part.sum());
  if (s.goal.price == 0 && l.body.empty()) return at(most);
  double own = std::min(most, l.part.dot(density));
  if ((s.goal.most.array() < infinity).any()) {  // the least area that keeps the bounds
    double low = 0.5 * own, high = std::min(most, 1.5 * own);
    for (int i = 0; i < 10; ++i) (at((low + high) / 2).violation > 0 ? low : high) = (low + high) / 2;
    own = high;
  }
  BlackWhite best = at(own);
  for (const double share : {0.9, 1.1, 1.2, 1.35}) {
    const BlackWhite b = at(std::min(most, share * own));
    if (std::pair(b.violation, b.goal) < std::pair(best.violation, best.goal)) best = b;
  }
  return best;
}

}  // namespace

double density_at(const DensityDesign& d, const Vec2& x) {
  double value = 0;
  for (const auto& [cell, weight] : between_centers(d.columns, d.rows, (x - d.origin) / d.cell))
    value += weight * d.density[cell];
  return value;
}

std::optional<std::string> no_density_stage(const Problem& p, const OptimizeRequest& r) {
  return no_stage(p, r, density_stage(p, r, coarse_share * density_cells(p, r)));
}

namespace {

/// A lattice and its matrix.
struct Level {
  DensityStage stage;
  LatticePattern pattern;
};
Level level(const Problem& p, const OptimizeRequest& r, double cells, bool cracks) {
  Level at{density_stage(p, r, cells, cracks), {}};
  at.pattern = lattice_pattern(at.stage.lattice);
  return at;
}

}  // namespace

DensityDesign on_all_cells(const Lattice& l, const Densities& found) {
  DensityDesign d{.origin = l.origin, .cell = l.cell, .columns = l.columns, .rows = l.rows, .density = found.density};
  for (Eigen::Index c = 0; c < d.density.size(); ++c)
    d.density[c] = found.density[l.inside[static_cast<std::size_t>(c)]];
  d.steps = found.steps;
  return d;
}

namespace {

Densities minimized(const Level& at, const Schedule& how) {
  const bool plain = at.stage.goal.plain() && at.stage.lattice.body.empty();
  return (plain ? optimality_criteria : moving_asymptotes)(at.stage.lattice, at.pattern, at.stage.goal, how);
}

/// In cells: no narrower than members are wanted.
double radius_of(const Lattice& l, const OptimizeRequest& r) {
  return std::max(radius, wide * r.level_set.min_feature / l.cell);
}

Schedule schedule(const Run& run, double last_radius, bool weight) {
  Schedule how{.first_radius = std::max(run.first_radius, last_radius),
               .radius = last_radius,
               .first_exponent = run.first_exponent,
               .change_steps = run.change_steps,
               .most_steps = coarse_steps};
  // Under own weight the exponent of the rational law goes to 30, in smaller steps [theory: P.3].
  if (weight) how.exponent = 30, how.most_steps = 100, how.move = 0.1;
  return how;
}

using Levels = std::array<Level, 2>;  // coarse, fine

/// Judged by another lattice with as many cells.
std::pair<DensityDesign, BlackWhite> designed(const Levels& levels, const Level& judge, const Run& run,
                                              const OptimizeRequest& r) {
  Schedule how = schedule(run, radius_of(levels[0].stage.lattice, r), !levels[0].stage.lattice.body.empty());
  const DensityDesign coarse = on_all_cells(levels[0].stage.lattice, minimized(levels[0], how));
  const Lattice& l = levels[1].stage.lattice;
  // The finer lattice goes on with the last radius and exponent, from the coarse design.
  how.change_steps = 0;
  how.radius = radius_of(l, r);
  how.most_steps = fine_steps;
  how.start = Eigen::VectorXd::Zero(l.part.size());
  for (const Index c : l.cells)
    how.start[c] = l.solid[static_cast<std::size_t>(c)] ? 1 : density_at(coarse, l.origin + l.cell * l.center(c));
  const Densities found = minimized(levels[1], how);
  DensityDesign d = on_all_cells(l, found);
  const BlackWhite bw = judged(judge.stage, judge.pattern, found.density);
  d.compliance = l.compliance_unit * bw.goal;
  d.volume_fraction = bw.area / l.part.sum();
  d.filter = how.radius;
  d.steps += coarse.steps;
  d.name = fmt::format("density{}, filter {}{:.1f}", levels[0].stage.surrogate ? " of the compliance" : "",
                       run.first_radius > how.radius ? fmt::format("{:.1f} to ", run.first_radius) : "", how.radius);
  return {std::move(d), bw};
}

}  // namespace

// The one that violates its bounds least first, then by the goal; equal ones in the order of the runs.
std::vector<DensityDesign> density_designs(const Problem& p, const OptimizeRequest& r) {
  if (bounds_largest_stress(r)) return {stress_design(p, r)};
  const double cells = density_cells(p, r);
  const bool cracked = has_cracks(p);
  std::vector<Levels> levels;  // without cracks, with them
  for (int cracks = 0; cracks < (cracked ? 2 : 1); ++cracks)
    levels.push_back({level(p, r, coarse_share * cells, cracks != 0), level(p, r, cells, cracks != 0)});
  if (const auto why = no_stage(p, r, levels[0][0].stage))
    throw Error(Fault::Usage, fmt::format("no density stage: {}", *why));
  const std::array<Run, 2>& runs = !levels[0][0].stage.lattice.body.empty() ? weights
                                   : cracked                                ? with_and_without_cracks
                                                                            : filters;
  std::vector<std::pair<DensityDesign, BlackWhite>> designs(runs.size());
  parallel_tasks(static_cast<Index>(runs.size()), p.threads, [&](Index i) {
    const Run& run = runs[static_cast<std::size_t>(i)];
    designs[static_cast<std::size_t>(i)] = designed(levels[run.cracks ? 1 : 0], levels.back()[1], run, r);
    if (cracked) designs[static_cast<std::size_t>(i)].first.name += run.cracks ? ", cracks weak" : ", no cracks";
  });
  std::stable_sort(designs.begin(), designs.end(), [](const auto& a, const auto& b) {
    return std::pair(a.second.violation, a.first.compliance) < std::pair(b.second.violation, b.first.compliance);
  });
  std::vector<DensityDesign> sorted;
  for (auto& [design, bw] : designs) sorted.push_back(std::move(design));
  return sorted;
}

}  // namespace kerf
