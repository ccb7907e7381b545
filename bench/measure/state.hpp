#pragma once
// `kerf bench state`: every element on every problem, time and memory against error, with files and pictures.

#include "bench/command/bench.hpp"
#include "bench/measure/measure.hpp"

namespace kerf {

/// Quick: two coarse meshes of each sequence, one Poisson's ratio per case.
struct StateBenchOptions : BenchOptions {
  std::vector<std::string> elements;  // names; empty: all
  double seconds = 300;               // for kerf's runs
};

/// The truth of a problem without a closed form, as good as it is.
struct ReferenceUsed {
  std::string problem;
  double poisson = 0;
  std::size_t points = 0;
  double strain_energy = 0, known_energy = 0;  // known: 0 where it is not
  double error = 0;                            // estimated, of the stress
};

struct StateBench : Comparison {
  std::vector<StateMeasurement> runs;
  std::vector<ReferenceUsed> references;
};

inline constexpr std::array errors_to_reach{1e-2, 1e-3, 1e-4};

/// Runs, writes state.csv, state.json and the PNGs, and returns what they hold. Throws Error(Files).
StateBench run_state_bench(const StateBenchOptions& options);

/// The tables that a terminal shows.
std::string summary(const StateBench& bench);

/// "bdms 3, graded".
std::string sequence_name(const StateMeasurement& m);

/// Problem and Poisson's ratio, as in file names and tables: "smooth", 0.3 -> "smooth_nu0.3".
std::string problem_tag(const std::string& problem, double poisson);

/// Names that --case and --element take.
std::vector<std::string> bench_case_names();
std::vector<std::string> bench_element_names();

}  // namespace kerf
