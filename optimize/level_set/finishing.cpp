// The last part of a level-set run: the carved design as arcs, moved to an optimum of first order (optimize/curves).
// Bounds are tightened first by what a finer mesh says more of the fitted curves than their own, for stresses by half
// as much again and 0.2 %, so that the result keeps its bounds where it is judged. Rows of the curves are kept in the
// checkpoint bit for bit, and an interrupted run replays them instead of solving anew. Curves that cannot be fitted or
// solved leave the carved design, with a note. docs/theory/curves.md has the curves themselves.

#include "optimize/level_set/finishing.hpp"

#include "optimize/checkpoint_reader.hpp"
#include "optimize/curves/stress_rows.hpp"
#include "optimize/density/stress_design.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/loop/history_text.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

namespace {

constexpr int most_evaluations = 60, least_evaluations = 4;
constexpr double residual = 2e-2;  // of the shape

void append(std::vector<double>& all, const Eigen::VectorXd& v) {
  all.push_back(static_cast<double>(v.size()));
  all.insert(all.end(), v.begin(), v.end());
}
/// Bounds that leave room for what a finer mesh says more than the one of the curves does.
OptimizeRequest with_room(const Ground& g, const Problem& p, const Carved& carved, const CurvesRequest& how) {
  constexpr double drift = 1.5, least = 2e-3;  // stresses of other designs differ more between meshes
  OptimizeRequest r = g.r;
  const auto follows = [](const FunctionalBound& b) { return largest_of(b.functional) != nullptr; };
  if (std::ranges::all_of(r.bounds, follows)) return r;
  const Shape shape = fit_curves(p, r, carved, how);
  const Evaluated here = evaluate_design(p, r, shape, carved.crack_of);
  const FinerDesign finer = solve_finer(p, r, here, g.whole);
  const std::vector<double> more = excess_of(finer, here.bounds);
  for (std::size_t k = 0; k < more.size(); ++k) {
    double excess = more[k];
    // What boxes say of largest stresses follows finer meshes by itself.
    if (largest_of(r.bounds[k].functional)) continue;
    if (counts_stress(r.bounds[k].functional)) excess = drift * std::max(excess, 0.0) + least;
    if (excess > 0) r.bounds[k].at_most -= std::min(excess, most_room) * std::abs(r.bounds[k].at_most);
  }
  return r;
}

}  // namespace

// Numbers of a row, then its vectors with their lengths, in the order of read_curves; texts by line.
void write_curves(Checkpoint& c, const std::vector<CurvesRow>& rows) {
  std::vector<double> all;
  std::string texts;
  for (const CurvesRow& r : rows) {
    for (const double x :
         {r.J, r.area, r.area_fraction, r.violation, r.residual, r.price, r.step, double(r.triangles), double(r.holes),
          double(r.state_solves), double(r.accepted), double(r.fresh), double(r.rebased)})
      all.push_back(x);
    for (const Eigen::VectorXd& v : {Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                         r.bounds.data(), static_cast<Eigen::Index>(r.bounds.size()))),
                                     r.knots, r.values, r.gradients})
      append(all, v);
    append_line(texts, r.note);
    append_line(texts, r.failure);
  }
  c.numbers["curves"] = Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  c.texts["curves"] = texts;
}

// Numbers are read by kind: counts and flags are refused where they are none.
std::vector<CurvesRow> read_curves(const Checkpoint& c) {
  NumberReader in(numbers_of(c, "curves"));
  LineReader texts(text_of(c, "curves"));
  std::vector<CurvesRow> rows;
  while (!in.empty()) {
    CurvesRow r;
    for (double* x : {&r.J, &r.area, &r.area_fraction, &r.violation, &r.residual, &r.price, &r.step}) *x = in.any();
    for (int* n : {&r.triangles, &r.holes, &r.state_solves}) *n = in.count();
    for (bool* b : {&r.accepted, &r.fresh, &r.rebased}) *b = in.flag();
    const Eigen::VectorXd bounds = in.take_counted();
    r.bounds.assign(bounds.begin(), bounds.end());
    for (Eigen::VectorXd* v : {&r.knots, &r.values, &r.gradients}) *v = in.take_counted();
    r.note = texts.line();
    r.failure = texts.line();
    rows.push_back(std::move(r));
  }
  texts.end();
  return rows;
}

// Curves take iterations too: at least a few must be left.
bool can_finish(const Ground& g, const Descent& d) {
  return !g.weak() && d.settled() && g.r.max_iterations - d.progress().iteration > least_evaluations;
}

// A solve of the history is one of all load cases, as elsewhere in it.
Iteration iteration_of(const CurvesRow& row, int number, int solves_before, int cases) {
  Iteration i{.number = number,
              .objective = row.J,
              .merit = row.J,
              .volume_fraction = row.area_fraction,
              .bounds = row.bounds,
              .violation = row.violation,
              .step = row.step,
              .optimality = row.residual,
              .holes = row.holes,
              .triangles = row.triangles,
              .state_solves = solves_before + row.state_solves / cases,
              .accepted = row.accepted,
              .note = join({"curves", row.note})};
  return i;
}

// One evaluation is left for the curves on the mesh that the case asks for.
FinishedCurves finish(const Ground& g, const Descent& d, const CurvesObserver& see,
                      const std::vector<CurvesRow>& known) {
  CurvesRequest how{.size = g.size,
                    .min_radius = g.r.level_set.min_radius,
                    .min_feature = g.r.level_set.min_feature,
                    .min_gap = g.r.level_set.min_gap,
                    .residual = residual};
  for (const FunctionalBound& bound : g.r.bounds) how.at_most.push_back(bound.at_most);
  const int most = bounds_largest_stress(g.r) ? g.r.max_iterations : most_evaluations;
  how.further = g.r.max_iterations - d.progress().iteration - 1;
  how.evaluations = std::min(most, how.further);
  const Problem drawn = fitted(g, 1);
  try {
    const Carved carved = carved_again(g, d.progress().phi);
    return finish_curves(drawn, with_room(g, drawn, carved, how), carved, how, see, known);
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    FinishedCurves out;
    out.why = fmt::format("the design stays as carved: {}", error.what());
    return out;
  }
}

}  // namespace kerf
