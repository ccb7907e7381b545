// Several designs to begin with, compared on a mesh 1.5 times as coarse. Four times as many places as are wanted fill
// the boxes evenly, and those of which the map of the objective promises most are begun from [theory: L.20]. Each is
// minimized from for 40 evaluations, with short first steps, since long ones end at designs that cannot be evaluated;
// the best third of them (two to four) for 40 more, and the best of these is gone on from. What the others came to is
// told as distinct ends: designs that agree up to the order of things of a kind. One design is better than another if
// it violates less, beyond 1e-3, then by its merit; failed ones come last. Looks are independent of each other: threads
// take them, or processes of a pool, each as a packed task, and they are sorted stably, so that the result does not
// depend on who did them. The least distance between things does not grow with the coarse mesh.

#include "optimize/parametric/starts.hpp"

#include "base/packer.hpp"
#include "base/parallel.hpp"
#include "optimize/load_cases.hpp"
#include "optimize/parametric/evaluations.hpp"
#include "optimize/parametric/promise.hpp"
#include "optimize/parametric/shapes/shape.hpp"
#include "optimize/parametric/start.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace kerf {

namespace {

using Eigen::VectorXd;

constexpr double coarser = 1.5;                          // meshes, where designs are compared
constexpr int first_evaluations = 40, second_look = 40;  // evaluations
constexpr int candidates_per_start = 4;                  // places that the map chooses from
constexpr double short_steps = 0.05;                     // slsqp's first steps, of the boxes
constexpr double same_end = 0.02;                        // of the boxes
constexpr double bearable_violation = 1e-3;  // violations up to here do not make one design worse than another

/// The given design first. Of the places that fill the boxes those that the map promises most of, in their order.
/// A place that leads to a design that is there already is left out; 20 tries per start end the search.
std::vector<VectorXd> places(const Problem& p, const OptimizeRequest& r, const VectorXd& given) {
  const VectorXd lower = lower_bounds(r.design), upper = upper_bounds(r.design);
  const VectorXd width = (upper - lower).unaryExpr([](double w) { return w > 0 ? w : 1.0; });
  constexpr double same = 1e-3;  // of the boxes
  std::vector<VectorXd> all{given};
  const int wanted = 1 + candidates_per_start * (r.starts - 1);
  for (int k = 1; static_cast<int>(all.size()) < wanted && k < 20 * r.starts; ++k) {
    const std::optional<VectorXd> x = repaired(place_in(lower, upper, k), p, r);
    if (x && std::ranges::none_of(all, [&](const VectorXd& other) {
          return (*x - other).cwiseQuotient(width).cwiseAbs().maxCoeff() < same;
        }))
      all.push_back(*x);
  }
  const std::size_t starts = std::min(all.size(), static_cast<std::size_t>(r.starts));
  if (starts < all.size())
    if (const std::vector<double> promise = promises(p, r, all); !promise.empty()) {
      std::vector<std::size_t> order(all.size() - 1);
      std::iota(order.begin(), order.end(), std::size_t{1});
      std::ranges::stable_sort(order, {}, [&](std::size_t k) { return promise[k]; });
      order.resize(starts - 1);
      std::ranges::sort(order);
      std::vector<VectorXd> chosen{given};
      for (const std::size_t k : order) chosen.push_back(all[k]);
      return chosen;
    }
  all.resize(starts);
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
  const Minimum found =
      minimize(program, from, r.method, {.evaluations = evaluations, .kkt = r.tolerance, .reach = short_steps});
  tried.variables = found.best.x;
  tried.end = found.converged ? 1 : 0;
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
  to(tried.variables, tried.merit, tried.violation, tried.state_solves, tried.failure, tried.end);
  return std::move(to).take();
}

void take_answer(std::string_view answer, StartTried& tried) {
  Unpacker from(answer);
  int solves = 0;
  from(tried.variables, tried.merit, tried.violation, solves, tried.failure, tried.end);
  tried.state_solves += solves;
}

// NaN: it could not be evaluated.
bool better(const StartTried& a, const StartTried& b) {
  if (std::isnan(a.merit) || std::isnan(b.merit)) return !std::isnan(a.merit) && std::isnan(b.merit);
  const double more_a = std::max(0.0, a.violation - bearable_violation),
               more_b = std::max(0.0, b.violation - bearable_violation);
  return more_a != more_b ? more_a < more_b : a.merit < b.merit;
}

/// The variables in boxes, things of the same kind and boxes in the order of these: the order of holes means nothing.
VectorXd in_any_order(const Design& design, const VectorXd& x) {
  VectorXd z(x.size());
  std::vector<std::vector<double>> parts;
  Eigen::Index at = 0;
  for (const Drawn& d : design.drawn) {
    const VectorXd width = d.upper - d.lower;
    std::vector<double> part;
    for (Eigen::Index i = 0; i < width.size(); ++i)
      part.push_back(width[i] > 0 ? (x[at + i] - d.lower[i]) / width[i] : 0);
    parts.push_back(std::move(part));
    at += d.lower.size();
  }
  const auto alike = [](const Drawn& a, const Drawn& b) {
    return a.kind == b.kind && a.lower.size() == b.lower.size() && a.lower == b.lower && a.upper == b.upper;
  };
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = i + 1; k < parts.size(); ++k)
      if (alike(design.drawn[i], design.drawn[k]) && parts[k] < parts[i]) std::swap(parts[i], parts[k]);
  at = 0;
  for (const std::vector<double>& part : parts)
    for (const double v : part) z[at++] = v;
  return z;
}

/// Numbers the ends of those that have come to one, the best one first.
void number_ends(const Design& design, std::vector<StartTried>& all) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (std::exchange(all[i].end, 0) > 0) order.push_back(i);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return better(all[a], all[b]); });
  std::vector<VectorXd> ends;
  for (const std::size_t i : order) {
    const VectorXd z = in_any_order(design, all[i].variables);
    const auto known = std::ranges::find_if(
        ends, [&](const VectorXd& other) { return (z - other).lpNorm<Eigen::Infinity>() < same_end; });
    all[i].end = 1 + static_cast<int>(known - ends.begin());
    if (known == ends.end()) ends.push_back(z);
  }
}

}  // namespace

std::vector<std::string> ends_in_words(const std::vector<StartTried>& all) {
  struct End {
    double merit;
    int starts;
  };
  std::map<int, End> ends;
  int moving = 0;
  for (const StartTried& t : all) {
    if (t.end == 0) {
      ++moving;
      continue;
    }
    End& end = ends.try_emplace(t.end, End{t.merit, 0}).first->second;
    end.merit = std::min(end.merit, t.merit);
    ++end.starts;
  }
  std::string words;
  for (const auto& [number, end] : ends)
    words += fmt::format("{}{:.6g} from {}", words.empty() ? "" : ", ", end.merit, end.starts);
  std::vector<std::string> lines;
  if (!ends.empty())
    lines.push_back(fmt::format("{} distinct end{} of {} starts, on the coarse mesh: {}; {} had not come to one",
                                ends.size(), ends.size() == 1 ? "" : "s", all.size(), words, moving));
  return lines;
}

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
  number_ends(request.design, all);
  return all;
}

}  // namespace kerf
