#pragma once
// Other programs on the same designs, through their scripts: SIMP in numpy, a level set in FreeFem++.

#include "bench/judge.hpp"

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
  std::vector<PeerSnapshot> snapshots;
  double memory_mb = 0;
};

struct DesignPeerOptions {
  std::filesystem::path scripts, work;  // work: a folder of their own, made if absent
  double seconds = 1200;                // no run begins later
  bool quick = false;
  std::vector<std::string> problems;  // empty: all
  std::function<bool()> stop_asked;
  std::function<void(const std::string&)> on_phase;
};

struct DesignPeers {
  std::vector<DesignPeer> runs;
  std::vector<std::string> notes;  // what is not installed, failed or was left out
};

/// Throws Error(Files) when the folder holds neither simp.py nor tdopt.edp.
void require_design_scripts(const std::filesystem::path& folder);

/// Whichever are installed, on one thread. A run that fails or takes too long becomes a note. Throws Error(Files).
DesignPeers run_design_peers(const DesignPeerOptions& options);

/// Snapshots one after the other: iteration, objective, seconds, states, columns and rows, then the values. What is
/// broken off is left out.
std::vector<PeerSnapshot> read_snapshots(const std::string& text);

/// tdopt.edp with lines that write its design down in every iteration; nothing when the script has changed.
std::optional<std::string> traced_tdopt(std::string script);

}  // namespace kerf
