// A run: the jobs that a case asks for, one after the other, each adding its section to the result and its files to the
// folder. First everything is refused that is known to be impossible before anything is solved, then the folder is
// prepared and the case kept in it. The order of the jobs is
//   state (with load cases or steps), functional and map, validation, optimization, intervals, probes, result.json,
//   page;
// with an optimization alone the state is that of its design. A section is there as soon as it is known: what fails
// later leaves it, result.json then says "failed" and why, and the error goes on to the caller. Nothing is built on a
// state that is not certified: the status is "not converged". Where an edge that follows a curve folds a triangle the
// body is solved once more with chords, unless the case insists on curves. Several processes solve a divided mesh
// together and find what is asked of the state while they have it (parts.cpp); from there on the first one goes on as
// one process does.

#include "app/run.hpp"
#include "app/processes.hpp"
#include "app/run/peaks.hpp"

#include "app/command/refuse.hpp"
#include "app/command/report.hpp"
#include "app/folder.hpp"
#include "app/parts/parts.hpp"
#include "app/parts/task_pool.hpp"
#include "app/run/bounds.hpp"
#include "app/run/checkpoints.hpp"
#include "app/run/edge_cracks.hpp"
#include "app/run/findings.hpp"
#include "app/run/grow.hpp"
#include "app/run/history.hpp"
#include "app/run/load_cases.hpp"
#include "app/run/map.hpp"
#include "app/run/margins.hpp"
#include "app/run/notes.hpp"
#include "app/run/optimize.hpp"
#include "app/run/point_values.hpp"
#include "app/run/solve.hpp"
#include "app/run/validate.hpp"
#include "app/write/draw.hpp"
#include "app/write/files.hpp"
#include "app/write/page_data.hpp"
#include "io/document.hpp"
#include "io/files.hpp"
#include "io/kept.hpp"
#include "io/mesh_source.hpp"
#include "kerf/stop.hpp"
#include "optimize/load_cases.hpp"
#include "plot/page.hpp"
#include "solver/adapting.hpp"
#include "solver/divided_body.hpp"
#include "solver/system.hpp"
#include "topo/analysis.hpp"

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>

namespace kerf {

namespace {

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// What the steps take from a case.

Body body_of(const Case& c) {
  return {c.shape, c.sizing, c.scene, c.element};
}
/// The same with the mesh graded as that of the solution.
Body body_of(const Case& c, const Adapted& adapted) {
  return {c.shape, adapted.sizing, c.scene, c.element};
}

Adaptation adaptation(const Case& c, const RunOptions& options) {
  Adaptation how{.contact = c.contact,
                 .saddle_point = c.backend == Backend::Umfpack,
                 .estimate = c.output.estimate,
                 .threads = options.threads};
  if (c.precision == FactorPrecision::Single || options.in_single) how.precision = Precision::Single;
  if (c.adapt) how.error = c.adapt->error, how.max_triangles = c.adapt->max_triangles;
  how.given = c.mesh;
  how.divisions = c.divisions;
  return how;
}

MapTask map_task(const Case& c) {
  static const std::vector<Vec2> everywhere;
  return {c.functional, c.map_request, c.map ? c.map->points : everywhere};
}

OptimizeTask optimize_task(const Case& c, const RunOptions& options) {
  return {.problem = problem_of(c, options.threads),
          .request = *c.optimize,
          .truth = c.synthetic,
          .fit = c.fit,
          .readings = c.readings,
          .fingerprint = c.fingerprint,
          .pool = task_pool_of(c, options.processes)};
}

/// The optimal design as a case of its own: its shape, its scene with the loads of the first load case.
Case designed(const Case& c, const OptimizeResult& result) {
  Case out = c;
  out.mesh.reset();
  out.shape = result.shape;
  out.scene = result.scene;
  if (out.scene.tractions.empty() && !out.scene.body) {  // loads of load cases: then no crack has a pressure
    const Scene loaded = loaded_scene(c);
    out.scene.tractions = loaded.tractions;
    out.scene.body = loaded.body;
  }
  choose_edges(out);
  return out;
}

Picture picture_of(const Case& design, const Mesh& mesh) {
  std::vector<LoadCase> all = by_name(design.optimize->load_cases);
  const std::span<const LoadCase> further = all.empty() ? std::span(all) : std::span(all).subspan(1);
  return design_picture(design.title, mesh, design.scene, further, extent(design.shape));
}

struct Jobs {
  bool map = false, validate = false, optimize = false, grow = false;
  bool edges = false, draw_edges = false;  // instead of the first two, with perturbation = "edge_crack"
};

Jobs jobs_of(const Case& c, Job job) {
  const bool edges = c.edge_cracks.has_value(), lengths = !c.drawn_lengths.empty();
  const bool validate = job == Job::Validate || (job == Job::Run && (c.validate || lengths));
  const Jobs jobs{.map = !edges && (job == Job::Map || (job == Job::Run && c.map)),
                  .validate = !edges && validate,
                  .optimize = job == Job::Optimize || (job == Job::Run && c.optimize),
                  .grow = job == Job::Grow || (job == Job::Run && c.grow),
                  .edges = edges && (job == Job::Map || job == Job::Validate || job == Job::Run),
                  .draw_edges = edges && validate};
  if (jobs.draw_edges ? !lengths : jobs.validate && !c.validate)
    throw Error(Fault::Usage, "the case has no table [validate]; add it with points and radii");
  if (jobs.optimize && !c.optimize)
    throw Error(Fault::Usage, "the case has no table [optimize]; add it with method and volume");
  if (jobs.grow && !c.grow) throw Error(Fault::Usage, "the case has no table [grow]; add it with a law");
  return jobs;
}

/// A mesh from a file may be of a body that cannot be drawn: known before anything is solved.
void refuse_remeshing(const Case& c, const Jobs& jobs) {
  if (!c.mesh) return;
  const char* why = jobs.optimize                      ? "optimize"
                    : jobs.validate || jobs.draw_edges ? "validate"
                    : jobs.grow                        ? "grow cracks"
                    : jobs.map && c.map_request.bounds ? "bound the map"
                    : c.adapt                          ? "adapt the mesh"
                    : c.synthetic                      ? "make up measurements"
                                                       : nullptr;
  if (!why) return;
  if (const auto problem = find_problem(c.shape))
    throw Error(
        Fault::Geometry,
        fmt::format("{}; to {}, kerf would have to mesh this body anew, and cannot (kerf solve and map can use the "
                    "mesh as it is)",
                    *problem, why));
}

/// What takes more than a state and a map of it; null: nothing.
const char* beyond_state(const Case& c, const Jobs& jobs) {
  return jobs.optimize                      ? "an optimization"
         : jobs.validate || jobs.draw_edges ? "a validation"
         : jobs.grow                        ? "growth of cracks ([grow])"
         : !c.steps.empty()                 ? "a history of loads ([[step]])"
         : c.synthetic                      ? "a made up measurement ([synthetic])"
                                            : nullptr;
}

/// What is not solved on several processes.
void refuse_processes(const Case& c, const Jobs& jobs, const Processes* processes) {
  if (c.backend != Backend::Petsc) {
    if (jobs.optimize && has_starts_to_share(c)) return;
    if (processes && processes->count() > 1 && jobs.optimize)
      throw Error(
          Fault::Usage,
          fmt::format("mpiexec started {} processes, which share no more of an optimization than the starts of a "
                      "method by NLopt without readings: with such a method set optimize.starts to 2 or more, "
                      "else start kerf as one process",
                      processes->count()));
    if (processes && processes->count() > 1)
      throw Error(Fault::Usage, fmt::format("mpiexec started {} processes, and backend = \"{}\" uses one; set "
                                            "solver.backend = \"petsc\", or start kerf without mpiexec",
                                            processes->count(), backend_words[static_cast<std::size_t>(c.backend)]));
    return;
  }
  const std::string place = place_of(c, "solver.backend");
  if (!processes)
    throw Error(Fault::Usage, place + ": backend = \"petsc\" is for the program kerf alone; use \"cholmod\"");
  require_edges_alone(c.element);
  const char* job = jobs.edges && !jobs.optimize ? "a map of edge cracks" : beyond_state(c, jobs);
  if (job)
    throw Error(Fault::Usage, fmt::format("{}: backend = \"petsc\" solves a state and what follows from it; {} is not "
                                          "solved on several processes yet: use \"cholmod\"",
                                          place, job));
}

/// Divided triangles are of the mesh of a state; what meshes the body anew would not have them.
void refuse_divided(const Case& c, const Jobs& jobs) {
  if (c.divisions == 0) return;
  const char* job = beyond_state(c, jobs);
  if (!job && jobs.map && c.map_request.bounds) job = "error bars of a map (map.bounds)";
  if (!job && c.bounds) job = "[bounds]";
  if (job)
    throw Error(Fault::Usage,
                fmt::format("{}: mesh.refine is for a state and a map of it; {} meshes the body anew: use "
                            "a smaller mesh.size",
                            place_of(c, "mesh.refine"), job));
}

void refuse_jobs(const Case& c, const Jobs& jobs) {
  refuse_divided(c, jobs);
  if (!c.steps.empty()) {
    refuse_steps(c);
    if (jobs.map || jobs.edges) refuse_with_steps(c, "a map ([map])");
    if (jobs.validate) refuse_with_steps(c, "a validation ([validate])");
    if (jobs.optimize) refuse_with_steps(c, "an optimization ([optimize])");
    if (jobs.grow) refuse_with_steps(c, "growth of cracks ([grow])");
  }
  refuse_remeshing(c, jobs);
  if (jobs.optimize) refuse_optimization(c);
  if (jobs.map || jobs.validate) refuse_orthotropic(c);
  if (jobs.edges && std::ranges::any_of(all_materials(c.scene), [](const Material& m) { return !isotropic(m); }))
    throw Error(Fault::Usage, place_of(c, "map.perturbation") + ": edge cracks are known in isotropic materials alone");
  const Element& e = c.element;
  if (jobs.map) refuse_map(e, c.map_request);
  if (jobs.validate) refuse_validation(e);
}

void prepare_folder(const RunOptions& options, const std::string& fingerprint) {
  const std::filesystem::path& folder = options.folder;
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot make the folder {}: {}", folder.string(), failed.message()));
  if (options.lock) options.lock->take(folder);
  if (options.resume) check_checkpoint(folder, fingerprint);
  remove_earlier_results(folder, options.resume);
}

/// The case with its overrides, from which the folder can be made again.
KeptCase kept_case(const Case& c, const std::string& command) {
  std::vector<std::string> head{fmt::format("{}{} read it", head_of_results, KERF_VERSION)};
  if (!command.empty()) head.push_back(command);
  return keep(c, head);
}

void write_kept(const KeptCase& kept, const std::filesystem::path& folder) {
  for (const auto& [name, bytes] : kept.files) write_file(folder, name, bytes);
  write_file(folder / "case.toml", kept.text);
}

// The steps, with what they add to the result. Sections are there as soon as they are known: what fails later leaves
// them.

void describe_mesh(const Mesh& mesh, Result& r) {
  r.triangles = static_cast<Index>(mesh.triangles.size());
  r.vertices = static_cast<Index>(mesh.points.size());
  r.mesh = quality(mesh);
}

Adapted solve_body(const Case& c, Journal& journal, Result& r) {
  const Body body = body_of(c);
  Adaptation how = adaptation(c, journal.options);
  if (!c.steps.empty()) {
    how.meshed = [&](const Mesh& mesh) { describe_mesh(mesh, r); };
    return solve_steps(c, how, journal, r.steps);
  }
  if (!c.adapt) {
    how.meshed = [&](const Mesh& mesh) {
      describe_mesh(mesh, r);
      journal.begin("assemble, factorize and solve");
    };
    return solve_once(body, how, journal);
  }
  const BoundsTask task{body, c.functional, c.map_request.perturbation, c.plane_strain};
  if (const auto& of = c.adapt->of)
    how.goal = [&](const Model& m, const State& s, const Indicator& own) {
      return goal_indicator(task, *of, m, s, own);
    };
  Adapted adapted = solve_refined(body, how, journal);
  describe_mesh(adapted.model.mesh, r);
  r.adapt = adapt_result(adapted.rounds, adapted.stopped);
  if (c.adapt->of) r.adapt->of = in_words(*c.adapt->of, c.shape, c.sizing.curved);
  return adapted;
}

Adapted solve_body_as_it_can(Case& c, Journal& journal, Result& r) {
  return as_it_can(c, [&] { return solve_body(c, journal, r); });
}

/// Whether each process has a part of the mesh, which none has as a whole.
bool is_in_parts(const Case& c, const Processes* processes) {
  return c.backend == Backend::Petsc && processes && processes->count() > 1;
}

Adapted solve_or_stop(Case& c, Journal& journal, Result& r) {
  Adapted adapted = solve_body_as_it_can(c, journal, r);
  if (!stop_requested()) return adapted;
  Findings found;  // between rounds: the last one is there
  const auto cracks = find_cracks(c, whole(c, adapted.model, adapted.state), true, found);
  write_state(adapted, plot_data(adapted.model, adapted.state, c.plane_strain), cracks, journal);
  throw Stopped{};
}

/// The body and its state, with what is measured of it, by one process.
RunState solve_alone(Case& c, Journal& journal, Result& r) {
  RunState solved{.adapted = solve_or_stop(c, journal, r), .data = {}, .found = {}};
  const Adapted& adapted = solved.adapted;
  Findings& found = solved.found;
  journal.begin("recover");
  found = find_state(c, whole(c, adapted.model, adapted.state, adapted.indicator), journal.seconds);
  journal.lap();
  if (const auto effort = solver_effort(adapted.model)) found.solver = solver_result(*effort);
  if (c.backend == Backend::Petsc)
    found.notes.emplace_back(
        "backend \"petsc\": one process, whose factor \"cholmod\" makes; mpiexec -n N kerf starts more");
  const bool seen = c.output.peaks || journal.vtk || journal.png || journal.html || journal.options.fields;
  solved.data = seen ? plot_data(adapted.model, adapted.state, c.plane_strain) : plot_corners(adapted.model);
  add_largest(c, adapted, solved.data, found, journal);
  return solved;
}

RunState solve_state(Case& c, bool with_map, Journal& journal, Result& r) {
  RunState solved =
      is_in_parts(c, journal.options.processes) ? solve_in_parts(c, with_map, journal, r) : solve_alone(c, journal, r);
  const Adapted& adapted = solved.adapted;
  tell_state(c, adapted.model, solved.found, journal, r);
  journal.seconds.recover += journal.lap();
  const auto alone = [&journal](Case& one, Result& unseen) { return solve_body_as_it_can(one, journal, unseen); };
  if (certified(adapted.state)) add_load_cases(c, adapted, alone, journal, r);
  journal.load_case = r.state->load_case;
  write_state(adapted, solved.data, r.cracks, journal);
  return solved;
}

Mapped map_alone(const MapTask& task, Analysis& analysis, const PlotData& data, const Shape& shape) {
  Alone comm;
  return find_map(task, analysis, data, singular_zones(*analysis.model, extent(shape)), comm);
}

Analysis evaluate_functional(const Case& c, RunState& solved, bool with_map, Journal& journal, Result& r) {
  const auto note = [&r](const std::vector<std::string>& notes) {
    r.state->notes.insert(r.state->notes.end(), notes.begin(), notes.end());
  };
  journal.begin(with_map ? "map" : "functional");
  const auto& together = solved.together;
  const Model& model = solved.adapted.model;
  if (with_map) require_supports(c.functional, model);
  Analysis analysis = together ? together->functional : analyze(c.functional, model, solved.adapted.state, !with_map);
  analysis.model = &model;
  r.functional = functional_result(c.functional, analysis);
  if (r.load_cases.size() > 1)
    note(
        {fmt::format("functional, map and validation are under load case \"{}\" alone; an optimization takes the "
                     "weighted sum over all load cases",
                     r.state->load_case)});
  note(notes_on(c.functional, analysis, c.shape, r.cracks));
  if (!c.mesh && !together)
    if (const std::string grows = note_on_growth(c.functional, body_of(c, solved.adapted), c.contact, analysis);
        !grows.empty())
      note({grows});
  if (!with_map) {
    journal.seconds.solve += journal.lap();
    return analysis;
  }
  const MapTask task = map_task(c);
  Mapped map = together ? std::move(solved.together->map) : map_alone(task, analysis, solved.data, c.shape);
  r.map = map.result;
  note(together ? together->limits : limits_of_map(task, analysis, map.result));
  note(bound_map(task, analysis, body_of(c, solved.adapted), map));
  r.map = map.result;
  if (journal.options.fields) journal.options.fields->map = map.full;
  if (journal.html) add_map(journal.arrays, task, map, solved.adapted.model, solved.data);
  journal.seconds.map = journal.lap();
  write_map(task, map, solved.adapted.model, solved.data, journal);
  return analysis;
}

/// By what the iterations are solved, and by what the design, and how much that matters for J; empty where it is the
/// same.
std::string note_on_elements(const Case& c, const Case& design, const OptimizeResult& found) {
  const Element &loop = c.optimize_element, &end = design.element;
  if (loop.name == end.name && loop.degree == end.degree && !design.sizing.curved) return {};
  const FinerDesign& finer = found.finer;
  const bool compared = std::isfinite(finer.objective) && found.objective != 0 && c.optimize->level_set.ersatz == 0;
  return fmt::format(
      "the iterations are solved with {} {} on straight edges, the design with {} {}{}{}", loop.name, loop.degree,
      end.name, end.degree, design.sizing.curved ? " on edges that follow its curves" : " on straight edges",
      compared ? fmt::format(": J is {:.6g} by the former, and {:.6g} ({:+.2g} %) with {} {} on {} edges "
                             "and a mesh of size {:.3g}",
                             found.objective, finer.objective, 100 * (finer.objective / found.objective - 1),
                             finer.element.name, finer.element.degree, finer.curved ? "curved" : "straight", finer.size)
               : std::string());
}

Case optimize_design(const Case& c, Journal& journal, Result& r) {
  OptimizeSection found = optimize_body(optimize_task(c, journal.options), journal);
  if (!found.result.feasible) {
    r.status = "infeasible";
    r.reason = "the design violates a constraint: " + found.result.stopped.substr(found.result.stopped.find(' ') + 1);
  }
  Case design = designed(c, found.result);
  if (std::string words = note_on_elements(c, design, found.result); !words.empty())
    found.result.notes.push_back(std::move(words));
  write_design_files(journal, c, found.result);
  journal.writer->finish();  // gmsh gets a child of this process, which is made while no other thread is at work
  try {
    if (has_gmsh())
      journal.later(
          [path = journal.file("design.step"), bytes = step_file(found.result.shape)] { write_file(path, bytes); });
  } catch (const Error& e) {  // the design is not lost with it
    found.result.notes.push_back(e.what());
  }
  r.optimize = std::move(found.result);
  r.optimize_names = std::move(found.names);
  r.identified = std::move(found.identified);
  r.counted = std::move(found.counted);
  r.fit = std::move(found.fit);
  return design;
}

void write_design_mesh(const Journal& journal, const Mesh& mesh, const Shape& shape) {
  journal.later([path = journal.file("design.msh"), mesh, shape] { write_mesh(path, mesh, shape); });
}

/// After a state, a map or a validation of the given body the design is drawn alone: the last design_NNNN.vtu has its
/// state.
void draw_design(const Case& design, Journal& journal, Result& r) {
  r.optimize->notes.push_back("state, map and validation are of the body before the optimization");
  journal.begin("draw the design");
  const Body body = body_of(design);
  const Mesh mesh = triangulate(body.shape, body.sizing);
  write_design_mesh(journal, mesh, design.shape);
  journal.picture("design.png", [&] { return picture_of(design, mesh); });
  journal.seconds.output += journal.lap();
}

/// The state of the optimal design; J is what the optimization says, over all load cases.
RunState solve_design(Case& design, Journal& journal, Result& r) {
  RunState solved = solve_state(design, false, journal, r);
  write_design_mesh(journal, solved.adapted.model.mesh, design.shape);
  journal.picture("design.png", [&] { return picture_of(design, solved.adapted.model.mesh); });
  r.functional = {design.functional.kind, r.optimize->objective};
  journal.seconds.output += journal.lap();
  return solved;
}

void sum_up(Journal& journal, Result& r) {
  journal.seconds.total += journal.since_start.lap();
  r.seconds = journal.seconds;
  r.peak_memory_mb = peak_memory_mb();
}

/// Nothing further can be had. What there is goes to disk.
void fail(const Error& e, Journal& journal, Result& r) {
  journal.writer->finish();
  r.status = "failed";
  r.reason = e.what();
  sum_up(journal, r);
  write_json(journal.file("result.json"), r);
}

/// The body that the state of a run belongs to. It stays where it is: the analysis points to the state.
struct Outcome {
  Case c;
  RunState solved;
  std::optional<Analysis> analysis = {};
};

/// The stress is recovered once.
void inspect_body(const Outcome& out, bool draw, Journal& journal, Result& r) {
  const Adapted& adapted = out.solved.adapted;
  journal.begin("edge cracks");
  const auto state = inspect::recover_state(adapted.model, adapted.state);
  r.edge_cracks = inspect_edges(out.c, *state, journal);
  if (draw)
    draw_edge_cracks(out.c, *state, adapted.sizing, adaptation(out.c, journal.options), journal, *r.edge_cracks);
}

/// What the case asks for beside an optimization, then that. What cannot be had after the state leaves it, and a result
/// that says so.
std::unique_ptr<Outcome> perform(const Case& given, const Jobs& jobs, Journal& journal, Result& r) {
  Case c = given;
  c.scene = loaded_scene(given);
  std::unique_ptr<Outcome> out;
  try {
    if (!jobs.optimize || jobs.map || jobs.validate || jobs.grow || jobs.edges) {
      RunState solved = solve_state(c, jobs.map, journal, r);
      out = std::make_unique<Outcome>(Outcome{std::move(c), std::move(solved)});
    }
  } catch (const Error& e) {
    if (e.fault == Fault::Numerics) fail(e, journal, r);
    throw;
  }
  try {
    // Nothing is built on a state that is none: `complete` says so.
    const bool sound = !out || certified(out->solved.adapted.state);
    if (out) out->analysis = evaluate_functional(out->c, out->solved, jobs.map && sound, journal, r);
    if (jobs.edges && sound) inspect_body(*out, jobs.draw_edges, journal, r);
    if (jobs.validate && sound) r.validate = validate_expansion(out->c, body_of(out->c, out->solved.adapted), journal);
    if (jobs.grow && sound) r.growth = grow_cracks(out->c, adaptation(out->c, journal.options), journal);
    if (jobs.optimize && sound) {
      Case design = optimize_design(given, journal, r);
      if (out) {
        draw_design(design, journal, r);
      } else {
        RunState solved = solve_design(design, journal, r);
        out = std::make_unique<Outcome>(Outcome{std::move(design), std::move(solved)});
      }
    }
  } catch (const Error& e) {
    if (e.fault != Fault::Numerics || stop_requested()) throw;
    if (!out) fail(e, journal, r);
    if (!out) throw;
    r.status = "failed";
    r.reason = e.what();
    journal.lap();
  }
  return out;
}

/// What [bounds] and mesh.adapt ask for.
std::optional<BoundsRequest> bounds_asked(const Case& c) {
  std::optional<BoundsRequest> asked = c.bounds;
  if (!c.adapt || !c.adapt->of) return asked;
  const GoalRequest& goal = *c.adapt->of;
  if (!asked) asked = BoundsRequest{.tips = goal.crack != none};
  if (goal.crack == none && goal.quantity != "energy" && std::ranges::count(asked->points, goal.at) == 0)
    asked->points.push_back(goal.at);
  const bool some = asked->tips || asked->compliance || !asked->points.empty() || !asked->discs.empty() ||
                    !asked->lines.empty() || !asked->displacements.empty() || !asked->reactions.empty();
  return some ? asked : std::nullopt;
}

/// The intervals that the case asks for.
void bound(const Outcome& out, const BoundsRequest& asked, Journal& journal, Result& r) {
  journal.begin("bound quantities");
  const Body body = body_of(out.c, out.solved.adapted);
  r.bounds = bound_quantities({body, out.c.functional, out.c.map_request.perturbation, out.c.plane_strain}, asked,
                              out.solved.adapted, journal.options.threads);
  write_bounds_files(journal, *r.bounds);
  journal.seconds.bounds += journal.lap();
}

/// The stresses at the points of probes that ask for their bounds; of others none.
std::vector<std::vector<BoundedStress>> bound_probes(const Outcome& out, Journal& journal) {
  std::vector<std::vector<BoundedStress>> all(out.c.probes.size());
  const bool any = std::ranges::any_of(out.c.probes, &Probe::bounds);
  if (!any || !certified(out.solved.adapted.state)) return all;
  journal.begin("bound the stresses of probes");
  const Body body = body_of(out.c, out.solved.adapted);
  const BoundsTask task{body, out.c.functional, out.c.map_request.perturbation, out.c.plane_strain};
  const QuantityBounds bounds(out.solved.adapted.model, out.solved.adapted.state);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (const Probe& probe = out.c.probes[i]; probe.bounds)
      all[i] = bound_stresses(task, out.solved.adapted.model, probe.points, bounds);
  journal.seconds.bounds += journal.lap();
  return all;
}

/// Cracks in the order of their tables, behind them those of interfaces by their names. The shape has them from left to
/// right, so that the mesh does not depend on that order.
void list_as_in_case(const Case& c, std::vector<CrackResult>& cracks) {
  const auto place = [&](const CrackResult& crack) { return std::ranges::find(c.crack_names, crack.name); };
  std::ranges::stable_sort(cracks, {}, place);
}

/// result.json and the page of what there is.
void end(const Case& c, const Adapted& adapted, const PlotData& data, Journal& journal, Result& r) {
  list_as_in_case(c, r.cracks);
  if (!journal.missing.empty()) r.state->notes.push_back(journal.missing);
  journal.writer->finish();
  journal.seconds.output += journal.lap();
  sum_up(journal, r);
  // Before the page: a disk may be full.
  write_json(journal.file("result.json"), r, journal.html ? Flush::Buffers : Flush::Disk);
  if (!journal.html) return;
  add_state(journal.arrays, adapted, data, design_picture(c.title, adapted.model.mesh, c.scene, {}, extent(c.shape)));
  thin(journal.arrays, most_triangles);
  write_arrays(journal.file("report.bin"), journal.arrays);
  write_report(journal.options.folder);
  journal.seconds.output += journal.lap();
  sum_up(journal, r);
  write_json(journal.file("result.json"), r, Flush::Disk);
}

/// Reads values off the solution; its factor goes.
ReadPoints reader_of(std::unique_ptr<Outcome> out, bool mapped) {
  drop_factor(out->solved.adapted.model);
  const auto locator = std::make_shared<const Locator>(make_locator(out->solved.adapted.model.mesh));
  return [out = std::shared_ptr<const Outcome>(std::move(out)), locator, mapped](std::span<const Vec2> points) {
    const MapTask task = map_task(out->c);
    const Adapted& adapted = out->solved.adapted;
    return values_at({adapted.model, adapted.state, out->c.plane_strain, *locator}, mapped ? &*out->analysis : nullptr,
                     task, points);
  };
}

/// The jobs and their files.
Result complete(const Case& read, const Jobs& jobs, Journal& journal) {
  Result r{.version = KERF_VERSION, .case_name = read.name, .title = read.title, .units = read.units};
  r.functional_dimension = dimension_of(read.functional);
  Case given = read;
  if (read.synthetic) {
    journal.begin("make up the measurements");
    given = with_data(std::move(given), journal.options);
  }
  journal.seconds.solve += journal.lap();
  std::unique_ptr<Outcome> out = perform(given, jobs, journal, r);

  const Case& c = out->c;
  const Adapted& adapted = out->solved.adapted;
  if (const auto asked = bounds_asked(c); asked && certified(adapted.state)) bound(*out, *asked, journal, r);
  const std::vector<std::vector<BoundedStress>> bounded = bound_probes(*out, journal);
  journal.begin("write");
  const Locator locator = c.probes.empty() && !c.map ? Locator() : make_locator(adapted.model.mesh);
  for (std::string& note : notes_on_points(c, adapted.model.mesh, locator, r.map.has_value()))
    r.state->notes.push_back(std::move(note));
  const Analysis* mapped = r.map && out->analysis ? &*out->analysis : nullptr;
  const auto& together = out->solved.together;
  const auto rows =
      together ? together->probes : find_probes(c, whole(c, adapted.model, adapted.state), map_task(c), mapped);
  for (std::size_t i = 0; i < c.probes.size(); ++i) write_probe_file(journal, c.probes[i], rows[i], bounded[i]);
  if (!certified(adapted.state)) {
    r.status = "not converged";
    r.reason = failure(adapted.model, adapted.state);
    if (together && c.precision == FactorPrecision::Single)
      *r.reason += "; factors in double precision may serve (solver.precision)";
  }
  if (RunFields* const fields = journal.options.fields) {
    fields->mesh = adapted.model.mesh;
    fields->state = out->solved.data;
    fields->indicator = adapted.indicator.eta;
  }
  end(c, adapted, out->solved.data, journal, r);
  if (journal.options.fields && !together) journal.options.fields->at = reader_of(std::move(out), mapped != nullptr);
  return r;
}

}  // namespace

Job job_called(std::string_view command) {
  return command == "solve"      ? Job::Solve
         : command == "map"      ? Job::Map
         : command == "validate" ? Job::Validate
         : command == "optimize" ? Job::Optimize
         : command == "grow"     ? Job::Grow
                                 : Job::Run;
}

Result run(const Case& read, Job job, const RunOptions& options) {
  const Jobs jobs = jobs_of(read, job);
  if (options.resume && !jobs.optimize && !jobs.grow)
    throw Error(Fault::Usage, "there is nothing to resume: the case has no table [optimize] and no table [grow]");
  refuse_jobs(read, jobs);
  refuse_processes(read, jobs, options.processes);
  const KeptCase kept = kept_case(read, options.command);  // of files that may be results of the run before
  prepare_folder(options, read.fingerprint);
  write_kept(kept, options.folder);
  Journal journal{.options = options,
                  .title = read.title,
                  .units = read.units,
                  .vtk = read.output.vtk,
                  .png = read.output.png,
                  .html = read.output.html};
  if (journal.vtk) try {
      require_vtk();
    } catch (const Error& e) {
      if (read.places.contains("output.vtk")) throw;  // asked for by name
      journal.vtk = false;
      journal.missing = fmt::format("no files for ParaView: {}", e.what());
    }
  try {
    return complete(read, jobs, journal);
  } catch (const Stopped&) {
    journal.writer->finish();
    throw Error(Fault::Numerics, fmt::format("stopped in \"{}\"; what was done before is in {}{}", journal.phase,
                                             options.folder.string(),
                                             has_checkpoint(options.folder) ? "; --resume goes on from there" : ""));
  } catch (...) {
    journal.writer->finish();  // what could not be written came before
    throw;
  }
}

}  // namespace kerf
