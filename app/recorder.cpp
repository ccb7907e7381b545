#include "app/recorder.hpp"

#include "app/collect.hpp"
#include "app/progress.hpp"
#include "geometry/part.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "kerf/stop.hpp"
#include "optimize/ersatz.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

namespace {

namespace fs = std::filesystem;

fs::path snapshots_file(const fs::path& folder) {
  return folder / "checkpoint.strip";
}

std::string design_name(int number) {
  return fmt::format("design_{:04}.vtu", number);
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

fs::path checkpoint_file(const fs::path& folder) {
  return folder / "checkpoint.bin";
}

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
    const auto kept = read_checkpoint(snapshots_file(journal_.options.folder));
    if (kept && kept->fingerprint == task_.fingerprint) snapshots_ = from_checkpoint(*kept);
  } catch (const Error&) {
    // Pictures can do without.
  }
}

void Recorder::start() {
  since_start_.lap();
}

void Recorder::write_history() const {
  std::string out = history_header(names_);
  for (const auto& [number, line] : lines_) out += line;
  write_file(journal_.file("history.csv"), out);
}

void Recorder::write_designs() const {
  if (!journal_.vtk) return;
  std::vector<std::pair<int, std::string>> files;
  for (const auto& [number, line] : lines_)
    if (fs::exists(journal_.file(design_name(number)))) files.emplace_back(number, design_name(number));
  write_collection(journal_.file("optimize.pvd"), files);
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
  if (journal_.vtk) {
    const PlotData data = plot_data(iterate.model, iterate.state, task_.problem.plane_strain);
    write_vtu(journal_.file(design_name(row.number)), data.points, data.corners.of, design_fields(iterate.model, data));
  }
  write_designs();
  write_history();
  if (journal_.png || journal_.html) {
    add(snapshots_, {row.number, row.objective, row.volume_fraction,
                     contours(strong_part(iterate.model.mesh, task_.request.level_set.ersatz > 0))});
    write_checkpoint(snapshots_file(journal_.options.folder), to_checkpoint(snapshots_, task_.fingerprint));
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
    output_ += watch.lap();
    if (journal_.options.on_iteration) journal_.options.on_iteration(row);
  }
  check_stop();
}

void Recorder::finish(const std::vector<Iteration>& history) {
  Stopwatch watch;
  lines_.clear();
  for (const Iteration& row : history) lines_[row.number] = history_line(row, names_);
  write_history_csv(journal_.file("history.csv"), history, names_);
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(journal_.options.folder)) {
    const std::string name = entry.path().filename().string();
    int number = -1;
    if (name.starts_with("design_") && name.ends_with(".vtu"))
      std::from_chars(name.data() + 7, name.data() + name.size() - 4, number);
    if (number >= 0 && lines_.count(number) == 0) stale.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& path : stale) fs::remove(path, ignored);
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
