#include "app/optimize.hpp"

#include "app/collect.hpp"
#include "app/files.hpp"
#include "geometry/part.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "kerf/inverse.hpp"
#include "kerf/optimize.hpp"
#include "optimize/checkpoint.hpp"
#include "optimize/ersatz.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

namespace kerf {

namespace {

namespace fs = std::filesystem;

fs::path checkpoint_file(const fs::path& folder) {
  return folder / "checkpoint.bin";
}
/// The checkpoint before the iteration in which a stop was asked for: the end of a loop may add to its own one.
fs::path stop_file(const fs::path& folder) {
  return folder / "checkpoint.stop";
}
fs::path snapshots_file(const fs::path& folder) {
  return folder / "checkpoint.strip";
}

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code failed;
  fs::rename(from, to, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot rename {} to {}: {}", from.string(), to.string(), failed.message()));
}

std::string design_name(int number) {
  return fmt::format("design_{:04}.vtu", number);
}

/// "1 h 05 min", "3 min 20 s", "12 s".
std::string duration(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (s >= 3600) return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
  if (s >= 60) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} s", s);
}

/// What one shot found, and how much of the data it explains.
std::vector<std::string> in_words(const OneShot& shot, const Design& design) {
  std::vector<std::string> notes;
  for (const Guess& guess : shot.guesses) {
    const Drawn& d = design.drawn.at(guess.drawn);
    std::string text = fmt::format("one shot: {} at ({:.4g}, {:.4g}), {} {:.3g}", name(d), guess.at.x(), guess.at.y(),
                                   d.kind == Drawn::Kind::Crack ? "half its length" : "radius", guess.size);
    if (d.kind == Drawn::Kind::Crack) text += fmt::format(", {:.0f} degrees", guess.angle * 180 / std::numbers::pi);
    if (d.kind == Drawn::Kind::Inclusion) text += fmt::format(", young {:.3g}", guess.young);
    notes.push_back(std::move(text));
  }
  if (std::isfinite(shot.explained))
    notes.push_back(fmt::format("one shot explains {:.1f} % of the data", 100 * shot.explained));
  return notes;
}

/// Without the weak phase and what is mostly of it; the whole body without such phases.
Mesh strong_part(const Mesh& mesh, bool phases) {
  if (!phases) return mesh;
  std::vector<bool> use;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    use.push_back(strong_share(region_of(mesh, t)) >= 0.5);
  return part(mesh, use).mesh;
}

struct Recorder {
  const Case& c;
  const RunOptions& options;
  OptimizeNames names;
  Snapshots snapshots;
  std::map<int, std::string> lines;  // of history.csv, by iteration
  std::map<int, bool> seen;          // in this run
  Stopwatch since_start;
  double elapsed = 0, output = 0;
  bool stopped = false;

  fs::path file(const std::string& name) const {
    return options.folder / name;
  }

  /// What an interrupted run has written.
  void restore() {
    if (fs::exists(file("history.csv"))) {
      const std::string text = read_file(file("history.csv")), head = history_header(names);
      std::size_t at = text.starts_with(head) ? head.size() : text.size();
      for (std::size_t end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
        int number = -1;
        std::from_chars(text.data() + at, text.data() + end, number);
        if (number >= 0) lines[number] = text.substr(at, end + 1 - at);
      }
    }
    try {
      if (const auto kept = read_checkpoint(snapshots_file(options.folder)); kept && kept->fingerprint == c.fingerprint)
        snapshots = from_checkpoint(*kept);
    } catch (const Error&) {
      // Pictures can do without.
    }
  }

  void write_history() const {
    std::string out = history_header(names);
    for (const auto& [number, line] : lines) out += line;
    write_file(file("history.csv"), out);
  }

  void write_designs() const {
    if (!c.output.vtk) return;
    std::vector<std::pair<int, std::string>> files;
    for (const auto& [number, line] : lines)
      if (fs::exists(file(design_name(number)))) files.emplace_back(number, design_name(number));
    write_collection(file("optimize.pvd"), files);
  }

  std::string progress(const Iteration& row) {
    const OptimizeRequest& request = *c.optimize;
    elapsed += since_start.lap();
    std::string text =
        fmt::format("optimize {}: J {:.6g}, volume {:.4g}, step {:.2g}, {} hole{}, {} triangles", row.number,
                    row.objective, row.volume_fraction, row.step, row.holes, row.holes == 1 ? "" : "s", row.triangles);
    // Iterations of the level set, state solves of the others are what may at most be done.
    const bool level_set = request.method == OptimizeMethod::LevelSet;
    const double cases = std::max<double>(1, static_cast<double>(request.load_cases.size()));
    const double done = level_set ? row.number : row.state_solves / cases;
    if (seen.size() == 1) first_done = done;
    if (const double here = done - first_done; here > 0 && request.max_iterations > done)
      text += fmt::format(", at most {} left", duration(elapsed / here * (request.max_iterations - done)));
    if (!row.note.empty()) text += "; " + row.note;
    return text;
  }
  double first_done = 0;

  bool see(const Iterate& iterate) {
    const Iteration& row = iterate.row;
    const bool again = seen.count(row.number) > 0;
    if (!again) {
      seen[row.number] = true;
      const std::string text = progress(row);
      if (options.on_phase) options.on_phase(text);
      Stopwatch watch;
      lines.erase(lines.upper_bound(row.number), lines.end());  // of an interrupted run
      lines[row.number] = history_line(row, names);
      if (c.output.vtk) {
        const PlotData data = plot_data(iterate.model, iterate.state, c.plane_strain);
        write_vtu(file(design_name(row.number)), data.points, data.corners.of, design_fields(iterate.model, data));
      }
      write_designs();
      write_history();
      if (c.output.png) {
        add(snapshots, {row.number, row.objective, row.volume_fraction,
                        contours(strong_part(iterate.model.mesh, c.optimize->level_set.ersatz > 0))});
        write_checkpoint(snapshots_file(options.folder), to_checkpoint(snapshots, c.fingerprint));
      }
      output += watch.lap();
    }
    if (options.stop_asked && options.stop_asked() && !stopped) {
      stopped = true;
      std::error_code failed;
      fs::copy_file(checkpoint_file(options.folder), stop_file(options.folder), fs::copy_options::overwrite_existing,
                    failed);
    }
    return !stopped;
  }

  /// The history as the loop tells it in the end; designs of iterations that it does not have go.
  void finish(const std::vector<Iteration>& history) {
    lines.clear();
    for (const Iteration& row : history) lines[row.number] = history_line(row, names);
    write_history_csv(file("history.csv"), history, names);
    std::vector<fs::path> stale;
    for (const auto& entry : fs::directory_iterator(options.folder)) {
      const std::string name = entry.path().filename().string();
      int number = -1;
      if (name.starts_with("design_") && name.ends_with(".vtu"))
        std::from_chars(name.data() + 7, name.data() + name.size() - 4, number);
      if (number >= 0 && lines.count(number) == 0) stale.push_back(entry.path());
    }
    std::error_code ignored;
    for (const fs::path& path : stale) fs::remove(path, ignored);
    write_designs();
  }
};

}  // namespace

bool has_checkpoint(const fs::path& folder) {
  return fs::exists(checkpoint_file(folder)) || fs::exists(stop_file(folder));
}

void check_checkpoint(const fs::path& folder, const Case& c) {
  const fs::path stop = stop_file(folder);
  const fs::path path = fs::exists(stop) ? stop : checkpoint_file(folder);
  const auto found = read_checkpoint(path);
  if (found && found->fingerprint != c.fingerprint)
    throw Error(Fault::Usage, fmt::format("the checkpoint {} belongs to another case: the case file or an override has "
                                          "changed; restore it, or start without --resume",
                                          path.string()));
}

Case with_data(Case c, const RunOptions& options) {
  if (!c.synthetic) return c;
  const Measurement m = measure(*c.synthetic, options.threads);
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < m.at.size(); ++i)
    rows.push_back({m.at[i].x(), m.at[i].y(), m.displacement[i].x(), m.displacement[i].y()});
  write_csv(options.folder / "measured.csv", {"x", "y", "u_x", "u_y"}, rows);
  c.functional = with_measured(std::move(c.functional), c.synthetic->label, m.field);
  return c;
}

Optimized optimize(const Case& c, const RunOptions& options) {
  OptimizeRequest request = *c.optimize;
  Optimized out;
  out.names = optimize_names(request);
  Recorder recorder{.c = c, .options = options, .names = out.names};
  const fs::path checkpoint = checkpoint_file(options.folder), stop = stop_file(options.folder);
  if (options.resume) {
    if (fs::exists(stop)) move_file(stop, checkpoint);
    if (fs::exists(checkpoint)) recorder.restore();
  }
  const Problem problem{.frame = c.shape,
                        .scene = c.scene,
                        .sizing = c.sizing,
                        .element = c.element,
                        .objective = c.functional,
                        .contact = c.contact,
                        .plane_strain = c.plane_strain,
                        .threads = options.threads};
  const CheckpointPlace place{checkpoint, c.fingerprint, options.resume};
  const Observer see = [&recorder](const Iterate& iterate) { return recorder.see(iterate); };
  std::vector<std::string> notes;
  if (wants_map(request.design)) {
    if (options.on_phase) options.on_phase("read the start off the topological derivative");
    OneShot shot = one_shot(problem, request.design, request.min_distance);
    request.design = std::move(shot.design);
    notes = in_words(shot, request.design);
  }
  recorder.since_start.lap();
  out.result = request.method == OptimizeMethod::LevelSet ? optimize_level_set(problem, request, see, place)
                                                          : optimize_parameters(problem, request, see, place);
  out.result.notes.insert(out.result.notes.begin(), notes.begin(), notes.end());
  if (c.synthetic && !request.design.drawn.empty())
    out.identified = identified(request.design, out.result.variables, problem, *c.synthetic);
  Stopwatch watch;
  out.stopped = recorder.stopped;
  if (out.stopped) {
    std::error_code ignored;
    if (fs::exists(stop))
      move_file(stop, checkpoint);
    else
      fs::remove(checkpoint, ignored);
  }
  recorder.finish(out.result.history);
  Snapshots& snapshots = recorder.snapshots;
  const auto unknown = [&](const Snapshot& s) { return recorder.lines.count(s.iteration) == 0; };
  std::erase_if(snapshots.kept, unknown);
  if (snapshots.last && unknown(*snapshots.last)) snapshots.last.reset();
  out.snapshots = pick(snapshots, 12);
  out.output = recorder.output + watch.lap();
  return out;
}

Case designed(const Case& c, const OptimizeResult& result) {
  Case out = c;
  out.shape = result.shape;
  out.scene = result.scene;
  if (out.scene.tractions.empty() && !out.scene.body) {
    const Scene loaded = loaded_scene(c);
    out.scene.tractions = loaded.tractions;
    out.scene.body = loaded.body;
  }
  return out;
}

}  // namespace kerf
