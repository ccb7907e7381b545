// The spread of designs over starts, mesh sizes and budgets, and under loads times 1 + 1e-12, which only rounding can
// tell apart.

#include "bench/optimize/spread.hpp"

#include "bench/measure/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double nudge = 1 + 1e-12;

Scene scaled_loads(Scene scene, double factor) {
  for (Traction& t : scene.tractions)
    t.value = [value = t.value, factor](const Vec2& x, const Vec2& n) -> Vec2 { return factor * value(x, n); };
  if (scene.body) scene.body = [body = scene.body, factor](const Vec2& x) -> Vec2 { return factor * body(x); };
  return scene;
}

OptimizeProblem with_loads(OptimizeProblem p, double factor) {
  if (factor == 1) return p;
  p.problem.scene = scaled_loads(std::move(p.problem.scene), factor);
  for (LoadCase& load : p.request.load_cases) {
    const Scene scaled = scaled_loads({.body = load.body, .tractions = load.tractions}, factor);
    load.tractions = scaled.tractions;
    load.body = scaled.body;
  }
  return p;
}

/// The case as it is first, then everything else, then the nudged loads.
std::vector<SpreadRun> planned(const OptimizeProblem& p, bool quick) {
  const int usual = p.request.max_iterations;
  if (quick) return {{.start = "full", .size = 2, .budget = 30}, {.start = "holes", .size = 2, .budget = 30}};
  std::vector<SpreadRun> all;
  for (const std::string& start : optimize_starts())
    for (const double size : {1.0, 1.5, 2.0})
      for (const int budget : {60, 100, 200}) all.push_back({.start = start, .size = size, .budget = budget});
  std::ranges::stable_partition(
      all, [&](const SpreadRun& r) { return r.start == "full" && r.size == 1 && r.budget == usual; });
  all.push_back({.start = "full", .size = 1, .budget = usual, .loads = nudge});
  return all;
}

}  // namespace

Spread measure_spread(const OptimizeProblem& p, bool quick, const SpreadJudge& judged,
                      const std::function<bool(const std::string& phase)>& go_on) {
  Spread out{.problem = p.name, .runs = {}, .failures = {}};
  for (SpreadRun run : planned(p, quick)) {
    const std::string name = fmt::format("spread of {}: {}, {} h, {} iterations{}", p.name, run.start, run.size,
                                         run.budget, run.loads == 1 ? "" : ", loads times 1 + 1e-12");
    if (!go_on(name)) break;
    OptimizeProblem varied = with_loads(p, run.loads);
    varied.problem.sizing.size *= run.size;
    varied.request = request_from(varied, run.start);
    varied.request.max_iterations = run.budget;
    ProcessorWatch watch;
    try {
      const OptimizeResult result =
          optimize_level_set(varied.problem, varied.request, [](const Iterate&) { return true; }, {});
      run.seconds = watch.lap();
      run.state_solves = result.state_solves;
      run.ending = result.ending;
      run.feasible = result.feasible;
      std::tie(run.value, run.volume) = judged(p, result);
    } catch (const Error& e) {
      out.failures.push_back(fmt::format("{}: {}", name, e.what()));
    }
    out.runs.push_back(std::move(run));
  }
  return out;
}

SpreadSummary summarize(const Spread& spread) {
  SpreadSummary out;
  for (const SpreadRun& r : spread.runs) {
    if (r.loads != 1) continue;
    ++out.count;
    if (!r.feasible) {
      ++out.infeasible;
      continue;
    }
    out.least = std::fmin(out.least, r.value);
    out.most = std::fmax(out.most, r.value);
  }
  if (spread.runs.empty()) return out;
  out.usual = spread.runs.front().value;
  if (spread.runs.back().loads != 1) out.rounding = std::abs(spread.runs.back().value / out.usual - 1);
  return out;
}

}  // namespace kerf
