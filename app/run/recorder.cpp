// What an optimization leaves while it goes on: a line of history.csv and a design_NNNN.vtu per iteration, the
// collection for ParaView, and a few designs for the picture of the evolution. Files that are written anew (history,
// collection, snapshots) go by their name, so that one that waits to be written is replaced by a later one. After an
// interruption the lines of later iterations are dropped as soon as one is seen again. The time left is told from the
// iterations (level set) or the state solves (others) that may at most be done.

#include "app/run/recorder.hpp"

#include "app/progress.hpp"
#include "app/run/collect.hpp"
#include "geometry/part.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "kerf/stop.hpp"
#include "optimize/ersatz.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

namespace kerf {

namespace {

namespace fs = std::filesystem;

constexpr const char* snapshots_file = "checkpoint.strip";

std::string design_name(int number) {
  return fmt::format("design_{:04}.vtu", number);
}

/// Designs of other iterations.
void remove_but(const fs::path& folder, const std::set<int>& numbers) {
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    int number = -1;
    if (name.starts_with("design_") && name.ends_with(".vtu"))
      std::from_chars(name.data() + 7, name.data() + name.size() - 4, number);
    if (number >= 0 && !numbers.contains(number)) stale.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& path : stale) fs::remove(path, ignored);
}

/// Without the weak phase and what is mostly of it; the whole body without such phases.
Mesh strong_part(const Mesh& mesh, bool phases) {
  if (!phases) return mesh;
  std::vector<bool> use;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    use.push_back(strong_share(region_of(mesh, t)) >= 0.5);
  return part(mesh, use).mesh;
}

}  // namespace

Recorder::Recorder(const OptimizeTask& task, const OptimizeNames& names, const Journal& journal)
    : task_(task), names_(names), journal_(journal) {}

void Recorder::restore() {
  const fs::path history = journal_.file("history.csv");
  if (fs::exists(history)) {
    const std::string text = read_file(history), head = history_header(names_);
    std::size_t at = text.starts_with(head) ? head.size() : text.size();
    for (std::size_t end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
      int number = -1;
      std::from_chars(text.data() + at, text.data() + end, number);
      if (number >= 0) lines_[number] = text.substr(at, end + 1 - at);
    }
  }
  try {
    const auto kept = read_checkpoint(journal_.file(snapshots_file));
    if (kept && kept->fingerprint == task_.fingerprint) snapshots_ = from_checkpoint(*kept);
  } catch (const Error&) {
    // Pictures can do without.
  }
}

void Recorder::start() {
  since_start_.lap();
}

void Recorder::write_anew(const std::string& name, std::function<void(const fs::path&)> write) const {
  journal_.writer->put({[path = journal_.file(name), write = std::move(write)] { write(path); }, 0, name});
}

void Recorder::write_history() const {
  std::string out = history_header(names_);
  for (const auto& [number, line] : lines_) out += line;
  write_anew("history.csv", [out = std::move(out)](const fs::path& path) { write_file(path, out); });
}

void Recorder::write_designs() const {
  if (!journal_.vtk) return;
  std::vector<int> numbers;
  for (const auto& [number, line] : lines_) numbers.push_back(number);
  write_anew("optimize.pvd", [numbers = std::move(numbers)](const fs::path& path) {
    std::vector<std::pair<int, std::string>> files;
    for (const int number : numbers)
      if (fs::exists(path.parent_path() / design_name(number))) files.emplace_back(number, design_name(number));
    write_collection(path, files);
  });
}

void Recorder::write_design(const Iterate& iterate) const {
  PlotData data = plot_data(iterate.model, iterate.state, task_.problem.plane_strain);
  std::vector<NamedField> fields = design_fields(iterate.model, data);
  const std::size_t bytes = held(data.points, data.corners, fields);
  journal_.later([path = journal_.file(design_name(iterate.row.number)), points = std::move(data.points),
                  triangles = std::move(data.corners.of),
                  fields = std::move(fields)] { write_vtu(path, points, triangles, fields); },
                 bytes);
}

std::string Recorder::progress(const Iteration& row) {
  const OptimizeRequest& request = task_.request;
  elapsed_ += since_start_.lap();
  std::string text = fmt::format("optimize {}: J {:.6g}", row.number, row.objective);
  // Iterations of the level set, state solves of the others are what may at most be done.
  const bool level_set = request.method == OptimizeMethod::LevelSet;
  const double cases = std::max<double>(1, static_cast<double>(request.load_cases.size()));
  const double done = level_set ? row.number : row.state_solves / cases;
  if (rows_.size() == 1) first_done_ = done;
  if (const double here = done - first_done_; here > 0 && request.max_iterations > done)
    text += fmt::format(", at most {} left", duration(elapsed_ / here * (request.max_iterations - done)));
  text += fmt::format(", volume {:.4g}, step {:.2g}, {} hole{}, {} triangles", row.volume_fraction, row.step, row.holes,
                      row.holes == 1 ? "" : "s", row.triangles);
  if (!row.note.empty()) text += "; " + row.note;
  return text;
}

void Recorder::write_iterate(const Iterate& iterate) {
  const Iteration& row = iterate.row;
  lines_.erase(lines_.upper_bound(row.number), lines_.end());  // of an interrupted run
  lines_[row.number] = history_line(row, names_);
  if (journal_.vtk) write_design(iterate);
  write_designs();
  write_history();
  if (journal_.png || journal_.html) {
    add(snapshots_, {row.number, row.objective, row.volume_fraction,
                     contours(strong_part(iterate.model.mesh, task_.request.level_set.ersatz > 0))});
    // Pictures can do without: it is not flushed to the disk.
    write_anew(snapshots_file, [c = to_checkpoint(snapshots_, task_.fingerprint)](const fs::path& path) {
      write_checkpoint(path, c, Flush::Buffers);
    });
  }
}

void Recorder::see(const Iterate& iterate) {
  const Iteration& row = iterate.row;
  if (std::none_of(rows_.begin(), rows_.end(), [&](const Iteration& i) { return i.number == row.number; })) {
    rows_.push_back(row);
    const std::string text = progress(row);
    if (journal_.options.on_phase) journal_.options.on_phase(text);
    Stopwatch watch;
    write_iterate(iterate);
    if (journal_.options.on_iteration) journal_.writer->finish();
    output_ += watch.lap();
    if (journal_.options.on_iteration) journal_.options.on_iteration(row);
  }
  check_stop();
}

void Recorder::finish(const std::vector<Iteration>& history) {
  Stopwatch watch;
  lines_.clear();
  for (const Iteration& row : history) lines_[row.number] = history_line(row, names_);
  write_anew("history.csv",
             [history, names = names_](const fs::path& path) { write_history_csv(path, history, names); });
  std::set<int> numbers;
  for (const Iteration& row : history) numbers.insert(row.number);
  journal_.later([folder = journal_.options.folder, numbers = std::move(numbers)] { remove_but(folder, numbers); });
  write_designs();
  const auto unknown = [&](const Snapshot& s) { return lines_.count(s.iteration) == 0; };
  std::erase_if(snapshots_.kept, unknown);
  if (snapshots_.last && unknown(*snapshots_.last)) snapshots_.last.reset();
  output_ += watch.lap();
}

std::vector<Snapshot> Recorder::snapshots(std::size_t most) const {
  return pick(snapshots_, most);
}

}  // namespace kerf
