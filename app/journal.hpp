#pragma once
// What the steps of a run share: where files go, how phases are announced and timed, which pictures there are.

#include "io/arrays.hpp"
#include "io/files.hpp"
#include "io/result.hpp"
#include "plot/picture.hpp"
#include "solver/stopwatch.hpp"

namespace kerf {

struct RunFields;

class Processes;

struct RunOptions {
  std::filesystem::path folder;  // made if absent
  std::string command;           // that is kept with the case
  FolderLock* lock = nullptr;    // taken when the folder is there; none: who calls keeps others out
  int threads = 1;
  bool resume = false;                                      // an optimization goes on from its checkpoint
  std::function<void(const std::string& phase)> on_phase;   // called as each phase begins
  std::function<void(const Iteration&)> on_iteration = {};  // of an optimization, once its files are there
  RunFields* fields = nullptr;                              // where they are kept; none: in files alone
  Processes* processes = nullptr;                           // for backend = "petsc"; none: it is refused
};

struct Journal {
  const RunOptions& options;
  std::string title;                         // of the pictures
  Units units = {};                          // there, too
  bool vtk = true, png = true, html = true;  // which files are wanted
  Seconds seconds = {};                      // the total in the end
  std::vector<NamedArray> arrays = {};       // for the page
  Stopwatch since_start = {}, since_lap = {};
  std::string phase = {};    // the present one
  std::string missing = {};  // files that are wanted and cannot be had, and why; empty mostly

  std::filesystem::path file(const std::string& name) const {
    return options.folder / name;
  }
  /// Throws Stopped when a stop was asked for.
  void begin(const std::string& name);
  /// Seconds since the phase began, or since the last lap.
  double lap() {
    return since_lap.lap();
  }
  /// Draws what `make` returns, if pictures are wanted.
  template <typename Make>
  void picture(const std::string& name, const Make& make) const {
    if (!png) return;
    auto drawn = make();
    if constexpr (std::is_same_v<decltype(drawn), Picture>) drawn.units = units;
    draw(file(name), drawn);
  }
};

}  // namespace kerf
