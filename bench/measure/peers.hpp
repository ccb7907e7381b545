#pragma once
// Other programs on the same problems, through scripts that print one JSON line per run.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace kerf {

struct PeerRun {
  std::string problem;  // as in problem_kinds; "cantilever" of the maps
  double poisson = 0;
  std::string name;  // program, element, linear solver, mesh: runs of one name form a sequence
  long triangles = 0, unknowns = 0;
  double work = 0;   // processor seconds for mesh, assembly, solution and stress or map
  double post = 0;   // of these, for the stress or the map
  double error = 0;  // relative: of the stress in L2, of the map in L1; 0: unknown
  double value = 0;  // J, where the script prints it
  double memory_mb = 0;
};

enum class PeerTask { State, Map };

struct PeerOptions {
  PeerTask task = PeerTask::State;
  std::filesystem::path scripts;      // s1.edp ... s4.edp, dolf.py
  std::filesystem::path work;         // a folder of their own, made if absent
  double seconds = 600;               // no run begins later
  bool quick = false;                 // small runs alone
  std::vector<std::string> problems;  // empty: all
  std::function<bool()> stop_asked;
  std::function<void(const std::string&)> on_phase;
};

struct PeerRuns {
  std::vector<PeerRun> runs;
  std::vector<std::string> notes;  // what is not installed, failed or was left out
};

/// Throws Error(Files) when the folder holds none of the scripts of the task. Maps: slit.idp with common.idp, which the
/// script of bench/peers includes.
void require_scripts(const std::filesystem::path& folder, PeerTask task = PeerTask::State);

/// FreeFem++ and legacy dolfin, whichever are installed, on one thread. A run that fails or takes too long becomes a
/// note. Throws Error(Files).
PeerRuns run_peers(const PeerOptions& options);

}  // namespace kerf
