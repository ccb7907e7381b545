// Several designs to begin with, compared on a mesh 1.5 times as coarse: each is minimized from for 12 evaluations, the
// best third of them (two to four) for 40 more, and the best of these is gone on from. One design is better than
// another if it violates less, beyond 1e-3, then by its merit; failed ones come last. Looks are independent of each
// other: threads take them, or processes of a pool, each as a packed task, and they are sorted stably, so that the
// result does not depend on who did them. The least distance between things does not grow with the coarse mesh.

#include "optimize/parametric/starts.hpp"

#include "base/packer.hpp"
#include "base/parallel.hpp"
#include "optimize/load_cases.hpp"
#include "optimize/parametric/evaluations.hpp"
#include "optimize/parametric/shapes/shape.hpp"
#include "optimize/parametric/start.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

using Eigen::VectorXd;

constexpr double coarser = 1.5;                          // meshes, where designs are compared
constexpr int first_evaluations = 12, second_look = 40;  // evaluations
constexpr double bearable_violation = 1e-3;  // violations up to here do not make one design worse than another

/// The given design first.
/// A place that leads to a design that is there already is left out; 20 tries per start end the search.
std::vector<VectorXd> places(const Problem& p, const OptimizeRequest& r, const VectorXd& given) {
  const VectorXd lower = lower_bounds(r.design), upper = upper_bounds(r.design);
  const VectorXd width = (upper - lower).unaryExpr([](double w) { return w > 0 ? w : 1.0; });
  constexpr double same = 1e-3;  // of the boxes
  std::vector<VectorXd> all{given};
  for (int k = 1; static_cast<int>(all.size()) < r.starts && k < 20 * r.starts; ++k) {
    const std::optional<VectorXd> x = repaired(place_in(lower, upper, k), p, r);
    if (x && std::ranges::none_of(all, [&](const VectorXd& other) {
          return (*x - other).cwiseQuotient(width).cwiseAbs().maxCoeff() < same;
        }))
      all.push_back(*x);
  }
  return all;
}

/// Minimizes from tried.from for so many evaluations.
void follow(const Problem& p, const OptimizeRequest& r, int evaluations, StartTried& tried) {
  Evaluations all(p, r);
  all.begin_round();
  const bool gradients = r.method != OptimizeMethod::Cobyla;
  const VectorXd from = tried.variables.size() > 0 ? tried.variables : tried.from;
  // Tells whether the start can be evaluated at all, and is the first answer to the minimizer.
  std::optional<DesignEvaluation> begun = all.evaluate(from, gradients);
  tried.state_solves += begun->state_solves;
  if (!begun->evaluation.failure.empty()) {
    tried.failure = begun->evaluation.failure;
    return;
  }
  Program program{.lower = lower_bounds(r.design), .upper = upper_bounds(r.design), .constraints = all.constraints()};
  program.gradients = !all.blind();
  program.evaluate = [&](const VectorXd& x, bool with) {
    if (begun) return std::exchange(begun, std::nullopt)->evaluation;
    const DesignEvaluation e = all.evaluate(x, with);
    tried.state_solves += e.state_solves;
    return e.evaluation;
  };
  const Minimum found = minimize(program, from, r.method, {.evaluations = evaluations, .kkt = r.tolerance});
  tried.variables = found.best.x;
  tried.merit = found.best.values[0];
  tried.violation = found.violation;
}

/// What starts are compared on: a coarser mesh, one thread each.
std::pair<Problem, OptimizeRequest> compared(const Problem& problem, const OptimizeRequest& request) {
  std::pair<Problem, OptimizeRequest> c{problem, in_order(request)};
  c.second.min_distance = least_distance(problem, request);  // which does not grow with the mesh size
  c.first.sizing.size = coarser * mesh_size(problem);
  c.first.sizing.crack_tip_size *= coarser;
  c.first.threads = 1;
  return c;
}

// Tasks and answers of a pool.

// What try_start reads, in its order. A pool has problem and request.
std::string task_of(const Design& design, int evaluations, const StartTried& tried) {
  Packer to;
  to(start_of(design), evaluations, tried.from, tried.variables, tried.merit, tried.violation);
  return std::move(to).take();
}

/// The design with another start.
Design started_at(Design design, const VectorXd& start) {
  Eigen::Index at = 0;
  for (Drawn& one : design.drawn) {
    one.start = start.segment(at, one.lower.size());
    one.from_map = false;
    at += one.lower.size();
  }
  return design;
}

std::string answer_of(const StartTried& tried) {
  Packer to;
  to(tried.variables, tried.merit, tried.violation, tried.state_solves, tried.failure);
  return std::move(to).take();
}

void take_answer(std::string_view answer, StartTried& tried) {
  Unpacker from(answer);
  int solves = 0;
  from(tried.variables, tried.merit, tried.violation, solves, tried.failure);
  tried.state_solves += solves;
}

// NaN: it could not be evaluated.
bool better(const StartTried& a, const StartTried& b) {
  if (std::isnan(a.merit) || std::isnan(b.merit)) return !std::isnan(a.merit) && std::isnan(b.merit);
  const double more_a = std::max(0.0, a.violation - bearable_violation),
               more_b = std::max(0.0, b.violation - bearable_violation);
  return more_a != more_b ? more_a < more_b : a.merit < b.merit;
}

}  // namespace

// The task says only where to begin and what was reached; problem and request are the caller's.
std::string try_start(const Problem& problem, const OptimizeRequest& request, std::string_view task) {
  Unpacker from(task);
  auto [p, r] = compared(problem, request);
  const auto start = from.get<VectorXd>();
  r.design = started_at(std::move(r.design), start);
  const int evaluations = from.get<int>();
  StartTried tried;
  from(tried.from, tried.variables, tried.merit, tried.violation);
  follow(p, r, evaluations, tried);
  return answer_of(tried);
}

std::vector<StartTried> try_starts(const Problem& problem, const OptimizeRequest& request, const VectorXd& given,
                                   const TaskPool& pool) {
  const auto [p, r] = compared(problem, request);
  std::vector<StartTried> all;
  for (const VectorXd& x : places(p, r, given)) all.push_back({.from = x});
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto follow_all = [&, &p = p, &r = r](int evaluations) {
    if (!pool) {
      parallel_tasks(static_cast<Index>(order.size()), problem.threads,
                     [&](Index i) { follow(p, r, evaluations, all[order[static_cast<std::size_t>(i)]]); });
      return;
    }
    std::vector<std::string> tasks;
    for (const std::size_t i : order) tasks.push_back(task_of(request.design, evaluations, all[i]));
    const std::vector<std::string> answers = pool(tasks);
    for (std::size_t k = 0; k < order.size(); ++k) take_answer(answers.at(k), all[order[k]]);
  };
  const auto look = [&](int evaluations) {
    follow_all(evaluations);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return better(all[a], all[b]); });
  };
  look(std::min(first_evaluations, r.max_iterations));
  if (std::isnan(all[order[0]].merit))
    throw Error(Fault::Geometry, fmt::format("no start of the design can be evaluated: {}", all[0].failure));
  order.resize(std::clamp<std::size_t>((order.size() + 2) / 3, std::min<std::size_t>(2, order.size()), 4));
  look(std::min(second_look, r.max_iterations));
  all[order[0]].in_full = true;
  return all;
}

}  // namespace kerf
