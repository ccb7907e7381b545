#pragma once
// Other programs on the same designs: SIMP in numpy by a script of our own, a level set in FreeFem++ by its script.

#include "bench/optimize/judge.hpp"

#include <filesystem>

namespace kerf {

/// A design on the way: `objective` as the program sees it itself.
struct PeerSnapshot {
  int iteration = 0, state_solves = 0;
  double objective = 0, seconds = 0;  // processor seconds so far
  GridField field;
};

struct DesignPeer {
  std::string problem, name;  // name: program, method, cells per length
  bool strong = false;        // best known rather than usual
  double volume = 0;          // fraction that it was asked for
  std::vector<PeerSnapshot> snapshots;
  double memory_mb = 0;
};

struct DesignPeerOptions {
  std::filesystem::path scripts, work;  // scripts: may be empty; work: a folder of their own, made if absent
  double seconds = 1200;                // no run begins later
  bool quick = false;
  bool finest = true;  // the strong one, too
  std::function<bool()> stop_asked;
  std::function<void(const std::string&)> on_phase;
};

struct DesignPeers {
  std::vector<DesignPeer> runs;
  std::vector<std::string> notes;  // what is not installed, failed or was left out
};

inline constexpr int usual_cells = 50;  // per length, of the SIMP whose time is compared
std::string simp_name(int cells, bool strong = false);

/// Throws Error(Files) when the folder does not hold tdopt.edp.
void require_design_scripts(const std::filesystem::path& folder);

/// Whichever are installed, on one thread, on the problems that have a density. A run that fails or takes too long
/// becomes a note. Throws Error(Files).
DesignPeers run_design_peers(const std::vector<OptimizeProblem>& problems, const DesignPeerOptions& options);

/// SIMP at another volume fraction than the one wanted. Throws Error(Files).
DesignPeers run_simp(const OptimizeProblem& p, double volume, int cells, const DesignPeerOptions& options);

/// Snapshots one after the other: iteration, objective, seconds, states, columns and rows, then the values. What is
/// broken off is left out.
std::vector<PeerSnapshot> read_snapshots(const std::string& text);

/// tdopt.edp with lines that write its design down in every iteration; nothing when the script has changed.
std::optional<std::string> traced_tdopt(std::string script);

}  // namespace kerf
