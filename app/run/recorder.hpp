#pragma once
// The files that an optimization leaves while it runs.

#include "app/run/checkpoints.hpp"
#include "app/run/optimize.hpp"
#include "plot/evolution.hpp"

#include <map>

namespace kerf {

class Recorder {
 public:
  Recorder(const OptimizeTask& task, const OptimizeNames& names, const Journal& journal);

  /// What an interrupted run has written.
  void restore();
  /// The loop begins.
  void start();
  /// An accepted iterate: its files and its line of progress. Throws Stopped, after them, when a stop was asked for.
  void see(const Iterate& iterate);
  /// The history as the loop tells it in the end; designs of iterations that it does not have go.
  void finish(const std::vector<Iteration>& history);

  /// Iterates of this run so far.
  const std::vector<Iteration>& rows() const {
    return rows_;
  }
  /// Seconds spent on files so far.
  double output() const {
    return output_;
  }
  /// At most so many, once finished.
  std::vector<Snapshot> snapshots(std::size_t most) const;

 private:
  void write_history() const;
  void write_designs() const;
  void write_design(const Iterate& iterate) const;
  void write_iterate(const Iterate& iterate);
  /// A file that every iterate has anew.
  void write_anew(const std::string& name, std::function<void(const std::filesystem::path&)> write) const;
  std::string progress(const Iteration& row);

  const OptimizeTask& task_;
  const OptimizeNames& names_;
  const Journal& journal_;
  Snapshots snapshots_;
  std::map<int, std::string> lines_;  // of history.csv, by iteration
  std::vector<Iteration> rows_;       // seen in this run
  Stopwatch since_start_;
  double elapsed_ = 0, output_ = 0, first_done_ = 0;
};

}  // namespace kerf
