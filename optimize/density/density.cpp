#include "optimize/density/density.hpp"

#include "optimize/density/simp.hpp"
#include "optimize/loop/evaluate.hpp"
#include "solver/parallel.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

namespace {

constexpr std::array<double, 2> radii{1.4, 2.5};  // of the filters, in cells

/// The factor of the compliance in J; nothing where J knows more than compliance and volume.
std::optional<double> compliance_factor(const Functional& j) {
  double factor = 0;
  for (const Term& term : j.terms) {
    if (term.volume) continue;
    if (!term.work || term.power != 1) return std::nullopt;
    factor += term.factor;
  }
  return factor;
}

Eigen::VectorXd weights_of(const OptimizeRequest& r) {
  Eigen::VectorXd w = Eigen::VectorXd::Ones(std::max<Eigen::Index>(1, static_cast<Eigen::Index>(r.load_cases.size())));
  for (std::size_t i = 0; i < r.load_cases.size(); ++i) w[static_cast<Eigen::Index>(i)] = r.load_cases[i].weight;
  return w;
}

Lattice lattice_of(const Problem& p, const OptimizeRequest& r) {
  return make_lattice(p, r, {.min_feature = r.level_set.min_feature});
}

std::optional<std::string> no_density(const Problem& p, const OptimizeRequest& r, const Lattice* lattice) {
  if (r.method != OptimizeMethod::LevelSet) return "it is for a level set";
  if (!r.volume_at_most || r.volume_penalty > 0 || !r.bounds.empty())
    return "it knows a bound on the area alone (optimize.volume = { at_most = ... })";
  const std::optional<double> factor = compliance_factor(p.objective);
  if (!factor || !(*factor > 0)) return "it knows the compliance alone";
  for (const Support& s : p.scene.supports)
    for (const Loop& loop : {p.frame.outline})
      for (const Side& side : loop.sides)
        if (side.label == s.label && s.value && s.value(side.start, Vec2(1, 0)) != Vec2::Zero())
          return "a support moves";
  if (!lattice) return std::nullopt;
  if (lattice->force.isZero(0) && lattice->body.empty()) return "there are no loads";
  return unsupported(*lattice);
}

}  // namespace

double density_at(const DensityDesign& d, const Vec2& x) {
  double value = 0;
  for (const auto& [cell, weight] : between_centers(d.columns, d.rows, (x - d.origin) / d.cell))
    value += weight * d.density[cell];
  return value;
}

std::optional<std::string> no_density_stage(const Problem& p, const OptimizeRequest& r) {
  if (auto why = no_density(p, r, nullptr)) return why;
  const Lattice lattice = lattice_of(p, r);
  return no_density(p, r, &lattice);
}

std::vector<DensityDesign> density_designs(const Problem& p, const OptimizeRequest& r) {
  const Lattice l = lattice_of(p, r);
  if (const auto why = no_density(p, r, &l)) throw Error(Fault::Usage, fmt::format("no density stage: {}", *why));
  const LatticePattern pattern = lattice_pattern(l);
  const double whole = l.part.sum(), area = *r.volume_at_most * whole;
  const Eigen::VectorXd weights = *compliance_factor(p.objective) * weights_of(r);
  std::vector<DensityDesign> designs(radii.size());
  parallel_tasks(static_cast<Index>(radii.size()), p.threads, [&](Index i) {
    const double radius = radii[static_cast<std::size_t>(i)];
    const Densities found = optimality_criteria(l, pattern, {.radius = radius, .area = area, .weights = weights});
    DensityDesign& d = designs[static_cast<std::size_t>(i)];
    d = {.origin = l.origin,
         .cell = l.cell,
         .columns = l.columns,
         .rows = l.rows,
         .density = found.density,
         .filter = radius,
         .steps = found.steps,
         .name = fmt::format("density, filter {:.1f}", radius)};
    for (Eigen::Index c = 0; c < d.density.size(); ++c)
      d.density[c] = found.density[l.inside[static_cast<std::size_t>(c)]];
    const Eigen::VectorXd share = black_and_white(l, found.density, area);
    LatticeStiffness stiffness(l, pattern);
    d.compliance = l.compliance_unit * weights.dot(compliances(l, stiffness, {.exponent = 1}, share).value);
    d.volume_fraction = l.part.dot(share) / whole;
  });
  std::stable_sort(designs.begin(), designs.end(),
                   [](const DensityDesign& a, const DensityDesign& b) { return a.compliance < b.compliance; });
  return designs;
}

}  // namespace kerf
