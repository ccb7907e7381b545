// Smooth minimization in a box under inequality constraints by NLopt (mma [Svanberg 2002], slsqp [Kraft 1994], cobyla
// [Powell 1994], and ccsaq), which is included here alone, with kerf's own judgement of the result. NLopt sees
// variables from 0 to 1 and an objective over its scale. It calls short steps a success, at wrong points too: the
// residual of the conditions of Karush, Kuhn and Tucker [theory: L.8] decides, and where it is large mma goes on from
// there. Failed evaluations are answered from the nearest good one, by its linear model where a known constraint is
// violated, else uphill. Where constraints stay violated, the sum of their squares is minimized once. Every evaluation
// is remembered: asked again, it costs nothing. The residual: min over l, m >= 0 of |(grad f + sum l grad c + sum m n,
// l c, m d)| by nonnegative least squares [Lawson, Hanson 1974], for the signs of the slopes of the multipliers before.
// docs/theory/level_set.md, section "Drawn designs".

#include "optimize/parametric/minimize.hpp"

#include "base/nonnegative.hpp"
#include "kerf/types.hpp"

#include <fmt/core.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

namespace kerf {

double violation_of(const Evaluation& e) {
  return e.values.size() > 1 ? std::max(0.0, e.values.tail(e.values.size() - 1).maxCoeff()) : 0.0;
}

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double short_reach = 0.05;  // of restarts

bool same(const VectorXd& a, const VectorXd& b) {
  return a.size() == b.size() && (a.array() == b.array()).all();
}

nlopt_algorithm algorithm(OptimizeMethod method) {
  switch (method) {
    case OptimizeMethod::Mma:
      return NLOPT_LD_MMA;
    case OptimizeMethod::Ccsaq:
      return NLOPT_LD_CCSAQ;
    case OptimizeMethod::Slsqp:
      return NLOPT_LD_SLSQP;
    case OptimizeMethod::Cobyla:
      return NLOPT_LN_COBYLA;
    case OptimizeMethod::LevelSet:
      break;
  }
  throw Error(Fault::Usage, fmt::format("method \"{}\" moves no variables; use \"mma\", \"ccsaq\", \"slsqp\" or "
                                        "\"cobyla\"",
                                        word(method)));
}

/// Evaluations are counted here and the clock is not looked at: NLopt ends by none of them.
std::string words(nlopt_result code) {
  switch (code) {
    case NLOPT_SUCCESS:
      return "it says that it is done";
    case NLOPT_FTOL_REACHED:
      return "the objective hardly changes any more";
    case NLOPT_XTOL_REACHED:
      return "the variables hardly change any more";
    case NLOPT_ROUNDOFF_LIMITED:
      return "rounding errors leave no progress";
    case NLOPT_INVALID_ARGS:
      return "it does not accept the problem";
    case NLOPT_OUT_OF_MEMORY:
      return "memory ran out";
    default:
      return "it failed without a reason";
  }
}

/// Columns and rows of the variables that are not fixed.
std::vector<Eigen::Index> free_variables(const VectorXd& lower, const VectorXd& upper) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < lower.size(); ++i)
    if (upper[i] > lower[i]) free.push_back(i);
  return free;
}

/// One minimization: everything that was evaluated, and what NLopt's callbacks need.
class Run {
 public:
  Run(const Program& program, const Stop& stop, const VectorXd& start)
      : program_(program), stop_(stop), start_(start), width_(program.upper - program.lower) {
    free_ = free_variables(program.lower, program.upper);
  }

  Minimum minimize(OptimizeMethod method);

 private:
  enum class End { None, Converged, Asked, Evaluations, Thrown };

  VectorXd unscaled(const double* z) const {
    if (std::equal(begun_z_.begin(), begun_z_.end(), z)) return begun_x_;  // there and back may cost the last digit
    VectorXd x = start_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const Eigen::Index i = free_[k];
      x[i] = std::clamp(program_.lower[i] + z[k] * (program_.upper[i] - program_.lower[i]), program_.lower[i],
                        program_.upper[i]);
    }
    return x;
  }
  double distance(const VectorXd& a, const VectorXd& b) const {
    double sum = 0;
    for (const Eigen::Index i : free_) sum += std::pow((a[i] - b[i]) / width_[i], 2);
    return std::sqrt(sum);
  }

  const Evaluation* find(const VectorXd& x, bool gradients) const;
  const Evaluation& evaluate(const VectorXd& x, bool gradients);
  void answer(Evaluation& failed, bool gradients) const;
  void weigh_up(const Evaluation& e);
  bool better(const Evaluation& a, const Evaluation& b) const;
  bool feasible() const;
  bool restore(const std::string& said, Minimum& found);
  bool progress(const Evaluation& before) const;
  void report(Minimum& found);
  nlopt_result run(OptimizeMethod method, const VectorXd& from);
  Evaluation violations(const Evaluation& e) const;

  static double objective(unsigned n, const double* z, double* gradient, void* self);
  static void constraints(unsigned m, double* values, unsigned n, const double* z, double* gradient, void* self);
  const Evaluation* guarded(const double* z);

  const Program& program_;
  const Stop& stop_;
  VectorXd start_, width_;
  std::vector<Eigen::Index> free_;
  std::vector<double> begun_z_;  // where NLopt begins, scaled
  VectorXd begun_x_;
  std::vector<std::unique_ptr<Evaluation>> seen_;  // addresses stay
  const Evaluation* best_ = nullptr;
  double best_kkt_ = nan;
  double first_scale_ = 0, nlopt_scale_ = 1;
  bool is_restart_ = false;
  int evaluations_ = 0;
  End end_ = End::None;
  bool with_gradients_ = true;  // always, or never: a line search asks for values first, and for the rest afterwards
  bool restoring_ = false;      // minimize violations instead of the objective, until there is none
  std::exception_ptr thrown_;
  nlopt_opt opt_ = nullptr;
  std::vector<std::string> failures_;
};

// Latest first. Values without gradients do not answer for those with them.
const Evaluation* Run::find(const VectorXd& x, bool gradients) const {
  for (auto e = seen_.rbegin(); e != seen_.rend(); ++e)
    if (same((*e)->x, x) && (!gradients || (*e)->gradients.cols() > 0)) return e->get();
  return nullptr;
}

/// Lowest of the feasible ones, else the one of least violation.
bool Run::better(const Evaluation& a, const Evaluation& b) const {
  const double va = violation_of(a), vb = violation_of(b);
  const bool fa = va <= stop_.feasibility, fb = vb <= stop_.feasibility;
  if (fa != fb) return fa;
  return fa ? a.values[0] < b.values[0] : va < vb;
}

// Values that are known (constraints on the geometry need no mesh) are kept.
void Run::answer(Evaluation& failed, bool gradients) const {
  const Evaluation* near = nullptr;
  double least = 0;
  const auto look = [&](bool sloped) {
    for (const auto& e : seen_) {
      if (!e->failure.empty() || (sloped && e->gradients.cols() == 0)) continue;
      const double d = distance(e->x, failed.x);
      if (near && d >= least) continue;
      near = e.get();
      least = d;
    }
  };
  // A linear model needs a neighbor with slopes, where one has them.
  look(gradients);
  const bool sloped = gradients && near;  // where derivatives fail all the same, cobyla has evaluated none
  if (!near) look(false);
  const Eigen::Index count = 1 + program_.constraints, n = failed.x.size();
  if (failed.values.size() != count) failed.values = VectorXd::Constant(count, nan);
  if (gradients && failed.gradients.cols() != count) failed.gradients = MatrixXd::Constant(n, count, nan);
  if (!gradients) failed.gradients.resize(n, 0);
  bool violated = false;
  for (Eigen::Index j = 1; j < count; ++j) violated |= failed.values[j] > stop_.feasibility;
  const VectorXd step = failed.x - near->x;
  for (Eigen::Index j = 0; j < count; ++j) {
    const bool known = std::isfinite(failed.values[j]) && (!gradients || failed.gradients.col(j).allFinite());
    if (known) continue;
    failed.values[j] = near->values[j];
    if (sloped) failed.values[j] += near->gradients.col(j).dot(step);
    if (gradients) failed.gradients.col(j) = sloped ? VectorXd(near->gradients.col(j)) : VectorXd::Zero(n);
    if (violated) continue;  // constraints push back
    // Uphill from the neighbor, steeper than any descent there.
    const double slope = 10 * (j == 0 ? scale_of(*near, program_.lower, program_.upper) : 1.0);
    failed.values[j] = std::max(failed.values[j], near->values[j]) + slope * least;
    if (!sloped) continue;
    // The gradient of slope |z - z_near|, z in boxes.
    VectorXd uphill = VectorXd::Zero(n);
    for (const Eigen::Index i : free_)
      if (least > 0) uphill[i] = slope * step[i] / (least * width_[i] * width_[i]);
    failed.gradients.col(j) = near->gradients.col(j) + uphill;
  }
}

// The scale is the largest of here, the start and the run's: a residual must not grow because the objective has fallen.
void Run::weigh_up(const Evaluation& e) {
  double kkt = nan;
  if (e.gradients.cols() > 0) {
    const double scale = std::max({scale_of(e, program_.lower, program_.upper), first_scale_, stop_.scale});
    kkt = kkt_residual(e, program_.lower, program_.upper, scale);
  }
  if (e.failure.empty() && (!best_ || better(e, *best_) || (same(e.x, best_->x) && !std::isnan(kkt)))) {
    best_ = &e;
    best_kkt_ = kkt;
  }
  if (program_.see && !program_.see(e, kkt)) end_ = End::Asked;
  if (e.failure.empty() && kkt <= stop_.kkt && violation_of(e) <= stop_.feasibility) {
    best_ = &e;
    best_kkt_ = kkt;
    if (end_ == End::None) end_ = End::Converged;
  }
}

// Failed ones count as evaluations too; of each failure one note is kept.
const Evaluation& Run::evaluate(const VectorXd& x, bool gradients) {
  if (const Evaluation* e = find(x, gradients)) return *e;
  auto e = std::make_unique<Evaluation>(program_.evaluate(x, gradients));
  e->x = x;
  const bool first = seen_.empty();
  if (e->failure.empty()) {
    if (e->values.size() != 1 + program_.constraints || !e->values.allFinite() || !e->gradients.allFinite())
      throw Error(Fault::Numerics, "the functionals are not finite at a design");
  } else {
    // There is no neighbor yet to answer from.
    if (first) throw Error(Fault::Geometry, "the start of the design cannot be evaluated: " + e->failure);
    if (std::find(failures_.begin(), failures_.end(), e->failure) == failures_.end()) failures_.push_back(e->failure);
    answer(*e, gradients);
  }
  if (first) first_scale_ = scale_of(*e, program_.lower, program_.upper);
  ++evaluations_;
  seen_.push_back(std::move(e));
  weigh_up(*seen_.back());
  return *seen_.back();
}

/// Nothing may be thrown through NLopt: nullptr when it has to stop.
const Evaluation* Run::guarded(const double* z) {
  if (end_ != End::None) return nullptr;
  const VectorXd x = unscaled(z);
  try {
    if (!find(x, with_gradients_) && evaluations_ >= stop_.evaluations)
      end_ = End::Evaluations;
    else {
      const Evaluation& e = evaluate(x, with_gradients_);
      // Violations are minimized until a design has none.
      const bool restored = restoring_ && violation_of(*best_) <= stop_.feasibility;
      if (end_ == End::None && !restored) return &e;
    }
  } catch (...) {
    thrown_ = std::current_exception();
    end_ = End::Thrown;
  }
  nlopt_force_stop(opt_);
  return nullptr;
}

/// Sum of squares of violations, with a margin so that its minima lie inside.
Evaluation Run::violations(const Evaluation& e) const {
  constexpr double margin = 1e-3;
  Evaluation sum{e.x, VectorXd::Zero(1), MatrixXd::Zero(e.x.size(), e.gradients.cols() > 0 ? 1 : 0)};
  for (Eigen::Index j = 1; j < e.values.size(); ++j) {
    const double c = e.values[j] + margin;
    if (c <= 0) continue;
    sum.values[0] += c * c;
    if (e.gradients.cols() > 0) sum.gradients.col(0) += 2 * c * e.gradients.col(j);
  }
  return sum;
}

// In z: derivatives are those by x times the widths of the boxes.
double Run::objective(unsigned n, const double* z, double* gradient, void* self) {
  Run& run = *static_cast<Run*>(self);
  const Evaluation* e = run.guarded(z);
  Evaluation sum;
  if (e && run.restoring_) {
    sum = run.violations(*e);
    e = &sum;
  }
  const double scale = run.restoring_ ? 1 : run.nlopt_scale_;
  if (gradient)
    for (unsigned k = 0; k < n; ++k) {
      const Eigen::Index i = run.free_[k];
      gradient[k] = e ? e->gradients(i, 0) * run.width_[i] / scale : 0;
    }
  return e ? e->values[0] / scale : HUGE_VAL;
}

// Gradients row by row, a constraint each, as NLopt has them.
void Run::constraints(unsigned m, double* values, unsigned n, const double* z, double* gradient, void* self) {
  Run& run = *static_cast<Run*>(self);
  const Evaluation* e = run.guarded(z);
  for (unsigned j = 0; j < m; ++j) {
    values[j] = e ? e->values[1 + j] : 0;
    if (gradient)
      for (unsigned k = 0; k < n; ++k) {
        const Eigen::Index i = run.free_[k];
        gradient[j * n + k] = e ? e->gradients(i, 1 + j) * run.width_[i] : 0;
      }
  }
}

// A new NLopt object each time: its state, asymptotes and moves, begins anew.
nlopt_result Run::run(OptimizeMethod method, const VectorXd& from) {
  const auto n = static_cast<unsigned>(free_.size());
  const auto m = static_cast<unsigned>(restoring_ ? 0 : program_.constraints);
  const bool simplex = method == OptimizeMethod::Cobyla;
  with_gradients_ = !simplex;
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)> opt(
      nlopt_create(algorithm(method), n), nlopt_destroy);
  opt_ = opt.get();
  const std::vector<double> zero(n, 0.0), one(n, 1.0), tolerance(m, stop_.feasibility);
  nlopt_set_min_objective(opt_, objective, this);
  nlopt_set_lower_bounds(opt_, zero.data());
  nlopt_set_upper_bounds(opt_, one.data());
  if (m > 0) nlopt_add_inequality_mconstraint(opt_, m, constraints, this, tolerance.data());
  // NLopt sees the objective over its scale. The first step of slsqp is as long as the slope: a restart begins with
  // short ones, since it is near a minimum, where long ones may end at designs that cannot be evaluated.
  const bool has_slope = best_->gradients.cols() > 0;
  const double slope = has_slope ? best_->gradients.col(0).cwiseProduct(width_).lpNorm<Eigen::Infinity>() : 0,
               scale = stop_.by_slope && slope > 0 ? slope
                       : is_restart_               ? scale_of(*best_, program_.lower, program_.upper)
                                                   : first_scale_;
  const double reach = method == OptimizeMethod::Slsqp ? (is_restart_ ? short_reach : stop_.reach) : 1;
  nlopt_scale_ = scale > 0 ? scale / reach : 1;
  is_restart_ = true;
  // In shares of the boxes; for cobyla at least 1e-4.
  nlopt_set_xtol_abs1(opt_, simplex ? std::max(stop_.step, 1e-4) : stop_.step);
  nlopt_set_ftol_rel(opt_, stop_.value);
  if (simplex) nlopt_set_initial_step1(opt_, stop_.simplex);
  std::vector<double> z(n);
  for (unsigned k = 0; k < n; ++k) {
    const Eigen::Index i = free_[k];
    z[k] = std::clamp((from[i] - program_.lower[i]) / width_[i], 0.0, 1.0);
  }
  begun_z_ = z;
  begun_x_ = from;
  double value = 0;
  const nlopt_result code = nlopt_optimize(opt_, z.data(), &value);
  opt_ = nullptr;
  if (thrown_) std::rethrow_exception(thrown_);
  return code;
}

bool Run::feasible() const {
  return violation_of(*best_) <= stop_.feasibility;
}

/// Minimizes the violations alone, once; `said`: how the minimization ended that left them. Whether to go on.
bool Run::restore(const std::string& said, Minimum& found) {
  const double from = violation_of(*best_);
  restoring_ = true;
  run(program_.gradients ? OptimizeMethod::Mma : OptimizeMethod::Cobyla, best_->x);
  restoring_ = false;
  if (end_ != End::None) return false;
  found.notes.push_back(fmt::format("{}, but constraints were violated by {:.2g} there: minimized violations, {}", said,
                                    from, feasible() ? "to none" : fmt::format("to {:.2g}", violation_of(*best_))));
  if (!feasible()) found.reason = "no design near by violates them less";
  return feasible();
}

/// Whether NLopt has made anything better than `before`.
/// By a thousandth of what the tolerance is of J, or of the violation; or that it is feasible after all.
bool Run::progress(const Evaluation& before) const {
  const double was = violation_of(before), is = violation_of(*best_);
  const double gain = feasible() ? before.values[0] - best_->values[0] : was - is;
  const double worth = feasible() ? 1e-3 * stop_.kkt * scale_of(*best_, program_.lower, program_.upper) : 1e-3 * is;
  return gain > worth || (feasible() && was > stop_.feasibility);
}

// From the best design so far, until converged, by mma after the first end that is none; with six restarts at most.
Minimum Run::minimize(OptimizeMethod method) {
  Minimum found;
  evaluate(start_, method != OptimizeMethod::Cobyla);
  OptimizeMethod now = method;
  constexpr int most_restarts = 6;
  bool restored = false;
  for (int restart = 0; end_ == End::None && !free_.empty(); ++restart) {
    const Evaluation& before = *best_;
    const nlopt_result code = run(now, best_->x);
    if (end_ != End::None) break;
    const std::string said = fmt::format("NLopt's {} ended because {}", word(now), words(code));
    if (code == NLOPT_INVALID_ARGS || code == NLOPT_OUT_OF_MEMORY) {
      found.reason = said;
      break;
    }
    if (!feasible() && !restored) {
      restored = true;
      if (!restore(said, found)) break;
      if (program_.gradients) now = OptimizeMethod::Mma;
      continue;
    }
    if (!program_.gradients) {
      found.reason = feasible() ? "without gradients nothing tells an optimum: " + said : said;
      found.converged = feasible() && code > 0;
      break;
    }
    if (std::isnan(best_kkt_)) {  // cobyla
      evaluate(best_->x, true);
      if (end_ != End::None) break;
    }
    const std::string wrong = feasible()
                                  ? fmt::format("the KKT residual there is {:.2g}", best_kkt_)
                                  : fmt::format("constraints are violated by {:.2g} there", violation_of(*best_));
    if ((now == OptimizeMethod::Mma && !progress(before)) || restart == most_restarts) {
      found.reason = fmt::format("{}, but {}", said, wrong);
      break;
    }
    // Anew, where that has made progress: with another start of its quadratic model a method often goes on.
    if (!progress(before)) now = OptimizeMethod::Mma;
    found.notes.push_back(fmt::format("{}, but {}: went on from there with {}", said, wrong, word(now)));
  }
  report(found);
  return found;
}

/// The best point, and how it ended.
void Run::report(Minimum& found) {
  // Without free variables nothing has converged.
  if (free_.empty() && end_ == End::Converged) end_ = End::None;
  found.best = *best_;
  found.evaluations = evaluations_;
  found.kkt = best_kkt_;
  found.violation = violation_of(*best_);
  found.feasible = feasible();
  found.failure = failures_;
  switch (end_) {
    case End::Converged:
      found.converged = true;
      found.reason = "converged";
      break;
    case End::Asked:
      found.asked_to_stop = true;
      found.reason = "told to stop";
      break;
    case End::Evaluations:
      found.reason = "all evaluations are used";
      break;
    default:
      if (free_.empty()) {
        found.reason = "no variable is free";
        found.converged = found.feasible;
      }
  }
  if (!found.feasible)
    found.reason = fmt::format("constraints are violated by {:.2g}: {}", found.violation, found.reason);
}

}  // namespace

Minimum minimize(const Program& program, const Eigen::VectorXd& start, OptimizeMethod method, const Stop& stop) {
  algorithm(method);
  if (!program.gradients && method != OptimizeMethod::Cobyla)
    throw Error(Fault::Usage, fmt::format("method \"{}\" needs gradients, which there are none of here; use \"cobyla\"",
                                          word(method)));
  if (program.lower.size() != program.upper.size() || program.lower.size() != start.size() ||
      !program.lower.allFinite() || !program.upper.allFinite() || (program.lower.array() > program.upper.array()).any())
    throw Error(Fault::Usage, "every variable needs a finite lower and upper bound, the lower one first");
  for (Eigen::Index i = 0; i < start.size(); ++i)
    if (!(start[i] >= program.lower[i] && start[i] <= program.upper[i]))
      throw Error(Fault::Usage, fmt::format("the start of variable {} is {:g}; it has to lie between {:g} and {:g}",
                                            i + 1, start[i], program.lower[i], program.upper[i]));
  return Run(program, stop, start).minimize(method);
}

double scale_of(const Evaluation& e, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  double scale = std::abs(e.values[0]);
  if (e.gradients.cols() > 0)
    scale = std::max(scale, e.gradients.col(0).cwiseProduct(upper - lower).lpNorm<Eigen::Infinity>());
  return scale;
}

double kkt_residual(const Evaluation& e, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double scale) {
  const std::vector<Eigen::Index> free = free_variables(lower, upper);
  const auto n = static_cast<Eigen::Index>(free.size());
  if (n == 0) return 0;
  constexpr double slack = -0.5;  // constraints farther from their bound carry no multiplier
  std::vector<Eigen::Index> near;
  for (Eigen::Index j = 1; j < e.values.size(); ++j)
    if (e.values[j] > slack) near.push_back(j);
  const auto m = static_cast<Eigen::Index>(near.size());
  MatrixXd A(n, m);
  VectorXd g(n), above(n), below(n), complement(m);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index i = free[static_cast<std::size_t>(k)];
    const double width = upper[i] - lower[i], z = std::clamp((e.x[i] - lower[i]) / width, 0.0, 1.0);
    // In variables from 0 to 1: slopes times widths.
    g[k] = e.gradients(i, 0) * width;
    for (Eigen::Index j = 0; j < m; ++j) A(k, j) = e.gradients(i, near[static_cast<std::size_t>(j)]) * width;
    // The best multiplier of a bound leaves of the slope r: |(r - m, m d)| = |r| d/sqrt(1 + d^2).
    above[k] = z / std::hypot(1, z);
    below[k] = (1 - z) / std::hypot(1, 1 - z);
  }
  // A multiplier is weighed by how far its constraint is from its bound.
  for (Eigen::Index j = 0; j < m; ++j) complement[j] = std::max(0.0, -e.values[near[static_cast<std::size_t>(j)]]);
  // For given signs of the slopes a problem of nonnegative least squares. Any multipliers bound the residual.
  VectorXd multipliers = VectorXd::Zero(m), best = multipliers;
  double least = infinity;
  const auto left = [&](const VectorXd& l) {
    const VectorXd r = g + A * l;
    VectorXd all(n + m);
    all << (r.array() > 0).select(r.array() * above.array(), -r.array() * below.array()).matrix(),
        l.cwiseProduct(complement);
    return all;
  };
  constexpr int most = 20;
  // Signs change with the multipliers: a step that does not lower the residual is halved, then ends.
  for (int iteration = 0; iteration < most; ++iteration) {
    const VectorXd r = g + A * multipliers, weight = (r.array() > 0).select(above, below);
    const double size = left(multipliers).norm();
    if (size < least) {
      least = size;
      best = multipliers;
    }
    if (m == 0) break;
    MatrixXd rows(n + m, m);
    // Both are to vanish: weighted slopes, and multipliers times what their constraints leave free.
    rows << weight.asDiagonal() * A, MatrixXd(complement.asDiagonal());
    VectorXd right = VectorXd::Zero(n + m);
    right.head(n) = -weight.cwiseProduct(g);
    VectorXd next = nonnegative_least_squares(rows, right);
    if (left(next).norm() >= size * (1 - 1e-12)) next = 0.5 * (next + multipliers);
    if (left(next).norm() >= size * (1 - 1e-12)) break;
    multipliers = std::move(next);
  }
  // Multipliers are the best in the mean of squares; what is told is the largest entry.
  const double residual = left(best).lpNorm<Eigen::Infinity>();
  return scale > 0 ? residual / scale : residual;
}

}  // namespace kerf
