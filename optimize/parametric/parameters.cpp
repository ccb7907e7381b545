// Minimization over the variables of a design in rounds, each on a fresh mesh that follows the design, until a round
// lowers J by less than the tolerance. Every round but the first is a restart that confirms the end of the one before:
// its residuals are relative to what J is now, not to what it was at the start of all, which makes every end of a bad
// start look like an optimum. Where J has gone to zero, as misfits and release rates do, they are relative to what J
// errs by on the mesh, by the finer mesh, where that is more. The derivative is checked once against central
// differences along one direction, with three steps as contact may change within the longer ones. After every
// evaluation the checkpoint has all of it; a run that resumes replays evaluations in their order and refuses a
// checkpoint whose designs are not those that it asks for. Of several starts the best one goes on (starts.cpp). When a
// round changes little, the design is solved on a finer mesh. Bounds that are violated there allow less from then on,
// twice at most, and rounds go on. At the end it is judged there (optimize/loop/finish.cpp). docs/theory/level_set.md,
// section "Drawn designs".

#include "kerf/optimize.hpp"

#include "optimize/checkpoint_reader.hpp"
#include "optimize/load_cases.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/parametric/evaluations.hpp"
#include "optimize/parametric/start.hpp"
#include "optimize/parametric/starts.hpp"
#include "optimize/refuse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double feasibility = 1e-6;  // relative violations that do not count
constexpr int most_rooms = 2;         // times that bounds are made to leave room
constexpr int confirming = 10;        // evaluations that try to better an end that looks like an optimum
constexpr double fallen = 0.1;        // of J at the start: below it, what is left may be the error of the mesh

/// Squares, gaps and release rates: the least that they can be is 0.
bool vanishes(const Term& t) {
  return t.measured || (!t.linear && !t.energy && !t.volume && !t.work && !(t.stress_power > 0) && !t.edge_cracks);
}
bool is_never_negative(const Term& t) {
  return vanishes(t) || t.volume || t.work || t.stress_power > 0 || t.edge_cracks;
}
bool all_of_terms(const Functional& j, bool (*holds)(const Term&)) {
  return std::ranges::all_of(j.terms, [&](const Term& t) { return t.factor >= 0 && holds(t); });
}

// Evaluations as numbers, for the checkpoint.
constexpr Eigen::Index head = 11;
// Eleven numbers, then bounds, x, values and gradients; unpacked reads in this order.
VectorXd packed(const DesignEvaluation& t) {
  const Evaluation& e = t.evaluation;
  const auto bounds = static_cast<Eigen::Index>(t.bounds.size());
  VectorXd v(head + bounds + e.x.size() + e.values.size() + e.gradients.size());
  v.head<head>() << t.round, t.base, t.fresh ? 1 : 0, t.objective, t.volume_fraction, t.triangles, t.holes,
      t.state_solves, static_cast<double>(bounds), static_cast<double>(e.x.size()),
      static_cast<double>(e.gradients.cols());
  Eigen::Index at = head;
  for (const double b : t.bounds) v[at++] = b;
  v.segment(at, e.x.size()) = e.x;
  at += e.x.size();
  v.tail(e.gradients.size()) = e.gradients.reshaped();
  v.segment(at, e.values.size()) = e.values;
  return v;
}

// A checkpoint may be broken: every count and number is looked at before it is used.
DesignEvaluation unpacked(const VectorXd& v, const std::string& failure) {
  NumberReader in(v);
  DesignEvaluation t;
  t.round = in.count();
  t.base = in.count(most_counted, none);
  t.fresh = in.flag();
  t.objective = in.any();
  t.volume_fraction = in.any();
  t.triangles = in.count();
  t.holes = in.count();
  t.state_solves = in.count();
  const int bounds = in.count(), n = in.count(), columns = in.count();
  const VectorXd bounded = in.take(bounds);
  t.bounds.assign(bounded.begin(), bounded.end());
  t.evaluation.x = in.take_finite(n);
  const Eigen::Index values = v.size() - head - bounds - n - static_cast<Eigen::Index>(n) * columns;
  if (values < 1 || (columns > 0 && columns != values)) throw broken_checkpoint();
  t.evaluation.values = in.take(values);
  t.evaluation.gradients = in.take(static_cast<Eigen::Index>(n) * columns).reshaped(n, columns);
  t.evaluation.failure = failure;
  // What could be evaluated has numbers everywhere.
  if (failure.empty() && !(std::isfinite(t.objective) && t.evaluation.values.allFinite() &&
                           t.evaluation.gradients.allFinite() && bounded.allFinite()))
    throw broken_checkpoint();
  return t;
}

VectorXd packed(const StartTried& t) {
  VectorXd v(6 + t.from.size() + t.variables.size());
  v << t.merit, t.violation, t.in_full ? 1 : 0, t.state_solves, t.end, static_cast<double>(t.from.size()), t.from,
      t.variables;
  return v;
}

StartTried start_unpacked(const VectorXd& v, const std::string& failure) {
  NumberReader in(v);
  StartTried t;
  t.merit = in.any();
  t.violation = in.any();
  t.in_full = in.flag();
  t.state_solves = in.count();
  t.end = in.count();
  t.from = in.take_counted();
  t.variables = in.take(v.size() - 6 - t.from.size());
  t.failure = failure;
  return t;
}

/// A direction in boxes with entries of size 1/2 to 1, the same everywhere.
/// No entry is small, so that no variable goes unchecked.
VectorXd some_direction(Eigen::Index n) {
  std::mt19937 bits(20240229u);
  VectorXd d(n);
  for (double& v : d) {
    const double size = 0.5 + 0.5 * (static_cast<double>(bits()) / 4294967296.0);
    v = bits() % 2 == 0 ? size : -size;
  }
  return d;
}

class Rounds {
 public:
  Rounds(const Problem& problem, const OptimizeRequest& request, const Observer& see, const CheckpointPlace& place,
         const TaskPool& pool)
      : problem_(problem),
        request_(request),
        see_(see),
        place_(place),
        pool_(pool),
        evaluations_(problem, request),
        lower_(lower_bounds(request.design)),
        upper_(upper_bounds(request.design)) {}

  OptimizeResult run();

 private:
  DesignEvaluation evaluate(const VectorXd& x, bool gradients);
  void check_derivatives(const DesignEvaluation& start);
  bool look_at(const Evaluation& e, double kkt);
  void show(const Iteration& row, const DesignEvaluation& design);
  void keep();
  void write();
  void restore();
  Program program(std::optional<DesignEvaluation>& begun);
  std::optional<DesignEvaluation> begin_round(int round, const VectorXd& x, Minimum& found);
  void note(const Minimum& found);
  bool settled(const Iteration& begin, const Iteration& end, bool feasible) const;
  FinerDesign solve_finer_design(const VectorXd& x) const;
  const FinerDesign& finer_design_of(const VectorXd& x);
  double error_by_mesh(const Iteration& row);
  bool leave_room(const Iteration& row);
  OptimizeResult finish(const Minimum& found, std::size_t best);
  bool wants_gradients() const {
    return request_.method != OptimizeMethod::Cobyla;
  }
  VectorXd begin();
  VectorXd best_of_starts(const VectorXd& given);
  int left() const {  // of the evaluations
    return request_.max_iterations - static_cast<int>(next_);
  }

  const Problem& problem_;
  const OptimizeRequest& request_;
  const Observer& see_;
  const CheckpointPlace& place_;
  const TaskPool& pool_;
  Evaluations evaluations_;
  VectorXd lower_, upper_;
  std::vector<DesignEvaluation> done_;   // evaluated, in this run or before it was interrupted
  std::size_t restored_ = 0, next_ = 0;  // how many of them are from before, and how many this run has seen
  Checkpoint checkpoint_;
  int state_solves_ = 0;
  std::optional<std::string> checked_;  // note of the derivative check
  int checked_solves_ = 0;
  OptimizeResult result_;
  std::vector<std::size_t> evaluation_of_row_;  // of the history
  bool first_of_round_ = true, stopped_ = false;
  int rooms_ = 0;                // times that bounds were made to leave room
  std::vector<double> at_most_;  // what they allow since
  bool more_room_ = false;       // in the round that begins
  VectorXd finer_at_;            // the design that finer_ is of
  FinerDesign finer_;
  double mesh_error_ = 0;  // of J at the end of the last round, where J goes to zero
  double accepted_merit_ = nan, accepted_violation_ = nan;
};

// Evaluations are read in their order until a number is missing; nothing is solved.
void Rounds::restore() {
  if (place_.path.empty() || !place_.resume) return;
  const std::optional<Checkpoint> found = read_checkpoint(place_.path);
  if (!found) return;
  if (found->fingerprint != place_.fingerprint || text_of(*found, "method") != word(request_.method))
    throw Error(Fault::Usage, fmt::format("the checkpoint {} belongs to another case or method; start without --resume",
                                          place_.path.string()));
  checkpoint_ = *found;
  if (const auto note = found->texts.find("checked"); note != found->texts.end()) {
    checked_ = note->second;
    checked_solves_ = NumberReader(numbers_of(*found, "checked")).count();
  }
  for (std::size_t i = 0;; ++i) {
    const std::string key = fmt::format("trial {:06}", i);
    const auto numbers = found->numbers.find(key);
    if (numbers == found->numbers.end()) break;
    const auto failure = found->texts.find(key);
    done_.push_back(unpacked(numbers->second, failure == found->texts.end() ? "" : failure->second));
  }
  restored_ = done_.size();
}

/// Everything that was evaluated so far goes to disk.
void Rounds::keep() {
  if (place_.path.empty() || done_.empty()) return;
  if (checked_) {
    checkpoint_.texts["checked"] = *checked_;
    checkpoint_.numbers["checked"] = VectorXd::Constant(1, checked_solves_);
  }
  // The newest evaluation is added; the file is written whole.
  const std::size_t i = done_.size() - 1;
  const std::string key = fmt::format("trial {:06}", i);
  checkpoint_.numbers[key] = packed(done_[i]);
  if (!done_[i].evaluation.failure.empty()) checkpoint_.texts[key] = done_[i].evaluation.failure;
  write();
}

void Rounds::write() {
  if (place_.path.empty()) return;
  checkpoint_.texts["method"] = word(request_.method);
  kerf::keep(place_, checkpoint_);
}

DesignEvaluation Rounds::evaluate(const VectorXd& x, bool gradients) {
  if (next_ < done_.size()) {
    const DesignEvaluation& known = done_[next_];
    // To the last bit: the minimizer's questions follow from the answers before.
    const bool fits = known.evaluation.x.size() == x.size() && known.evaluation.x == x &&
                      known.evaluation.values.size() == 1 + evaluations_.constraints() &&
                      (known.evaluation.gradients.cols() > 0) == gradients &&
                      (known.bounds.empty() || known.bounds.size() == request_.bounds.size());
    if (!fits || !evaluations_.replay(known))
      throw Error(Fault::Files, fmt::format("evaluation {} of the checkpoint {} is not the one that this run makes "
                                            "(another version or machine?); start without --resume",
                                            next_ + 1, place_.path.string()));
  } else {
    done_.push_back(evaluations_.evaluate(x, gradients));
  }
  ++next_;
  state_solves_ += done_[next_ - 1].state_solves;
  return done_[next_ - 1];
}

// One direction with all variables in it, the best of three steps, once per run; its outcome is in the checkpoint.
void Rounds::check_derivatives(const DesignEvaluation& start) {
  if (!checked_) {
    constexpr double allowed = 1e-2;
    const VectorXd direction = some_direction(lower_.size());
    double worst = 0;
    std::string where;
    // Contact may change within the longer steps.
    for (const double step : {1e-4, 1e-5, 1e-6}) {
      const Evaluations::Check check = evaluations_.check_derivatives(start, direction, step);
      checked_solves_ += check.state_solves;
      const auto most = std::max_element(check.error.begin(), check.error.end());
      const auto k = static_cast<Eigen::Index>(most - check.error.begin());
      if (where.empty() || *most < worst) {
        worst = *most;
        where = k == 0 ? "the objective" : fmt::format("the constraint \"{}\"", evaluations_.constraint(k - 1));
      }
      if (worst <= allowed) break;
    }
    if (!(worst <= allowed))
      throw Error(Fault::Numerics,
                  fmt::format("the derivative of {} is off by {:.2g} (relative) from central differences at the start; "
                              "contact may be about to change there: move the start, or use method = \"cobyla\"",
                              where, worst));
    checked_ = fmt::format("derivative check at the start: within {:.1e} of central differences", worst);
  }
  state_solves_ += checked_solves_;
  result_.notes.push_back(*checked_);
}

void Rounds::show(const Iteration& row, const DesignEvaluation& design) {
  if (!see_) return;
  const std::shared_ptr<const SolvedDesign> solved = evaluations_.solved(design);
  if (!see_({row, solved->body.shape, solved->model, solved->state})) stopped_ = true;
}

/// After every evaluation: a row of the history when it is accepted, the observer, the checkpoint.
/// A row is accepted when it is better than all before in its round: less violation, or feasible and lower.
bool Rounds::look_at(const Evaluation& e, double kkt) {
  const std::size_t number = next_ - 1;
  const DesignEvaluation& design = done_[number];
  const bool replayed = number < restored_;
  const double violation = violation_of(e);
  const bool feasible = violation <= feasibility, was_feasible = accepted_violation_ <= feasibility;
  const bool better = feasible ? !was_feasible || design.evaluation.values[0] < accepted_merit_
                               : !was_feasible && violation < accepted_violation_;
  if (e.failure.empty() && e.x == design.evaluation.x && (first_of_round_ || better)) {
    std::vector<Iteration>& history = result_.history;
    Iteration row;
    row.number = static_cast<int>(history.size());
    row.objective = design.objective;
    row.merit = design.evaluation.values[0];
    row.volume_fraction = design.volume_fraction;
    row.bounds = design.bounds;
    row.violation = violation;
    if (!history.empty())
      for (Eigen::Index i = 0; i < lower_.size(); ++i)
        if (upper_[i] > lower_[i])
          // The largest change of a variable since the row before, in boxes.
          row.step = std::max(row.step, std::abs(e.x[i] - history.back().variables[i]) / (upper_[i] - lower_[i]));
    row.optimality = kkt;
    row.holes = design.holes;
    row.triangles = design.triangles;
    row.state_solves = state_solves_;
    row.variables = e.x;
    if (first_of_round_ && !history.empty())
      row.note = more_room_ ? "a fresh mesh, and bounds that leave room for what a finer one says" : "a fresh mesh";
    if (!history.empty() && row.merit > history.back().merit)
      row.note += fmt::format("{}the objective rose because {}", row.note.empty() ? "" : ": ",
                              first_of_round_ ? "the mesh is another one" : "a constraint was violated before");
    more_room_ &= !first_of_round_;
    accepted_merit_ = row.merit;
    accepted_violation_ = violation;
    first_of_round_ = false;
    history.push_back(std::move(row));
    evaluation_of_row_.push_back(number);
    if (!replayed) show(history.back(), design);
  } else if (!std::isnan(kkt)) {  // cobyla: derivatives asked for afterwards
    for (Iteration& row : result_.history)
      if (std::isnan(row.optimality) && row.variables == e.x) row.optimality = kkt;
  }
  if (!replayed) keep();
  return !stopped_;
}

/// What the minimizer asks for, answered and recorded here. `begun`: the first evaluation of a round, made already.
Program Rounds::program(std::optional<DesignEvaluation>& begun) {
  Program program;
  program.lower = lower_;
  program.upper = upper_;
  program.constraints = evaluations_.constraints();
  program.gradients = !evaluations_.blind();
  program.evaluate = [this, &begun](const VectorXd& x, bool gradients) {
    if (begun) return std::exchange(begun, std::nullopt)->evaluation;
    return evaluate(x, gradients).evaluation;
  };
  program.see = [this](const Evaluation& e, double kkt) { return look_at(e, kkt); };
  return program;
}

/// Notes of a minimization, each once where it is about a failure.
void Rounds::note(const Minimum& found) {
  for (const std::string& note : found.notes) result_.notes.push_back(note);
  for (const std::string& failure : found.failure) {
    const std::string note = "a trial could not be evaluated: " + failure;
    if (std::ranges::find(result_.notes, note) == result_.notes.end()) result_.notes.push_back(note);
  }
}

/// Whether a round from `begin` to `end` changed little: by less than the tolerance of J, or than what the mesh errs
/// by.
bool Rounds::settled(const Iteration& begin, const Iteration& end, bool feasible) const {
  const double scale = std::max(std::abs(begin.merit), std::abs(end.merit));
  const bool was_feasible = begin.violation <= feasibility;
  return was_feasible == feasible &&
         (feasible ? begin.merit - end.merit <= std::max(request_.tolerance * scale, mesh_error_)
                   : begin.violation - end.violation <= request_.tolerance * begin.violation);
}

/// The first evaluation of a round, on a fresh mesh; nothing, and why, when the best design cannot be evaluated there.
std::optional<DesignEvaluation> Rounds::begin_round(int round, const VectorXd& x, Minimum& found) {
  evaluations_.begin_round();
  first_of_round_ = true;
  accepted_merit_ = accepted_violation_ = nan;
  if (round > 0 && left() < 1) {
    found.reason = "all evaluations are used";
    found.converged = false;
    return std::nullopt;
  }
  DesignEvaluation begun = evaluate(x, wants_gradients());
  // Without a start there is no run; a later round leaves the design of the one before.
  if (const std::string& failure = begun.evaluation.failure; !failure.empty()) {
    if (round == 0) throw Error(begun.fault, fmt::format("the start of the design cannot be evaluated: {}", failure));
    if (next_ > restored_) keep();
    found.converged = false;
    found.reason = "the best design cannot be evaluated on a fresh mesh: " + failure;
    return std::nullopt;
  }
  if (round == 0 && wants_gradients()) check_derivatives(begun);
  return begun;
}

/// The start of the design; where that cannot be drawn, the nearest one that can.
VectorXd Rounds::begin() {
  const VectorXd given = start_of(request_.design);
  std::string obstacle;
  const std::optional<VectorXd> x = repaired(given, problem_, request_, &obstacle);
  if (!x) return given;
  if (*x != given) result_.notes.push_back(fmt::format("the start was moved to where it can be drawn: {}", obstacle));
  return *x;
}

/// Where the best of several starts has got to; from the checkpoint where it is there.
VectorXd Rounds::best_of_starts(const VectorXd& given) {
  const auto key = [](std::size_t i) { return fmt::format("start {:06}", i); };
  std::vector<StartTried>& all = result_.starts;
  for (std::size_t i = 0; checkpoint_.numbers.contains(key(i)); ++i) {
    const auto failure = checkpoint_.texts.find(key(i));
    all.push_back(
        start_unpacked(checkpoint_.numbers.at(key(i)), failure == checkpoint_.texts.end() ? "" : failure->second));
  }
  // A checkpoint has all starts or none.
  if (all.empty()) all = try_starts(problem_, request_, given, pool_);
  for (std::size_t i = 0; i < all.size(); ++i) {
    checkpoint_.numbers[key(i)] = packed(all[i]);
    if (!all[i].failure.empty()) checkpoint_.texts[key(i)] = all[i].failure;
    state_solves_ += all[i].state_solves;
  }
  write();
  const auto best = std::ranges::find_if(all, [](const StartTried& t) { return t.in_full; });
  const auto fits = [&](const VectorXd& x) { return x.size() == 0 || (x.size() == given.size() && x.allFinite()); };
  if (!std::ranges::all_of(all, [&](const StartTried& t) { return fits(t.from) && fits(t.variables); }) ||
      best == all.end() || best->variables.size() != given.size() || (best->variables.array() < lower_.array()).any() ||
      (best->variables.array() > upper_.array()).any())
    throw broken_checkpoint();
  result_.notes.push_back(
      fmt::format("{} starts, compared on a coarse mesh: the best one, number {}, reaches {:.6g}, the given one {}",
                  all.size(), best - all.begin() + 1, best->merit,
                  std::isnan(all[0].merit) ? "nothing: " + all[0].failure : fmt::format("{:.6g}", all[0].merit)));
  for (std::string& line : ends_in_words(all)) result_.notes.push_back(std::move(line));
  return best->variables;
}

/// The design on the mesh by which designs are judged.
FinerDesign Rounds::solve_finer_design(const VectorXd& x) const {
  Problem judged = problem_;
  DrawnBody body = body_of(request_.design, x, problem_);
  judged.scene = std::move(body.scene);
  return solve_finer(std::move(judged), request_, body.shape, evaluations_.frame_area());
}

const FinerDesign& Rounds::finer_design_of(const VectorXd& x) {
  if (finer_at_.size() == 0 || finer_at_ != x) {
    finer_ = solve_finer_design(x);
    finer_at_ = x;  // the end asks for the same design
  }
  return finer_;
}

/// What J errs by on the mesh of the steps, by the finer one, where it goes to zero and has fallen far.
double Rounds::error_by_mesh(const Iteration& row) {
  const double first = std::abs(result_.history.front().objective);
  if (!all_of_terms(problem_.objective, vanishes) || !(std::abs(row.objective) <= fallen * first)) return 0;
  const FinerDesign& finer = finer_design_of(row.variables);
  state_solves_ += static_cast<int>(std::max<std::size_t>(1, request_.load_cases.size()));
  return finer.failure.empty() ? std::abs(finer.objective - row.objective) : 0;
}

/// Where a finer mesh finds that bounds are violated, by what it proves of them, they allow less from now on. Whether
/// there is a reason to go on.
/// What was decided before an interruption is read back, not decided anew.
bool Rounds::leave_room(const Iteration& row) {
  if (request_.bounds.empty() || rooms_ == most_rooms) return false;
  const std::string key = fmt::format("room {:06}", rooms_);
  if (const auto known = checkpoint_.numbers.find(key); known != checkpoint_.numbers.end()) {
    NumberReader in(known->second);
    const VectorXd tight = in.take_finite(static_cast<Eigen::Index>(request_.bounds.size()));
    in.end();
    at_most_.assign(tight.begin(), tight.end());
  } else {
    std::vector<double> tight = with_more_room(finer_design_of(row.variables), request_, at_most_, row.bounds);
    if (tight.empty()) return false;
    at_most_ = std::move(tight);
    checkpoint_.numbers[key] = Eigen::Map<const VectorXd>(at_most_.data(), static_cast<Eigen::Index>(at_most_.size()));
    write();
  }
  ++rooms_;
  more_room_ = true;
  state_solves_ += static_cast<int>(std::max<std::size_t>(1, request_.load_cases.size()));
  evaluations_.allow(at_most_);
  for (std::size_t k = 0; k < at_most_.size(); ++k)
    if (at_most_[k] != request_.bounds[k].at_most)
      result_.notes.push_back(
          fmt::format("{}: on the mesh of the steps at most {:.6g}, for the difference to the finer mesh",
                      request_.bounds[k].name, at_most_[k]));
  return true;
}

// Rounds go on from the best design of the one before, with a smaller simplex for cobyla.
OptimizeResult Rounds::run() {
  restore();
  for (const FunctionalBound& bound : request_.bounds) at_most_.push_back(bound.at_most);
  const OptimizeMethod method = request_.method;
  // The first evaluation of a round is made before NLopt asks for it: a mesh has to be there.
  std::optional<DesignEvaluation> begun;
  const Program asked = program(begun);
  VectorXd x = begin();
  if (request_.starts > 1) x = best_of_starts(x);
  Minimum found;
  std::size_t best = 0;  // row of the history
  double scale = 0;      // of derivatives, at the start of all
  // What may cross zero has no scale of its own.
  const bool scaled_anew = all_of_terms(problem_.objective, is_never_negative) && request_.volume_penalty >= 0;
  constexpr int most_rounds = 25;
  for (int round = 0;; ++round) {
    const std::size_t first = result_.history.size();
    const int evaluations = left();
    begun = begin_round(round, x, found);
    if (!begun) break;
    const Evaluation start = begun->evaluation;
    if (round == 0) scale = scale_of(start, lower_, upper_);
    const double scaled_by = round > 0 && scaled_anew ? mesh_error_ : scale;
    // An end that looks like an optimum is confirmed by a few steps that ask for more.
    const double kkt = start.gradients.cols() > 0
                           ? kkt_residual(start, lower_, upper_, std::max(scale_of(start, lower_, upper_), scaled_by))
                           : nan;
    const bool is_confirmed_here = round > 0 && kkt <= request_.tolerance && violation_of(start) <= feasibility;
    // The objective's own tolerance is far below that of rounds: the KKT residual ends a round.
    found = minimize(asked, x, method,
                     {.evaluations = is_confirmed_here ? std::min(evaluations, confirming) : evaluations,
                      .kkt = (is_confirmed_here ? 0.1 : 1) * request_.tolerance,
                      .scale = scaled_by,
                      .feasibility = feasibility,
                      .value = (round == 0 ? 1e-3 : 1e-6) * request_.tolerance,
                      .simplex = round == 0 ? 0.1 : 0.02,
                      .reach = round == 0 ? 1 : 0.05,
                      .by_slope = is_confirmed_here});
    note(found);
    x = found.best.x;
    // Rows know their variables: the best design is the last row that has them.
    best = first;
    for (std::size_t i = first; i < result_.history.size(); ++i)
      if (result_.history[i].variables == x) best = i;
    if (found.asked_to_stop) break;
    mesh_error_ = error_by_mesh(result_.history[best]);
    const bool is_settled = settled(result_.history[first], result_.history[best], found.feasible);
    if (is_confirmed_here && is_settled && !found.converged) {
      // Those steps gained nothing: the end stands as it was.
      best = first;
      x = start.x;
      found.kkt = kkt;
      found.converged = true;
    }
    if (left() < 1) {
      if (!is_settled && found.converged) found.reason = "all evaluations are used before a restart could confirm it";
      found.converged = found.converged && is_settled;
      break;
    }
    // What has come to an optimum at once is confirmed by a restart, which takes steps: to an optimum again, or those
    // that ask for more.
    const bool is_done = is_settled && (round > 0 || !found.converged || !wants_gradients());
    if (is_done && !leave_room(result_.history[best])) break;
    if (round + 1 == most_rounds) {
      found.converged = false;
      found.reason = fmt::format("{} rounds on fresh meshes did not settle", most_rounds);
      break;
    }
  }
  return finish(found, best);
}

// The violation is by the request's own bounds, which those of the last rounds may be tighter than.
OptimizeResult Rounds::finish(const Minimum& found, std::size_t best) {
  Iteration row = result_.history[best];
  row.violation = evaluations_.violation_of_request(done_[evaluation_of_row_[best]]);
  show(result_.history[best], done_[evaluation_of_row_[best]]);  // once more, at the end
  result_.method = request_.method;
  result_.iterations = static_cast<int>(result_.history.size()) - 1;
  result_.state_solves = state_solves_;
  result_.objective = row.objective;
  result_.volume_fraction = row.volume_fraction;
  result_.variables = row.variables;
  DrawnBody body = body_of(request_.design, row.variables, problem_);
  result_.shape = std::move(body.shape);
  result_.scene = std::move(body.scene);
  LoopEnd end{.row = row,
              .residual = found.kkt,
              .asked = request_.tolerance,
              .kind = "KKT residual",
              .why = found.reason,
              .budget_used = found.asked_to_stop || left() < 1,
              .allowed = feasibility,
              .obstacle = found.converged || !std::isfinite(found.kkt) ? "" : found.reason};
  if (!found.asked_to_stop) {
    const bool known = finer_at_.size() > 0 && finer_at_ == row.variables;
    result_.finer = known ? std::move(finer_) : solve_finer_design(row.variables);
  }
  judge(result_, request_, end);
  return std::move(result_);
}

}  // namespace

OptimizeResult optimize_parameters(const Problem& problem, const OptimizeRequest& request, const Observer& see,
                                   const CheckpointPlace& place, const TaskPool& pool) {
  refuse_wrong(problem, request);
  const OptimizeRequest ordered = in_order(request);
  return Rounds(problem, ordered, see, place, pool).run();
}

OptimizeResult optimize_parameters(const Problem& problem, const OptimizeRequest& request, const Observer& see,
                                   const CheckpointPlace& place) {
  return optimize_parameters(problem, request, see, place, {});
}

}  // namespace kerf
