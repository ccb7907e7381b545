#pragma once
// An optimization and the files that it leaves while it runs.

#include "app/run.hpp"
#include "plot/evolution.hpp"

namespace kerf {

/// Whether there is something to resume.
bool has_checkpoint(const std::filesystem::path& folder);
/// Throws Error(Usage) when the folder holds a checkpoint of another case, Error(Files) when it cannot be read.
void check_checkpoint(const std::filesystem::path& folder, const Case& c);

struct Optimized {
  OptimizeResult result;
  OptimizeNames names;
  std::vector<Identified> identified = {};  // with synthetic data
  std::vector<Snapshot> snapshots;          // for evolution.png
  double output = 0;                        // seconds spent on files
  bool stopped = false;                     // as options.stop_asked wanted; the checkpoint can be resumed
};

/// The case with the data of [synthetic], if it has that, which also go to measured.csv. Throws as measure does.
Case with_data(Case c, const RunOptions& options);

/// Runs [optimize] of the case. Every accepted iterate leaves design_NNNN.vtu, optimize.pvd and history.csv; the loops
/// keep checkpoint.bin. Resumed, all of these go on as if nothing had happened. Throws what the loops throw.
Optimized optimize(const Case& c, const RunOptions& options);

/// The optimal design as a case of its own: its shape, its scene with the loads of the first load case.
Case designed(const Case& c, const OptimizeResult& result);

}  // namespace kerf
