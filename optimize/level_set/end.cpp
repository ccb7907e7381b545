// What is said of a level set's design at the end, and whether its curves or the carved design are the result.
// "Optimal" needs a small shape residual [theory: L.10, K.3], on the mesh of the curves and on a finer one, and no
// small hole or bump that pays [theory: L.11, L.13]. Curves are better where they keep the constraints as the carved
// design does and J with the price of area is no worse than meshes differ by; where bounds count, they keep room for
// what a finer mesh says more. With a weak phase the strong phase is drawn alone and solved as a body; nothing is
// proved of it. docs/theory/level_set.md, section "Optimality".

#include "optimize/level_set/end.hpp"

#include "optimize/constraints.hpp"
#include "optimize/level_set/certificate.hpp"
#include "optimize/loop/history_text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Largest shape residuals of what is called optimal: of curves on their own mesh, which they came to like; on the finer
// one by which designs are judged, and of a carved design.
constexpr double of_curves = 2e-2, elsewhere = 5e-2;

/// What speaks for and against "optimal" besides the shape residual.
void weigh_changes(const Ground& g, const Evaluated& e, OptimizeResult& result, LoopEnd& end) {
  const Prices prices = prices_of(g, e);
  if (!(prices.area > 0)) return;
  HoleMargin& holes = result.holes;
  holes = hole_margin(g, e, prices);
  result.bumps = bump_margin(g, e, prices);
  end.gain.hole = best_hole(g, e, prices, holes);
  end.gain.bump = best_bump(g, e, prices);
  const BumpMargin& bumps = result.bumps;
  const auto place = [](const Vec2& x) { return fmt::format("({:.4g}, {:.4g})", x.x(), x.y()); };
  if (std::isfinite(bumps.least)) {
    const double worth = 1 - bumps.least;
    if (bumps.least < 0)
      end.obstacle = fmt::format("a small bump at {} pays: it is worth {:.2g} of its price", place(bumps.at), worth);
    else
      end.evidence =
          fmt::format("no small bump pays: worth at most {:.2g} of its price, at {}", worth, place(bumps.at));
  }
  if (!std::isfinite(holes.least)) return;
  std::string agree;
  // Where the shape says that it is no optimum the price of a proof is saved.
  if (end.residual <= end.asked && can_validate(g.p.element)) try {
      holes.proof = proved(g, e, holes.at);
      if (*holes.proof == Verdict::Holds) agree = "; holes made there agree";
    } catch (const Error&) {  // a functional or a place that holes cannot be tried on: no proof
    }
  if (holes.least < 0)
    end.obstacle = join({fmt::format("a small hole at {} pays: T is {:.2g} of the price there{}", place(holes.at),
                                     1 + holes.least, agree),
                         end.obstacle});
  else
    end.evidence = join({fmt::format("no small hole pays: T is at least {:.2g} of the price, at {}{}", 1 + holes.least,
                                     place(holes.at), agree),
                         end.evidence});
}

/// The shape residual on the mesh by which designs are judged.
void weigh_residual(double finer, LoopEnd& end) {
  if (finer <= elsewhere)
    end.evidence = join({fmt::format("{:.2g} on the finer mesh", finer), end.evidence});
  else if (std::isfinite(finer) && end.residual <= end.asked)
    end.obstacle = join({fmt::format("shape residual {:.2g} here and {:.2g} on the finer mesh, an optimum has at most "
                                     "{:.2g} there",
                                     end.residual, finer, elsewhere),
                         end.obstacle});
}

// What speaks for and against "optimal": the residual of the curves, or of the carved design without a step, then small
// holes and bumps.
LoopEnd loop_end(const LevelSetEnd& end, const Evaluated& design, bool go_on, OptimizeResult& result) {
  const DescentState& s = end.descent.progress();
  LoopEnd out{.row = last_taken(result.history), .kind = "shape residual", .frame = &end.g.p.frame};
  out.asked = end.last ? of_curves : elsewhere;
  if (go_on && (end.last || !end.g.turns())) out.residual = end.last ? end.curves.residual : end.descent.residual();
  // What the level set ended with is no longer true of its curves.
  const std::string of_curves_why = end.curves.why.empty() ? "" : "curves: " + end.curves.why;
  out.why = end.last ? of_curves_why : join({s.ended, of_curves_why});
  // An internal limit of evaluations that ends the curves is a budget as well.
  out.budget_used = !go_on || s.spent || (end.last && end.curves.ended == CurvesEnding::Evaluations);
  if (!go_on) {
    out.why = out.obstacle = "stopped as asked";
  } else if (end.g.weak()) {
    out.kind = "angle";
    out.residual = s.residual;
    out.obstacle = "with a weak phase instead of void nothing is proved of the body alone";
  } else {
    weigh_changes(end.g, design, result, out);
    if (!end.last) return out;
    weigh_residual(end.curves.finer ? end.curves.finer->residual : nan, out);
    out.gain.shape = end.curves.gain / std::abs(design.J + end.g.r.volume_penalty * design.area);
  }
  return out;
}

/// What the phases stand for, as a body.
void take_strong_phase(const LevelSetEnd& end, bool go_on, OptimizeResult& result) {
  const Ground& g = end.g;
  result.scene.regions.clear();
  try {
    Carved carved = carved_again(g, end.descent.progress().phi);
    Problem judged = g.p;
    result.scene = with_cracks(scenes_of(g.p, g.r).front(), carved.crack_of);
    judged.scene.laws = result.scene.laws;
    judged.objective = on_parts(g.p.objective, carved.crack_of);
    OptimizeRequest asked = g.r;
    for (FunctionalBound& bound : asked.bounds) bound.functional = on_parts(bound.functional, carved.crack_of);
    result.shape = std::move(carved.shape);
    constexpr std::string_view both =
        "objective and volume are those with the weak phase; the state is that of the design without it";
    result.notes.emplace_back(both);
    if (!go_on) return;
    result.finer = solve_finer(std::move(judged), asked, result.shape, g.whole);
    ++result.state_solves;
  } catch (const Error& error) {
    if (error.fault != Fault::Geometry) throw;
    result.finer.failure = fmt::format("the strong phase alone is no body: {}", error.what());
    result.notes.push_back(result.finer.failure);
  }
}

/// How many constraints on the shape itself (frozen regions, widths, the mirror) it does not keep.
std::ptrdiff_t broken(const LevelSetEnd& end, const Shape& shape) {
  const LevelSetRequest& how = end.g.r.level_set;
  OptimizeRequest asked;
  asked.level_set.frozen = how.frozen;
  asked.level_set.mirror = how.mirror;
  asked.level_set.min_feature = how.min_feature;
  asked.level_set.min_gap = how.min_gap;
  return std::ranges::count_if(constraints_of({.shape = shape, .frame = &end.g.p.frame}, asked),
                               [](const KeptConstraint& c) { return !c.kept; });
}

}  // namespace

// A design that violates nothing beats one that does, whatever J. With bounds 2 % of J are allowed to the curves,
// without 0.08 %: what meshes of these sizes differ by.
bool curves_are_better(const LevelSetEnd& end) {
  const FinishedCurves& c = end.curves;
  if (c.shape.outline.sides.empty() || !std::isfinite(c.J)) return false;
  const Evaluated& e = end.descent.design();
  const OptimizeRequest& r = end.g.r;
  const double before = violation_of(r, e.bounds, e.area / end.g.whole),
               after = violation_of(r, c.bounds, c.area / end.g.whole);
  if (after >= feasible_violation || before >= feasible_violation) return after < before;
  if (const auto of_curves = broken(end, c.shape), of_carved = broken(end, e.shape); of_curves != of_carved)
    return of_curves < of_carved;
  // Curves leave room in bounds for what a finer mesh says, which costs J.
  const double meshes_differ = r.bounds.empty() ? 8e-4 : 2e-2, J = end.last ? end.last->J : c.J;
  if (J + r.volume_penalty * c.area <= (e.J + r.volume_penalty * e.area) + meshes_differ * std::abs(e.J)) return true;
  // A carved design without that room may be no design at all.
  const bool kept = !r.bounds.empty() && c.finer && c.finer->violation < feasible_violation;
  return kept && solve_finer(end.g.p, r, e, end.g.whole).violation >= feasible_violation;
}

std::shared_ptr<const Evaluated> solve_again(const LevelSetEnd& end) {
  Problem p = end.g.p;
  p.sizing.size = end.g.mesh_size;
  return std::make_shared<const Evaluated>(evaluate_design(p, end.g.r, end.curves.shape, end.curves.crack_of));
}

// The design on a finer mesh is solved for once more, unless the curves have been there.
OptimizeResult result_of(const LevelSetEnd& end, bool go_on) {
  const DescentState& s = end.descent.progress();
  const Evaluated& design = end.last ? *end.last : end.descent.design();
  OptimizeResult result{.method = OptimizeMethod::LevelSet};
  result.notes = end.g.notes;
  result.notes.insert(result.notes.end(), end.curves.notes.begin(), end.curves.notes.end());
  result.nucleated = s.nucleated;
  result.history = s.rows;
  result.history.insert(result.history.end(), end.finishing.begin(), end.finishing.end());
  const Iteration& row = last_taken(result.history);
  result.iterations = result.history.back().number;
  result.state_solves = result.history.back().state_solves;
  result.objective = row.objective;
  result.volume_fraction = row.volume_fraction;
  result.shape = design.shape;
  result.scene = design.cases.front().model.scene;
  const LoopEnd judged = loop_end(end, design, go_on, result);
  if (end.g.weak()) {
    take_strong_phase(end, go_on, result);
  } else if (go_on) {
    const FinishedCurves& curves = end.curves;
    if (end.last && curves.finer) {
      result.finer = *curves.finer;
    } else {
      result.finer = solve_finer(end.g.p, end.g.r, design, end.g.whole);
    }
    ++result.state_solves;
  }
  judge(result, end.g.r, judged);
  return result;
}

}  // namespace kerf
