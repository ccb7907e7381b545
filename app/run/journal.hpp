#pragma once
// What the steps of a run share: where files go, how phases are announced and timed, which pictures there are.

#include "app/write/writer.hpp"
#include "base/stopwatch.hpp"
#include "io/arrays.hpp"
#include "io/files.hpp"
#include "io/result.hpp"
#include "plot/picture.hpp"

namespace kerf {

struct RunFields;

class Processes;

struct RunOptions {
  std::filesystem::path folder;  // made if absent
  std::string command;           // that is kept with the case
  FolderLock* lock = nullptr;    // taken when the folder is there; none: who calls keeps others out
  int threads = 1;
  bool resume = false;                                          // an optimization goes on from its checkpoint
  std::function<void(const std::string& phase)> on_phase;       // called as each phase begins
  std::function<void(const Iteration&)> on_iteration = {};      // of an optimization, once its files are there
  std::function<void(const growth::GrowthStep&)> on_step = {};  // of growth
  RunFields* fields = nullptr;                                  // where they are kept; none: in files alone
  bool in_single = false;                                       // the factor, whatever the case says
  Processes* processes = nullptr;                               // for backend = "petsc"; none: it is refused
};

struct Journal {
  const RunOptions& options;
  std::string title;                         // of the pictures
  Units units = {};                          // there, too
  bool vtk = true, png = true, html = true;  // which files are wanted
  Seconds seconds = {};                      // the total in the end
  std::vector<NamedArray> arrays = {};       // for the page
  Stopwatch since_start = {}, since_lap = {};
  std::string phase = {};      // the present one
  std::string load_case = {};  // whose state the pictures show; empty without load cases
  bool whole = true;           // fields are those of this process; else each of several writes its piece
  std::string missing = {};    // files that are wanted and cannot be had, and why; empty mostly
  std::shared_ptr<Writer> writer = std::make_shared<Writer>();  // of the files, result.json and the page aside

  std::filesystem::path file(const std::string& name) const {
    return options.folder / name;
  }
  /// Of a picture of the state, or of what comes from it.
  std::string title_of_state() const {
    return load_case.empty() ? title : title + ", load case " + load_case;
  }
  /// Throws Stopped when a stop was asked for.
  void begin(const std::string& name);
  /// Seconds since the phase began, or since the last lap.
  double lap() {
    return since_lap.lap();
  }
  /// Writes it while the run goes on. `write` has copies of what it needs, about so many bytes.
  void later(std::function<void()> write, std::size_t bytes = 0) const {
    writer->put({std::move(write), bytes});
  }
  /// Draws what `make` returns, if pictures are wanted, while the run goes on.
  template <typename Make>
  void picture(const std::string& name, const Make& make) const {
    if (!png) return;
    auto drawn = make();
    std::size_t bytes = 0;
    if constexpr (std::is_same_v<decltype(drawn), Picture>) {
      drawn.units = units;
      bytes = held(drawn);
    }
    later([path = file(name), drawn = std::move(drawn)] { draw(path, drawn); }, bytes);
  }
};

}  // namespace kerf
