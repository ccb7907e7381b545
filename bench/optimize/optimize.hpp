#pragma once
// `kerf bench optimize`: kerf's level set beside other programs, every design judged the same way.

#include "bench/command/bench.hpp"
#include "bench/optimize/judge.hpp"
#include "bench/optimize/remesh.hpp"
#include "bench/optimize/spread.hpp"

namespace kerf {

/// A design on its way. The value: what is minimized.
struct DesignPoint {
  int iteration = 0, state_solves = 0;
  double seconds = 0;  // processor seconds so far
  double value = 0, volume = 0;
};

/// What kerf says about its own design.
struct DesignVerdict {
  Ending ending = Ending::Stalled;
  double residual = nan;             // of the shape
  double margin = nan;               // of small holes
  double finer = nan, change = nan;  // J on half the mesh size, and relative to that of the run
  bool feasible = false;
};

struct DesignRun {
  std::string problem, tool, variant;  // variant: of kerf's runs, empty for the case as it is
  bool own = true, strong = false;     // strong: a peer that is no usual one
  int iterations = 0, state_solves = 0;
  double seconds = 0;    // processor seconds
  double own_value = 0;  // as the program sees it itself
  std::string stopped;   // why
  Shape shape;           // the last one
  double value = nan;    // judged: compliance, or volume fraction; of cracked bodies kerf's own on the finer mesh
  Judged last;           // on a fine mesh; empty for cracked bodies
  std::vector<DesignPoint> curve;
  DesignPoint near;  // from which on the value stays within 1 % of the last
  DesignVerdict verdict;
};

/// Compliance + 100 * area, as published.
struct PublishedRun {
  std::string method, start;
  int iterations = 0, state_solves = 0;
  double seconds = 0;                                // processor seconds
  double objective = 0, compliance = 0, volume = 0;  // as the run sees it itself; volume: fraction
  double judged = 0;                                 // J on a fine body-fitted mesh; not a number with a weak phase
  std::string stopped;
};

struct OptimizeBench {
  std::vector<OptimizeProblem> problems;  // of the runs
  std::vector<DesignRun> runs;
  std::vector<Spread> spreads;
  std::vector<PublishedRun> published;
  std::optional<Remeshing> remeshing;
  std::optional<RandomDesigns> random;
  std::vector<std::string> notes;
  bool stopped = false;
};

/// Runs, writes optimize.csv, optimize_curves.csv, optimize_spread.csv, optimize.json and the PNGs, and returns what
/// they hold. Quick: coarse, a few iterations. Throws Error(Files).
OptimizeBench run_optimize_bench(const BenchOptions& options);

/// One of kerf's runs beside the other programs on its problem. Null: there is none.
struct Row {
  const DesignRun* run = nullptr;
  const DesignRun *usual = nullptr, *peer = nullptr, *known = nullptr;  // SIMP n = 50; best usual one; best of all
};
std::vector<Row> rows(const OptimizeBench& bench);

/// The tables that a terminal shows.
std::string summary(const OptimizeBench& bench);

/// "kerf, at most 0.2"; the name of another program.
std::string run_name(const DesignRun& run);

/// Names that --case takes.
std::vector<std::string> optimize_case_names();

}  // namespace kerf
