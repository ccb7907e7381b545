#pragma once
// `kerf bench optimize`: kerf's level set beside other programs, every design judged the same way.

#include "bench/judge.hpp"

#include <filesystem>

namespace kerf {

struct OptimizeBenchOptions {
  std::filesystem::path folder;    // made if absent
  std::vector<std::string> cases;  // names; empty: all
  double peer_seconds = 1200;      // for the runs of other programs
  bool quick = false;              // coarse, a few iterations from one start: shows that it works, measures nothing
  std::filesystem::path peers;     // scripts of other programs; empty: none
  std::function<bool()> stop_asked;
  std::function<void(const std::string&)> on_phase;
};

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
  double seconds = 0;             // processor seconds
  double own_compliance = 0;      // as the program sees it itself
  std::string stopped;            // why
  Shape shape;                    // the last one
  Judged last;                    // on a fine mesh
  std::vector<DesignPoint> curve;
  DesignPoint near;               // from which on the compliance stays within 1 % of the last
};

/// Compliance + 100 * area with a weak phase, as published.
struct PublishedRun {
  std::string start;
  int iterations = 0, state_solves = 0;
  double seconds = 0;
  double objective = 0;    // J, with the weak phase
  double compliance = 0, volume = 0;  // of it
  double body_fitted = 0;  // J without a weak phase, judged
  std::string stopped;
};

/// What a new mesh takes of an iteration.
struct Remeshing {
  Index triangles = 0;
  int iterations = 0;
  double iteration_s = 0;  // processor seconds, line search included
  double carve_s = 0, mesh_s = 0;
  double share() const {
    return (carve_s + mesh_s) / iteration_s;
  }
};

/// Seeded designs through carving and meshing.
struct RandomDesigns {
  int count = 0, meshed = 0, refused = 0;  // refused: with a named reason
  std::vector<std::string> failures;       // anything else
  double seconds = 0;                      // processor seconds of all
};

struct OptimizeBench {
  std::vector<DesignRun> runs;
  std::vector<PublishedRun> published;
  std::optional<Remeshing> remeshing;
  std::optional<RandomDesigns> random;
  std::vector<std::string> notes;
  bool stopped = false;
};

/// Runs, writes optimize.csv, optimize_curves.csv, optimize.json and the PNGs, and returns what they hold.
/// Throws Error(Files).
OptimizeBench run_optimize_bench(const OptimizeBenchOptions& options);

/// The tables that a terminal shows.
std::string summary(const OptimizeBench& bench);

/// "kerf, random holes"; the name of another program.
std::string run_name(const DesignRun& run);

/// Names that --case takes.
std::vector<std::string> optimize_case_names();

}  // namespace kerf
