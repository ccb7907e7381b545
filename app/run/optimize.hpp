#pragma once
// An optimization with everything that it leaves behind.

#include "app/run/journal.hpp"
#include "kerf/case_file.hpp"
#include "optimize/task_pool.hpp"

namespace kerf {

struct OptimizeTask {
  Problem problem;
  OptimizeRequest request;
  std::optional<Synthetic> truth;  // what synthetic data come from
  std::optional<FitRequest> fit;   // of an inverse problem, by its readings
  Readings readings;
  std::string fingerprint;  // of the case, for its checkpoint
  TaskPool pool = {};       // for its starts; none: this process tries them
};

/// The case with the data of the body that is known, in its functional and as readings, and in measured.csv. Throws as
/// measure does.
Case with_data(Case c, const RunOptions& options);

/// Where a design to begin with takes a larger share of the body than is allowed: how much. Empty otherwise.
std::string note_on_start(double share, double at_most);

/// What a result says about an optimization. `identified`: with synthetic data.
struct OptimizeSection {
  OptimizeResult result;
  OptimizeNames names;
  std::vector<Identified> identified = {};
  std::optional<Count> counted = {};
  std::optional<LeastSquares> fit = {};
};

/// Every accepted iterate leaves design_NNNN.vtu, optimize.pvd and history.csv; the loops keep checkpoint.bin. Resumed,
/// all of these go on as if nothing had happened. Asked to stop it leaves its files, its pictures and a checkpoint, and
/// throws Error(Numerics). Throws what the loops throw.
OptimizeSection optimize_body(const OptimizeTask& task, Journal& journal);

}  // namespace kerf
