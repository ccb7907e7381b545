#pragma once
// `kerf bench optimize`: kerf's level set beside other programs, every design judged the same way.

#include "bench/bench.hpp"
#include "bench/judge.hpp"
#include "bench/remesh.hpp"

namespace kerf {

/// A design on its way, judged on a mesh of medium size.
struct DesignPoint {
  int iteration = 0, state_solves = 0;
  double seconds = 0;  // processor seconds so far
  double compliance = 0, volume = 0;
};

struct DesignRun {
  std::string problem, tool, start;  // start: of kerf's runs
  bool own = true;
  int iterations = 0, state_solves = 0;
  double seconds = 0;         // processor seconds
  double own_compliance = 0;  // as the program sees it itself
  std::string stopped;        // why
  Shape shape;                // the last one
  Judged last;                // on a fine mesh
  std::vector<DesignPoint> curve;
  DesignPoint near;  // from which on the compliance stays within 1 % of the last
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
  std::vector<DesignRun> runs;
  std::vector<PublishedRun> published;
  std::optional<Remeshing> remeshing;
  std::optional<RandomDesigns> random;
  std::vector<std::string> notes;
  bool stopped = false;
};

/// Runs, writes optimize.csv, optimize_curves.csv, optimize.json and the PNGs, and returns what they hold. Quick:
/// coarse, a few iterations from one start. Throws Error(Files).
OptimizeBench run_optimize_bench(const BenchOptions& options);

/// The tables that a terminal shows.
std::string summary(const OptimizeBench& bench);

/// "kerf, random holes"; the name of another program.
std::string run_name(const DesignRun& run);

/// Names that --case takes.
std::vector<std::string> optimize_case_names();

}  // namespace kerf
