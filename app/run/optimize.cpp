// An optimization in a run: start, iterations, what comes after them, pictures. The start is read off the map where the
// case asks for it (initial guess), or off the count of defects; then the level set or the method for drawn things
// iterates, observed by the recorder; then readings are fitted by least squares from where the misfit led, and the
// fitted design replaces it. Synthetic data are made first (with_data), and what was found is compared with the true
// body. A stop leaves pictures of what there is and a checkpoint to go on from; a checkpoint of another case is refused
// by its fingerprint. docs/theory/inverse.md has the guess, the fit and the count.

#include "app/run/optimize.hpp"

#include "app/run/recorder.hpp"
#include "app/write/draw.hpp"
#include "app/write/page_data.hpp"
#include "io/history.hpp"
#include "kerf/analysis.hpp"
#include "kerf/stop.hpp"
#include "optimize/checkpoint.hpp"
#include "plot/charts.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// What the initial guess found, and how much of the data it explains.
std::vector<std::string> guesses_in_words(const InitialGuess& found, const Design& design) {
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
  return guesses_in_words(guess, request.design);
}

/// How many there are; their starts are then what fits the readings best.
std::vector<std::string> count_things(const OptimizeTask& task, OptimizeRequest& request, const Journal& journal,
                                      OptimizeSection& out) {
  if (!task.fit || task.fit->defects_at_most == 0) return {};
  if (journal.options.on_phase) journal.options.on_phase("count the defects");
  out.counted = count_defects(task.problem, request, task.readings, task.fit->defects_at_most);
  request.design = out.counted->tried[out.counted->chosen].design;
  return {in_words(*out.counted)};
}

/// The objective of a body.
double objective_of(const Problem& p, const Shape& shape, const Scene& scene) {
  const Model m = prepare(triangulate(shape, p.sizing), p.element, scene, p.threads);
  const State s = solve(m, p.contact);
  return certified(s) ? analyze(p.objective, m, s, true).value : nan;
}

/// The readings tell of nothing: the body as it is drawn.
OptimizeSection nothing_found(const OptimizeTask& task, std::vector<std::string> notes, OptimizeSection out) {
  out.names = optimize_names({});
  OptimizeResult& r = out.result;
  r.method = task.request.method;
  r.stopped = fmt::format("{}: the readings tell of no defect, and there is nothing to move", word(r.ending));
  r.state_solves = 1;
  r.volume_fraction = 1;
  r.objective = objective_of(task.problem, task.problem.frame, task.problem.scene);
  r.notes = std::move(notes);
  r.shape = task.problem.frame;
  r.scene = task.problem.scene;
  out.fit = out.counted->tried[0].fit;
  return out;
}

/// Least squares of the readings from where the misfit has led to; the design is then what they found.
void fit_readings(const OptimizeTask& task, const OptimizeRequest& request, const Journal& journal,
                  OptimizeSection& out) {
  if (journal.options.on_phase) journal.options.on_phase("fit the readings");
  OptimizeResult& r = out.result;
  try {
    out.fit = least_squares(task.problem, request, r.variables, task.readings);
  } catch (const Error& e) {
    if (!of_one_body(e)) throw;
    r.notes.push_back(fmt::format("the readings could not be fitted: {}", e.what()));
    return;
  }
  DrawnBody body = body_of(request.design, out.fit->variables, task.problem);
  r.notes.push_back(fmt::format(
      "the design is that of least squares of the readings, begun from that of the misfit ({:.6g})", r.objective));
  r.objective = objective_of(task.problem, body.shape, body.scene);
  r.variables = out.fit->variables;
  r.shape = std::move(body.shape);
  r.scene = std::move(body.scene);
  r.state_solves += out.fit->state_solves;
  judge_fit(task.problem, request, *out.fit, r);
}

Picture found_picture(const OptimizeTask& task, const OptimizeRequest& request, const OptimizeSection& out,
                      const std::string& title) {
  Found found{.frame = task.problem.frame,
              .found = out.result.shape,
              .start = body_of(request.design, start_of(request.design), task.problem).shape};
  if (task.truth) found.truth = task.truth->true_shape;
  if (out.fit) found.ellipses = out.fit->ellipses;
  return found_picture(title, found);
}

void draw_optimization(const OptimizeSection& section, const Recorder& recorder, Journal& journal) {
  const auto evolution = [&] { return Evolution{journal.title, sentence(section.result), recorder.snapshots(12)}; };
  journal.picture("evolution.png", evolution);
  journal.picture("history.png", [&] { return history_curves(section.result, section.names, journal.title); });
  if (section.result.holes.mesh)
    journal.picture("optimality.png", [&] { return optimality_picture(journal.title, section.result.holes); });
}

/// Pictures of what there is. Throws Error(Numerics).
[[noreturn]] void end_stopped(OptimizeSection& out, const OptimizeRequest& request, const Recorder& recorder,
                              Journal& journal) {
  if (recorder.rows().empty()) throw Stopped{};
  const Iteration& last = recorder.rows().back();
  OptimizeResult& r = out.result;
  r.method = request.method;
  r.history = recorder.rows();
  r.iterations = last.number;
  r.state_solves = last.state_solves;
  r.stopped = "stopped as asked";
  draw_optimization(out, recorder, journal);
  throw Error(Fault::Numerics, fmt::format("stopped after iteration {}; --resume goes on from there", last.number));
}

}  // namespace

Case with_data(Case c, const RunOptions& options) {
  const Measurement m = measure(*c.synthetic, options.threads);
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < m.at.size(); ++i)
    rows.push_back({m.at[i].x(), m.at[i].y(), m.displacement[i].x(), m.displacement[i].y()});
  write_csv(options.folder / "measured.csv", {"x", "y", "u_x", "u_y"}, rows);
  c.functional = with_measured(std::move(c.functional), c.synthetic->label, m.field);
  const double given = c.readings.noise;
  c.readings = readings_of(m, *c.synthetic);
  if (given > 0) c.readings.noise = given;
  return c;
}

std::string note_on_start(double share, double at_most) {
  constexpr double kept = 1e-3;  // relative
  if (share <= (1 + kept) * at_most) return {};
  return fmt::format(
      "the design to begin with takes {:.4g} of the area, more than volume.at_most = {:.4g}: the first iterations take "
      "material away, whatever J does",
      share, at_most);
}

namespace {

/// Of a design that was given: the full body is above every limit.
std::string note_on_given_start(const OptimizeRequest& r, const OptimizeResult& result) {
  const bool given = r.level_set.start_design || r.level_set.start || !r.design.drawn.empty();
  return given && r.volume_at_most && !result.history.empty()
             ? note_on_start(result.history.front().volume_fraction, *r.volume_at_most)
             : std::string();
}

}  // namespace

OptimizeSection optimize_body(const OptimizeTask& task, Journal& journal) {
  journal.begin("optimize");
  OptimizeRequest request = task.request;
  OptimizeSection out;
  std::vector<std::string> notes = count_things(task, request, journal, out);
  if (out.counted && request.design.drawn.empty()) return nothing_found(task, std::move(notes), std::move(out));
  for (std::string& note : fill_in_start(task.problem, request, journal)) notes.push_back(std::move(note));
  out.names = optimize_names(request);
  Recorder recorder(task, out.names, journal);
  const RunOptions& options = journal.options;
  if (options.resume && fs::exists(checkpoint_file(options.folder))) recorder.restore();
  const CheckpointPlace place{checkpoint_file(options.folder), task.fingerprint, options.resume,
                              [&journal](std::function<void()> write) {
                                journal.writer->put_last({std::move(write), 0, "checkpoint.bin"});
                              }};
  const Observer see = [&recorder](const Iterate& iterate) {
    recorder.see(iterate);
    return true;
  };
  recorder.start();
  try {
    out.result = request.method == OptimizeMethod::LevelSet
                     ? optimize_level_set(task.problem, request, see, place)
                     : optimize_parameters(task.problem, request, see, place, task.pool);
    if (std::string above = note_on_given_start(request, out.result); !above.empty()) notes.push_back(std::move(above));
    out.result.notes.insert(out.result.notes.begin(), notes.begin(), notes.end());
    if (task.fit) fit_readings(task, request, journal, out);
  } catch (const Stopped&) {
    end_stopped(out, request, recorder, journal);
  }
  if (task.truth && !request.design.drawn.empty())
    out.identified = identified(request.design, out.result.variables, task.problem, *task.truth);
  recorder.finish(out.result.history);
  journal.seconds.optimize = journal.lap() - recorder.output();
  draw_optimization(out, recorder, journal);
  if (journal.html) add_shots(journal.arrays, "design", recorder.snapshots(64));
  if (task.truth || out.fit) {
    journal.picture("found.png", [&] { return found_picture(task, request, out, journal.title); });
    if (journal.html) add_found(journal.arrays, found_picture(task, request, out, journal.title));
  }
  journal.seconds.output += recorder.output() + journal.lap();
  return out;
}

}  // namespace kerf
