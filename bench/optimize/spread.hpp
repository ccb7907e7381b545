#pragma once
// What the start, the mesh and the budget do to a design.

#include "bench/optimize/optimize_problems.hpp"

namespace kerf {

struct SpreadRun {
  std::string start;
  double size = 0;     // of the mesh, relative to that of the case
  int budget = 0;      // iterations
  double loads = 1;    // factor
  double seconds = 0;  // processor seconds
  int state_solves = 0;
  double value = nan, volume = nan;  // judged, on one mesh size for all
  Ending ending = Ending::Stalled;
  bool feasible = false;
};

struct Spread {
  std::string problem;
  std::vector<SpreadRun> runs;  // the first one: the case as it is; of a failure the value is not a number
  std::vector<std::string> failures;
};

/// Every start of optimize_starts, mesh sizes h, 1.5 h, 2 h, budgets of 60, 100 and 200 iterations, and the case with
/// its loads times 1 + 1e-12; one thread. `judged`: of a design, its value. Quick: two starts on the coarsest mesh.
using SpreadJudge = std::function<std::pair<double, double>(const OptimizeProblem&, const OptimizeResult&)>;
Spread measure_spread(const OptimizeProblem& p, bool quick, const SpreadJudge& judged,
                      const std::function<bool(const std::string& phase)>& go_on);

/// Least and most: of the designs that hold their bounds.
struct SpreadSummary {
  double least = nan, most = nan, usual = nan;  // usual: of the case as it is
  double rounding = nan;                        // relative change by the loads times 1 + 1e-12
  int count = 0, infeasible = 0;
};
SpreadSummary summarize(const Spread& spread);

}  // namespace kerf
