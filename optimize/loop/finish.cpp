// The end of an optimization: the design on a mesh of half the size with an element of one degree more and curved
// edges, the word for it (optimal, optimal within p %, stalled, budget used, infeasible) and why. Bounds on release
// rates and squared stresses are judged by the upper end of their interval there, where that is guaranteed, else by the
// larger of it and the value (docs/theory/guarantees.md, "What is guaranteed of an optimised design"). "Optimal" needs
// the residual asked for, no obstacle and a finer design that keeps its constraints to 1e-3; "optimal within p %"
// instead of the first two bounds of what is left to gain that sum to at most the tolerance. Where the finer mesh finds
// a bound violated, `with_more_room` tells how much less the loop's own mesh may use, in proportion to what the two
// meshes say of the design.

#include "optimize/loop/finish.hpp"

#include "geometry/curved.hpp"
#include "kerf/folded.hpp"
#include "optimize/constraints.hpp"
#include "optimize/loop/history_text.hpp"
#include "optimize/loop/intervals.hpp"
#include "solver/error_bars.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

// A bound of 0 admits nothing.
double relative(double value, double at_most) {
  return (value - at_most) / std::max(std::abs(at_most), 1e-300);
}

bool limits_volume(const OptimizeRequest& r) {
  return r.volume_at_most && *r.volume_at_most < 1;
}

std::string in_words(const FinerDesign& finer) {
  return fmt::format("on a mesh of size {:.3g} with {} {}{}", finer.size, finer.element.name, finer.element.degree,
                     finer.curved ? " and curved edges" : "");
}

bool has_upper(const FinerDesign& finer, std::size_t k) {
  return k < finer.intervals.size() && std::isfinite(finer.intervals[k].upper);
}

/// "G: at most 1.003 of what is allowed is proved".
std::string upper_in_words(const FunctionalBound& bound, const Bounded& interval) {
  const char* how = interval.guaranteed ? "proved" : "estimated";
  if (!(bound.at_most > 0))
    return fmt::format("{}: at most {:.6g} is {}, {:.6g} is allowed", bound.name, interval.upper, how, bound.at_most);
  return fmt::format("{}: at most {:.4f} of what is allowed is {}", bound.name, interval.upper / bound.at_most, how);
}

/// What the design violates on the finer mesh.
std::string violated_there(const OptimizeRequest& r, const FinerDesign& finer) {
  std::vector<std::string> all{violated(r, finer.bounds, finer.volume_fraction)};
  for (std::size_t k = 0; k < finer.bounds.size(); ++k) {
    const double most = r.bounds[k].at_most;
    if (has_upper(finer, k) && relative(finer.bounds[k], most) < feasible_violation &&
        relative(finer.intervals[k].upper, most) >= feasible_violation)
      all.push_back(upper_in_words(r.bounds[k], finer.intervals[k]));
  }
  return join(all, ", ");
}

/// What there is to say for a design that keeps its bounds.
std::string kept_there(const OptimizeRequest& r, const FinerDesign& finer) {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < finer.bounds.size(); ++k)
    if (has_upper(finer, k)) all.push_back(upper_in_words(r.bounds[k], finer.intervals[k]));
  return join(all, ", ");
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

std::vector<double> judged_by(const FinerDesign& finer) {
  std::vector<double> all = finer.bounds;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!has_upper(finer, k)) continue;
    const Bounded& b = finer.intervals[k];
    all[k] = b.guaranteed ? b.upper : std::max(b.upper, all[k]);
  }
  return all;
}

std::vector<double> excess_of(const FinerDesign& finer, std::span<const double> values) {
  std::vector<double> all = judged_by(finer);
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = relative(all[k], values[k]);
  return all;
}

std::vector<double> with_more_room(const FinerDesign& finer, const OptimizeRequest& asked, std::span<const double> now,
                                   std::span<const double> values) {
  constexpr double least = 1e-4;  // of a bound, that less is to be allowed
  if (!finer.failure.empty() || !(finer.violation >= feasible_violation)) return {};
  const std::vector<double> judged = judged_by(finer);
  std::vector<double> tight(now.begin(), now.end());
  bool changed = false;
  for (std::size_t k = 0; k < tight.size(); ++k) {
    const double most = asked.bounds[k].at_most, size = std::abs(most), ratio = values[k] / judged[k];
    // The finer mesh says as much more of the next design, in proportion where that means something.
    const double wanted = ratio > 0 && most != 0 ? ratio * most : most + values[k] - judged[k],
                 room = std::max(wanted, most - most_room * size);
    // What a design violates on its own mesh is no matter of meshes.
    if (relative(judged[k], most) < feasible_violation || values[k] - tight[k] >= feasible_violation * size) continue;
    if (!(tight[k] - room > least * size)) continue;
    tight[k] = room;
    changed = true;
  }
  return changed ? tight : std::vector<double>();
}

Problem finer_problem(Problem p) {
  p.sizing.size = 0.5 * target_size(p.sizing, p.frame);
  p.sizing.crack_tip_size *= 0.5;
  if (can_be_bettered(p.element)) p.element = better_element(p.element);
  return p;
}

bool is_judged_on_curves(const Problem& p, const Shape& shape) {
  return p.follow_curves && can_be_curved(p.element) && !arcs_of(shape).empty();
}

FinerDesign finer_design(const Problem& finer, const OptimizeRequest& r, const Evaluated& there, double whole) {
  FinerDesign f{.size = finer.sizing.size,
                .element = finer.element,
                .curved = !there.cases.front().model.mesh.arc.empty(),
                .objective = there.J};
  f.bounds = there.bounds;
  f.volume_fraction = there.area / whole;
  f.intervals = intervals_of(there, finer.threads);
  f.violation = violation_of(r, judged_by(f), f.volume_fraction);
  return f;
}

FinerDesign solve_finer(Problem p, const OptimizeRequest& r, const Shape& shape, double whole) {
  Problem finer = finer_problem(std::move(p));
  std::vector<Index> cracks(shape.cracks.size());
  std::iota(cracks.begin(), cracks.end(), Index{0});
  const auto solved = [&] { return finer_design(finer, r, evaluate_design(finer, r, shape, cracks), whole); };
  finer.sizing.curved = is_judged_on_curves(finer, shape);
  try {
    try {
      return solved();
    } catch (const FoldedTriangle&) {
      // Where a curved edge would fold a triangle all edges are straight.
      finer.sizing.curved = false;
      return solved();
    }
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    return {.size = finer.sizing.size, .element = finer.element, .failure = error.what()};
  }
}

// Carving may have cut cracks: laws and terms are those of the parts.
FinerDesign solve_finer(Problem p, OptimizeRequest r, const Evaluated& e, double whole) {
  p.scene.laws = e.cases.front().model.scene.laws;
  p.objective = e.objective;
  for (std::size_t k = 0; k < r.bounds.size(); ++k) r.bounds[k].functional = e.bounded[k];
  return solve_finer(std::move(p), r, e.shape, whole);
}

const Iteration& last_taken(std::span<const Iteration> rows) {
  return *std::find_if(rows.rbegin(), rows.rend(), [](const Iteration& i) { return i.accepted; });
}

// Infeasible before all else; optimal only with a finer design that could be solved; else why the loop ended.
namespace {

/// A start that violates a constraint may have a J that no design has which keeps it.
std::string above_start(const OptimizeResult& result, const OptimizeRequest& r, const Iteration& row) {
  if (result.history.empty()) return {};
  const Iteration& first = result.history.front();
  const std::string wrong = violated(r, first.bounds, first.volume_fraction);
  if (wrong.empty() || !(row.merit > first.merit)) return {};
  return fmt::format("J is above that of the start, {:.6g}, which violates its constraints ({})", first.objective,
                     wrong);
}

}  // namespace

namespace {

/// Of J, rounded up to two digits, at least a thousandth: "0.054 %".
std::string percent(double share) {
  const double value = std::max(100 * share, 1e-3), unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return fmt::format("{:.2g} %", std::ceil(value / unit * (1 - 1e-12)) * unit);
}

/// "0.054 % of J could still be gained: by moving the boundary 0.054 %, by a hole of radius 0.02 at (1, 2) 0.001 %".
std::string in_words(const GainLeft& gain) {
  if (!std::isfinite(gain.sum())) return {};
  std::string words = "at most " + percent(gain.sum()) + " of J could still be gained";
  const auto by = [&](const BestChange& change, const char* what) {
    if (change.gain > 0)
      words += fmt::format(", {} by a {} of radius {:.3g} at ({:.4g}, {:.4g})", percent(change.gain), what,
                           change.radius, change.at.x(), change.at.y());
  };
  if (gain.hole.gain > 0 || gain.bump.gain > 0)
    words += fmt::format(": {} by moving the boundary", percent(gain.shape));
  by(gain.hole, "hole");
  by(gain.bump, "bump");
  return words;
}

}  // namespace

std::string verdict_of(const OptimizeResult& result) {
  const std::string_view of = word(result.ending);
  return result.ending == Ending::OptimalWithin ? fmt::format("{} {}", of, percent(result.gain.sum()))
                                                : std::string(of);
}

void judge(OptimizeResult& result, const OptimizeRequest& r, const LoopEnd& end) {
  const Iteration& row = end.row;
  const FinerDesign& finer = result.finer;
  const std::vector<double> judged = finer.failure.empty() && !finer.bounds.empty() ? judged_by(finer) : row.bounds;
  result.constraints = constraints_of(
      {.shape = result.shape, .frame = end.frame, .volume_fraction = row.volume_fraction, .bounds = judged}, r);
  const std::string conflict = conflicts(result.constraints, false);
  const std::string here = violated(r, row.bounds, row.volume_fraction),
                    there = finer.failure.empty() ? violated_there(r, finer) : "";
  const std::string residual = std::isfinite(end.residual) ? fmt::format("{} {:.2g}", end.kind, end.residual) : "";
  result.feasible = here.empty() && there.empty() && !(row.violation > end.allowed) &&
                    std::ranges::none_of(result.constraints, is_broken);
  result.gain = end.gain;
  const std::string left = in_words(end.gain);
  const bool sound = conflict.empty() && finer.failure.empty();
  std::vector<std::string> words;
  if (!result.feasible) {
    result.ending = Ending::Infeasible;
    words = {here, here.empty() && !there.empty() ? there + " " + in_words(finer) : "",
             conflicts(result.constraints, true), end.why};
  } else if (const bool optimal = end.residual <= end.asked && end.obstacle.empty();
             sound && (optimal || end.gain.sum() <= r.tolerance)) {
    result.ending = optimal ? Ending::Optimal : Ending::OptimalWithin;
    words = {optimal ? "" : left, residual, end.evidence, end.obstacle, kept_there(r, finer), optimal ? left : ""};
    if (finer.size > 0) words.push_back(fmt::format("objective {:.6g} {}", finer.objective, in_words(finer)));
  } else {
    result.ending = end.budget_used ? Ending::BudgetUsed : Ending::Stalled;
    words = {end.why};
    if (!left.empty()) words.push_back(fmt::format("{}, the tolerance is {}", left, percent(r.tolerance)));
    if (!(end.residual <= end.asked))
      words.push_back(residual.empty() ? "nothing tells how far it is from an optimum"
                                       : fmt::format("{}, an optimum has at most {:.2g}", residual, end.asked));
    words.push_back(end.obstacle);
    words.push_back(conflict);
    if (!finer.failure.empty())
      words.push_back(fmt::format("the design cannot be solved {}: {}", in_words(finer), finer.failure));
    words.push_back(kept_there(r, finer));
  }
  words.push_back(above_start(result, r, row));
  result.optimality = end.residual;
  result.stopped = fmt::format("{}: {}", verdict_of(result), join(words));
}

}  // namespace kerf
