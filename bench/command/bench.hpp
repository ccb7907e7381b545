#pragma once
// What every bench is asked, and what those with sequences of runs report beside them.

#include "bench/measure/compare.hpp"
#include "bench/measure/peers.hpp"

namespace kerf {

struct BenchOptions {
  std::filesystem::path folder;      // made if absent
  std::vector<std::string> cases;    // names; empty: all
  double peer_seconds = 1200;        // for the runs of other programs
  bool quick = false;                // coarse and short: shows that it works, measures nothing
  std::filesystem::path peers;       // scripts of other programs; empty: none
  std::function<bool()> stop_asked;  // polled before each run, as is stop_requested(): what is done is written
  std::function<void(const std::string&)> on_phase;
};

/// kerf's sequences of runs beside those of other programs.
struct Comparison {
  std::vector<PeerRun> peers;
  std::vector<Fastest> best, best_peers;
  std::vector<std::string> notes;
  bool stopped = false;
};

/// No names are all of them.
bool is_wanted(const std::vector<std::string>& names, std::string_view name);

bool stop_asked(const BenchOptions& options);

/// Throws Error(Files).
void make_folder(const std::filesystem::path& folder);

/// Nothing without scripts, or after a stop was asked for. Throws Error(Files).
void add_peers(const BenchOptions& options, PeerTask task, Comparison& bench);

/// Who is the first to each error.
void compare(const Sequences& own, std::span<const double> errors, Comparison& bench);

}  // namespace kerf
