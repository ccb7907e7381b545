#pragma once
// `kerf bench map`: time and memory of maps of the topological derivative against their error, and of validations.

#include "bench/compare.hpp"
#include "bench/map_measure.hpp"
#include "bench/peers.hpp"

#include <filesystem>

namespace kerf {

struct MapBenchOptions {
  std::filesystem::path folder;              // made if absent
  std::vector<std::string> cases, elements;  // names; no cases: all, no elements: bdms
  double seconds = 300;                      // for the sequences of kerf; the large meshes and validations come on top
  double peer_seconds = 1200;                // for the runs of other programs
  bool quick = false;                        // two coarse meshes of each sequence, small validations
  bool large = false;                        // a million triangles, too: about 10 GB, minutes
  std::filesystem::path peers;               // scripts of other programs; empty: none
  std::function<bool()> stop_asked;          // polled before each run: what is done is written
  std::function<void(const std::string&)> on_phase;
};

struct MapBench {
  std::vector<MapMeasurement> sequences;  // every degree on finer and finer meshes, until the time is up
  std::vector<MapMeasurement> sizes;      // degree 1 on 10,000, 100,000 and 1,000,000 triangles
  std::vector<ValidationMeasurement> validations;
  std::vector<PeerRun> peers;
  std::vector<Fastest> best, best_peers;
  std::vector<std::string> notes;
  bool stopped = false;
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
