#pragma once
// `kerf bench defaults`: what a user gets who says nothing of meshes and elements, beside degrees 1 and 3.

#include "bench/command/bench.hpp"
#include "kerf/types.hpp"

#include <array>

namespace kerf {

/// A number of a benchmark of the validation manual by one way of solving.
struct DefaultsRow {
  std::string id, quantity;
  double reference = nan;           // of the manual's own run: its meshes and elements
  std::array<double, 4> error{};    // relative to it: of each way of defaults_ways
  std::array<double, 4> seconds{};  // pictures and page included
  std::string trouble;              // of the first way that failed
};

/// Degree 1 with chords, degrees 1, 2 (the default) and 3 with edges that follow curves.
inline constexpr std::array<const char*, 4> defaults_ways{"1, chords", "1", "2", "3"};

struct DefaultsBench {
  std::vector<DefaultsRow> rows;
  bool quick = false, stopped = false;
};

/// Every benchmark of the manual, its tables [mesh] and [solver] left out. Writes defaults.csv, defaults.json. Quick:
/// the quick half of the manual. Throws Error(Files).
DefaultsBench run_defaults_bench(const BenchOptions& options);

std::string summary(const DefaultsBench& bench);

/// Names that --case takes.
std::vector<std::string> defaults_case_names();

}  // namespace kerf
