// A level-set run from the start to the result: the best of some starts (starts.cpp), the descent (descent.cpp), its
// design as curves (finishing.cpp), the curves on the mesh that kerf solve would make, and what is said of it
// (end.cpp). After every iteration the state of the descent and the rows of the curves go to the checkpoint. A run that
// resumes draws and solves the design of its last row again and refuses a checkpoint whose numbers differ by more than
// 1e-6, which is what another machine may change. Curves are replayed from their rows. docs/theory/level_set.md and
// docs/theory/curves.md.

#include "base/kept_memory.hpp"
#include "optimize/checkpoint_reader.hpp"
#include "optimize/level_set/descent.hpp"
#include "optimize/level_set/end.hpp"
#include "optimize/level_set/finishing.hpp"
#include "optimize/level_set/starts.hpp"
#include "optimize/load_cases.hpp"
#include "optimize/refuse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Rows of the history are those of the descent, then one per evaluation of the curves, then the result.
class LevelSetRun {
 public:
  LevelSetRun(const Problem& p, const OptimizeRequest& r, const Observer& see, const CheckpointPlace& place)
      : see_(see), place_(place), ground_(make_ground(p, r)) {}
  OptimizeResult run();

 private:
  void begin();
  bool restore();
  bool is_as_told(const Evaluated& e, const Iteration& row) const;
  bool show_new();
  bool make_curves(FinishedCurves& finished);
  bool descend(FinishedCurves& finished);
  void show_last(LevelSetEnd& end, bool go_on) const;
  void save() const;

  const Observer& see_;
  const CheckpointPlace& place_;
  Ground ground_;
  std::unique_ptr<Descent> descent_;
  std::size_t shown_ = 0;             // rows
  std::vector<CurvesRow> curves_;     // evaluated so far
  std::vector<Iteration> finishing_;  // the same as rows of the history
};

DescentRules rules_of(const Ground& g) {
  return {.iterations = g.r.max_iterations};
}

// Solves of the ranking count in the history from its first row on.
void LevelSetRun::begin() {
  const LevelSetStart start = best_start(ground_);
  DescentRules rules = rules_of(ground_);
  rules.explore = start.explore;
  rules.from = start.name;
  rules.solves = start.solves;
  rules.ended = start.ended;
  descent_ = std::make_unique<Descent>(ground_, rules, start.phi);
}

/// Rows that are new, those of steps that were taken with their design. Whether to go on.
bool LevelSetRun::show_new() {
  bool go_on = true;
  const std::vector<Iteration>& rows = descent_->progress().rows;
  // A step that was refused leaves the design; nothing but the last row has one.
  if (shown_ < rows.size() && rows.back().accepted && see_) go_on = see_(descent_->iterate());
  shown_ = rows.size();
  return go_on;
}

/// Whether to go on after them.
/// Rows known from a checkpoint come through `see` as well, and are not kept twice; from where they differ they go.
bool LevelSetRun::make_curves(FinishedCurves& finished) {
  const std::vector<CurvesRow> known = curves_;
  const DescentState& s = descent_->progress();
  const int cases = static_cast<int>(descent_->design().cases.size());
  bool go_on = true;
  const auto row_of = [&](const CurvesRow& row) {
    const int number = s.iteration + 1 + static_cast<int>(finishing_.size());
    finishing_.push_back(iteration_of(row, number, s.solves, cases));
  };
  finishing_.clear();
  std::size_t seen = 0;
  const CurvesObserver see = [&](const CurvesIterate& i) {
    for (; seen < i.rows.size(); ++seen) {
      row_of(i.rows[seen]);
      if (seen < curves_.size() && !std::ranges::equal(curves_[seen].knots, i.rows[seen].knots)) curves_.resize(seen);
      if (seen >= curves_.size()) curves_.push_back(i.rows[seen]);
    }
    if (see_) go_on = see_({finishing_.back(), i.shape, i.model, i.state});
    save();
    return go_on;
  };
  finished = finish(ground_, *descent_, see, known);
  for (; seen < finished.rows.size(); ++seen) row_of(finished.rows[seen]);
  return go_on;
}

/// All the way down, then the curves. Whether to go on.
bool LevelSetRun::descend(FinishedCurves& finished) {
  const KeptMemory kept;
  bool go_on = true;
  if (!restore()) {
    begin();
    go_on = show_new();
    save();
  }
  while (go_on && descent_->advance()) {
    go_on = show_new();
    save();
  }
  if (go_on) go_on = show_new();
  save();
  if (go_on && can_finish(ground_, *descent_)) go_on = make_curves(finished);
  return go_on;
}

OptimizeResult LevelSetRun::run() {
  FinishedCurves finished;
  const bool go_on = descend(finished);
  LevelSetEnd end{ground_, *descent_, finished, finishing_};
  if (!finishing_.empty()) show_last(end, go_on);
  return result_of(end, go_on);
}

/// The result as a row of its own: the curves on the mesh that the case asks for, or the carved design.
void LevelSetRun::show_last(LevelSetEnd& end, bool go_on) const {
  const int number = end.finishing.back().number + 1, solves = end.finishing.back().state_solves;
  const auto show = [&](Iteration row, const Iterate& i) {
    row.number = number;
    end.finishing.push_back(std::move(row));
    if (see_ && go_on) see_({end.finishing.back(), i.shape, i.model, i.state});
  };
  std::string why = "its curves are no better";
  if (curves_are_better(end)) try {
      end.last = solve_again(end);
      // Asked again with J of the mesh that the case asks for.
      if (!curves_are_better(end)) throw Error(Fault::Numerics, why);
      const SolvedCase& c = end.last->cases.front();
      Iteration row = end.finishing.back();
      row.objective = row.merit = end.last->J;
      row.volume_fraction = area(end.last->shape) / ground_.whole;  // arcs, not their chords
      row.bounds = end.last->bounds;
      row.violation = violation_of(ground_.r, row.bounds, row.volume_fraction);
      row.optimality = end.curves.residual;
      row.step = 0;
      row.triangles = static_cast<Index>(c.model.mesh.triangles.size());
      row.state_solves = solves + 1;
      row.accepted = true;
      row.note = "the curves, meshed as kerf solve does";
      return show(std::move(row), {end.finishing.back(), end.last->shape, c.model, c.state});
    } catch (const Error& error) {
      if (!of_one_body(error)) throw;
      why = error.what();
      end.last = nullptr;
    }
  const Iterate carved = descent_->iterate();
  Iteration row = carved.row;
  row.state_solves = solves;
  row.note = "the design as carved: " + why;
  show(std::move(row), carved);
}

void LevelSetRun::save() const {
  if (place_.path.empty()) return;
  Checkpoint c = packed(descent_->progress());
  write_curves(c, curves_);
  keep(place_, std::move(c));
}

/// Whether the design, drawn and solved again, is the one of that row, up to what another machine may change.
bool LevelSetRun::is_as_told(const Evaluated& e, const Iteration& row) const {
  constexpr double digits = 1e-6;
  const auto near = [](double a, double b, double unit) { return a == b || std::abs(a - b) <= digits * unit; };
  const double share = e.area / ground_.whole, violation = violation_of(ground_.r, e.bounds, share);
  return near(row.objective, e.J, std::abs(e.J)) && near(row.volume_fraction, share, 1) &&
         near(row.violation, violation, 1 + violation) &&
         std::ranges::equal(row.bounds, e.bounds,
                            [&](double told, double here) { return near(told, here, std::abs(here)); });
}

// Nothing of a checkpoint is believed: its fingerprint, the ranges of its numbers, and the design drawn and solved
// again are compared.
bool LevelSetRun::restore() {
  if (!place_.resume || place_.path.empty()) return false;
  const std::optional<Checkpoint> c = read_checkpoint(place_.path);
  if (!c) return false;
  if (c->fingerprint != place_.fingerprint)
    throw Error(Fault::Usage, fmt::format("{} belongs to another case: run without --resume, or restore the case file",
                                          place_.path.string()));
  DescentState state = unpacked(*c);
  check_state(state, sizes_of_state(ground_));
  curves_ = read_curves(*c);
  try {
    descent_ = std::make_unique<Descent>(ground_, rules_of(ground_), std::move(state));
  } catch (const Error& error) {  // it was drawn and solved before
    if (!of_one_body(error)) throw;
    throw broken_checkpoint();
  }
  if (!is_as_told(descent_->design(), last_taken(descent_->progress().rows))) throw broken_checkpoint();
  shown_ = descent_->progress().rows.size();
  return true;
}

}  // namespace

OptimizeResult optimize_level_set(const Problem& p, const OptimizeRequest& r, const Observer& see,
                                  const CheckpointPlace& place) {
  refuse_wrong(p, r);
  const OptimizeRequest ordered = in_order(r);
  return LevelSetRun(p, ordered, see, place).run();
}

}  // namespace kerf
