#pragma once
// Other programs on the same problems, through scripts that print one JSON line per run.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace kerf {

struct PeerRun {
  std::string problem;  // as in problem_kinds
  double poisson = 0;
  std::string name;  // program, element, linear solver, mesh: runs of one name form a sequence
  long triangles = 0, unknowns = 0;
  double work = 0;  // processor seconds for mesh, assembly, solution and stress
  double stress_error = 0;
};

struct PeerOptions {
  std::filesystem::path scripts;      // s1.edp ... s4.edp, dolf.py
  std::filesystem::path work;         // a folder of their own, made if absent
  double seconds = 600;               // no run begins later
  bool quick = false;                 // one small run of each program
  std::vector<std::string> problems;  // empty: all
  std::function<bool()> stop_asked;
  std::function<void(const std::string&)> on_phase;
};

struct PeerRuns {
  std::vector<PeerRun> runs;
  std::vector<std::string> notes;  // what is not installed, failed or was left out
};

/// Throws Error(Files) when the folder holds none of the scripts.
void require_scripts(const std::filesystem::path& folder);

/// FreeFem++ and legacy dolfin, whichever are installed, on one thread. A run that fails or takes too long becomes a
/// note. Throws Error(Files).
PeerRuns run_peers(const PeerOptions& options);

}  // namespace kerf
