#include "app/optimize.hpp"

#include "app/recorder.hpp"
#include "io/history.hpp"
#include "optimize/checkpoint.hpp"
#include "plot/charts.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

namespace {

namespace fs = std::filesystem;

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code failed;
  fs::rename(from, to, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot rename {} to {}: {}", from.string(), to.string(), failed.message()));
}

/// What the initial guess found, and how much of the data it explains.
std::vector<std::string> in_words(const InitialGuess& found, const Design& design) {
  std::vector<std::string> notes;
  for (const Guess& guess : found.guesses) notes.push_back("one shot: " + in_words(guess, design));
  if (std::isfinite(found.explained))
    notes.push_back(fmt::format("one shot explains {:.1f} % of the data", 100 * found.explained));
  return notes;
}

/// The design with its start read off the map, where it asks for that; says what was found.
std::vector<std::string> fill_in_start(const Problem& problem, OptimizeRequest& request, const Journal& journal) {
  if (!wants_map(request.design)) return {};
  if (journal.options.on_phase) journal.options.on_phase("read the start off the topological derivative");
  InitialGuess guess = initial_guess(problem, request.design, request.min_distance);
  request.design = std::move(guess.design);
  return in_words(guess, request.design);
}

/// The checkpoint is that of the last iteration before the stop, or none.
void keep_stop(const fs::path& checkpoint, const fs::path& stop) {
  std::error_code ignored;
  if (fs::exists(stop))
    move_file(stop, checkpoint);
  else
    fs::remove(checkpoint, ignored);
}

void draw_optimization(const OptimizeSection& section, const Recorder& recorder, Journal& journal) {
  const auto evolution = [&] { return Evolution{journal.title, sentence(section.result), recorder.snapshots()}; };
  journal.picture("evolution.png", "Evolution of the design", evolution);
  journal.picture("history.png", "Objective and volume",
                  [&] { return history_curves(section.result, section.names, journal.title); });
}

}  // namespace

bool has_checkpoint(const fs::path& folder) {
  return fs::exists(checkpoint_file(folder)) || fs::exists(stop_file(folder));
}

void check_checkpoint(const fs::path& folder, const std::string& fingerprint) {
  const fs::path stop = stop_file(folder);
  const fs::path path = fs::exists(stop) ? stop : checkpoint_file(folder);
  const auto found = read_checkpoint(path);
  if (found && found->fingerprint != fingerprint)
    throw Error(Fault::Usage, fmt::format("the checkpoint {} belongs to another case: the case file or an override has "
                                          "changed; restore it, or start without --resume",
                                          path.string()));
}

Functional with_data(Functional j, const Synthetic& truth, const RunOptions& options) {
  const Measurement m = measure(truth, options.threads);
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < m.at.size(); ++i)
    rows.push_back({m.at[i].x(), m.at[i].y(), m.displacement[i].x(), m.displacement[i].y()});
  write_csv(options.folder / "measured.csv", {"x", "y", "u_x", "u_y"}, rows);
  return with_measured(std::move(j), truth.label, m.field);
}

OptimizeSection optimize_body(const OptimizeTask& task, Journal& journal) {
  journal.begin("optimize");
  OptimizeSection out{.names = optimize_names(task.request)};
  Recorder recorder(task, out.names, journal);
  const RunOptions& options = journal.options;
  const fs::path checkpoint = checkpoint_file(options.folder), stop = stop_file(options.folder);
  if (options.resume) {
    if (fs::exists(stop)) move_file(stop, checkpoint);
    if (fs::exists(checkpoint)) recorder.restore();
  }
  OptimizeRequest request = task.request;
  const std::vector<std::string> notes = fill_in_start(task.problem, request, journal);
  const CheckpointPlace place{checkpoint, task.fingerprint, options.resume};
  const Observer see = [&recorder](const Iterate& iterate) { return recorder.see(iterate); };
  recorder.start();
  out.result = request.method == OptimizeMethod::LevelSet ? optimize_level_set(task.problem, request, see, place)
                                             : optimize_parameters(task.problem, request, see, place);
  out.result.notes.insert(out.result.notes.begin(), notes.begin(), notes.end());
  if (task.truth && !request.design.drawn.empty())
    out.identified = identified(request.design, out.result.variables, task.problem, *task.truth);
  if (recorder.stopped()) keep_stop(checkpoint, stop);
  recorder.finish(out.result.history);
  journal.seconds.optimize = journal.lap() - recorder.output();
  draw_optimization(out, recorder, journal);
  journal.seconds.output += recorder.output() + journal.lap();
  if (recorder.stopped())
    throw Error(Fault::Numerics, fmt::format("stopped after iteration {}; --resume goes on from there",
                                             out.result.history.empty() ? 0 : out.result.history.back().number));
  return out;
}

}  // namespace kerf
