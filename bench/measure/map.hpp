#pragma once
// `kerf bench map`: time and memory of maps of the topological derivative against their error, and of validations.

#include "bench/command/bench.hpp"
#include "bench/measure/map_measure.hpp"

namespace kerf {

/// Quick: two coarse meshes of each sequence, small validations.
struct MapBenchOptions : BenchOptions {
  std::vector<std::string> elements;  // names; empty: bdms
  double seconds = 300;               // for the sequences of kerf; the large meshes and validations come on top
  bool large = false;                 // a million triangles, too: about 10 GB, minutes
};

struct MapBench : Comparison {
  std::vector<MapMeasurement> sequences;  // every degree on finer and finer meshes, until the time is up
  std::vector<MapMeasurement> sizes;      // degree 1 on 10,000, 100,000 and 1,000,000 triangles
  std::vector<ValidationMeasurement> validations;
};

inline constexpr std::array map_errors_to_reach{1e-2, 1e-3, 1e-4};

/// Runs, writes map.csv, validation.csv, map.json and the PNGs, and returns what they hold. Throws Error(Files).
MapBench run_map_bench(const MapBenchOptions& options);

/// The tables that a terminal shows.
std::string summary(const MapBench& bench);

/// The name that --case takes: those of map_problem_kinds, and "validation".
std::vector<std::string> map_case_names();

/// "bdms 3, graded".
std::string sequence_name(const MapMeasurement& m);

}  // namespace kerf
