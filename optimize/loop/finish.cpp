#include "optimize/loop/finish.hpp"

#include "optimize/loop/history_text.hpp"
#include "solver/error_bars.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

double relative(double value, double at_most) {
  return (value - at_most) / std::max(std::abs(at_most), 1e-300);
}

bool limits_volume(const OptimizeRequest& r) {
  return r.volume_at_most && *r.volume_at_most < 1;
}

std::string in_words(const FinerDesign& finer) {
  return fmt::format("on a mesh of size {:.3g} with {} {}", finer.size, finer.element.name, finer.element.degree);
}

}  // namespace

double violation_of(const OptimizeRequest& r, std::span<const double> bounds, double volume_fraction) {
  double worst = limits_volume(r) ? std::max(0.0, relative(volume_fraction, *r.volume_at_most)) : 0;
  for (std::size_t i = 0; i < bounds.size(); ++i) worst = std::max(worst, relative(bounds[i], r.bounds[i].at_most));
  return worst;
}

std::string violated(const OptimizeRequest& r, std::span<const double> bounds, double volume_fraction) {
  std::vector<std::string> all;
  if (limits_volume(r) && relative(volume_fraction, *r.volume_at_most) >= feasible_violation)
    all.push_back(fmt::format("volume fraction {:.4g} > {:.4g}", volume_fraction, *r.volume_at_most));
  for (std::size_t i = 0; i < bounds.size(); ++i)
    if (relative(bounds[i], r.bounds[i].at_most) >= feasible_violation)
      all.push_back(fmt::format("{} {:.4g} > {:.4g}", r.bounds[i].name, bounds[i], r.bounds[i].at_most));
  return join(all, ", ");
}

Problem finer_problem(Problem p) {
  if (p.sizing.size == 0) p.sizing.size = extent(p.frame) / 40;
  p.sizing.size *= 0.5;
  p.sizing.crack_tip_size *= 0.5;
  if (can_be_bettered(p.element)) p.element = better_element(p.element);
  return p;
}

FinerDesign finer_design(const Problem& finer, const OptimizeRequest& r, const Evaluated& there, double whole) {
  FinerDesign f{.size = finer.sizing.size, .element = finer.element, .objective = there.J};
  f.bounds = there.bounds;
  f.volume_fraction = there.area / whole;
  f.violation = violation_of(r, f.bounds, f.volume_fraction);
  return f;
}

FinerDesign solve_finer(Problem p, const OptimizeRequest& r, const Shape& shape, double whole) {
  const Problem finer = finer_problem(std::move(p));
  std::vector<Index> cracks(shape.cracks.size());
  std::iota(cracks.begin(), cracks.end(), Index{0});
  try {
    return finer_design(finer, r, evaluate_design(finer, r, shape, cracks), whole);
  } catch (const Error& error) {
    if (error.fault != Fault::Geometry && error.fault != Fault::Numerics) throw;
    return {.size = finer.sizing.size, .element = finer.element, .failure = error.what()};
  }
}

FinerDesign solve_finer(Problem p, OptimizeRequest r, const Evaluated& e, double whole) {
  p.scene.laws = e.cases.front().model.scene.laws;
  p.objective = e.objective;
  for (std::size_t k = 0; k < r.bounds.size(); ++k) r.bounds[k].functional = e.bounded[k];
  return solve_finer(std::move(p), r, e.shape, whole);
}

const Iteration& last_taken(std::span<const Iteration> rows) {
  return *std::find_if(rows.rbegin(), rows.rend(), [](const Iteration& i) { return i.accepted; });
}

void judge(OptimizeResult& result, const OptimizeRequest& r, const LoopEnd& end) {
  const Iteration& row = end.row;
  const FinerDesign& finer = result.finer;
  const std::string here = violated(r, row.bounds, row.volume_fraction),
                    there = finer.failure.empty() ? violated(r, finer.bounds, finer.volume_fraction) : "";
  const std::string residual = std::isfinite(end.residual) ? fmt::format("{} {:.2g}", end.kind, end.residual) : "";
  result.feasible = here.empty() && there.empty() && !(row.violation > end.allowed);
  std::vector<std::string> words;
  if (!result.feasible) {
    result.ending = Ending::Infeasible;
    words = {here, here.empty() && !there.empty() ? there + " " + in_words(finer) : "", end.why};
  } else if (end.residual <= end.asked && end.obstacle.empty() && finer.failure.empty()) {
    result.ending = Ending::Optimal;
    words = {residual, end.evidence};
    if (finer.size > 0) words.push_back(fmt::format("objective {:.6g} {}", finer.objective, in_words(finer)));
  } else {
    result.ending = end.budget_used ? Ending::BudgetUsed : Ending::Stalled;
    words = {end.why};
    if (!(end.residual <= end.asked))
      words.push_back(residual.empty() ? "nothing tells how far it is from an optimum"
                                       : fmt::format("{}, an optimum has at most {:.2g}", residual, end.asked));
    words.push_back(end.obstacle);
    if (!finer.failure.empty())
      words.push_back(fmt::format("the design cannot be solved {}: {}", in_words(finer), finer.failure));
  }
  result.optimality = end.residual;
  result.stopped = fmt::format("{}: {}", word(result.ending), join(words));
}

}  // namespace kerf
