#pragma once
// One case with many values of some of its keys: what is to be run, what has been, and a table of it.

#include "kerf/types.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// A key and the values that it takes, as TOML.
struct Swept {
  std::string key;
  std::vector<std::string> values;
};
/// "mesh.size=[0.1, 0.05]", "mesh.size=0.1,0.05", "mesh.size=auto". Throws Error(Usage).
Swept parse_swept(std::string_view assignment);

/// A run of the sweep: a folder and its values, one for every key that is swept.
struct SweepRun {
  std::string name;
  std::vector<std::string> values;
};

struct SweepPlan {
  std::filesystem::path case_file, folder;
  std::vector<std::string> overrides;  // of all runs: "key=value"
  std::vector<Swept> over;
  /// Of result.json, for the table: names, or their ends ("K_I"); "all". Empty: intensities, release rates, the largest
  /// stress, functionals, verdicts and the like.
  std::vector<std::string> columns = {};
  bool study = false;               // of convergence: mesh.size takes three values, each half of the one before
  std::vector<SweepRun> runs = {};  // every value with every other, the last key fastest
};
/// "mesh.size=auto" becomes twice the size of the case, its size and half of it. Throws Error(Usage) where it stands
/// for another key; what read_case throws.
SweepPlan with_sizes(SweepPlan plan);
/// The folders are called by their values, so that a sweep that gets further values keeps what it has. Throws
/// Error(Usage) for a key or a value that stands twice, and for too many runs.
SweepPlan plan_sweep(SweepPlan plan);

/// All overrides of a run.
std::vector<std::string> overrides_of(const SweepPlan& plan, const SweepRun& run);

/// What is known of a run by its folder: done and failed ones are of the case as it is now. A failure that another
/// attempt may mend (files, a signal, no memory) is still to be done.
struct RunRecord {
  enum class State { Todo, Done, Failed } state = State::Todo;
  std::string reason;  // of a failure
};
RunRecord record_of(const SweepPlan& plan, const SweepRun& run);

/// A failure, for record_of: to failed.txt in the folder of the run.
void write_failure(const std::filesystem::path& folder, int exit_code, const std::string& message);

/// A quantity on three meshes, each of half the size of the one before, and its limit by Richardson's extrapolation:
/// q = limit + c h^order. No limit where the differences do not fall, or change sign.
struct Convergence {
  std::string of, with;  // the column; values of other keys, "crack[0].contact=open"
  std::array<double, 3> size{}, value{};
  double order = nan, limit = nan;
  double error = nan;  // of the value on the finest mesh: its distance from the limit, or the larger difference
  double said = nan;   // the margin that the finest run itself says
};
/// Fills in order, limit and error.
void extrapolate(Convergence& c);

struct SweepSummary {
  std::size_t done = 0, failed = 0, missing = 0;
  std::vector<std::string> failures;  // "name: reason"
  std::vector<Convergence> convergence = {};
};
/// sweep.csv and sweep.html, from the folders of the runs; of a study of convergence convergence.csv, too. Throws
/// Error(Usage) for a column that no run has.
SweepSummary collect_sweep(const SweepPlan& plan);

/// "97 runs done, 3 failed", with the failures.
std::string in_words(const SweepSummary& summary, const SweepPlan& plan);

/// Runs what is to be done, each in a process of its own, `jobs` at a time. Returns early when a stop is asked for.
struct SweepHow {
  int jobs = 1, threads = 1;
  bool quiet = false;
  std::vector<std::string> limits = {};  // of each run, as words of its command line
};
void run_sweep(const SweepPlan& plan, const SweepHow& how);

/// A Snakefile, or a job array for Slurm, in the folder, which run one case each by `kerf run`; `again` is the command
/// that then makes the table. Returns what to type.
std::string write_sweep_script(const SweepPlan& plan, const std::string& kind, int threads, const std::string& again);

}  // namespace kerf
