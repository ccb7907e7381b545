#include "app/run.hpp"
#include "plot/charts.hpp"
#include "plot/page.hpp"
#include "solver/system.hpp"

#include "app/files.hpp"
#include "app/optimize.hpp"
#include "io/history.hpp"
#include "io/validation.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "solver/error_bars.hpp"
#include "solver/saddle_point.hpp"
#include "solver/stopwatch.hpp"

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

void describe_mesh(const Mesh& mesh, Result& r) {
  r.triangles = static_cast<Index>(mesh.triangles.size());
  r.vertices = static_cast<Index>(mesh.points.size());
  r.mesh = quality(mesh);
}

using Begin = std::function<void(const std::string& phase)>;

Adapted solve_once(const Case& c, const RunOptions& options, const Begin& begin, Result& r) {
  begin("mesh");
  Stopwatch watch;
  Mesh mesh = triangulate(c.shape, c.sizing);
  describe_mesh(mesh, r);
  r.seconds.mesh += watch.lap();
  begin("assemble and factorize");
  Model model = prepare(std::move(mesh), c.element, c.scene, options.threads);
  r.seconds.assemble += model.seconds.assemble;
  r.seconds.factor += model.seconds.factor;
  begin("solve");
  watch.lap();
  State state = c.backend == Backend::Umfpack ? solve_extended(model) : solve(model, c.contact);
  Indicator indicator = error_indicator(model, state);
  r.seconds.solve += watch.lap() - state.seconds.contact;
  r.seconds.contact += state.seconds.contact;
  return {std::move(model), std::move(state), std::move(indicator), {}, {}};
}

Adapted solve_refined(const Case& c, const RunOptions& options, const Begin& begin, Result& r) {
  begin("solve and refine");
  const Adaptation wanted{.error = c.adapt->error,
                          .max_triangles = c.adapt->max_triangles,
                          .contact = c.contact,
                          .saddle_point = c.backend == Backend::Umfpack,
                          .threads = options.threads};
  int number = 0;
  const auto report = [&](const Round& round) {
    begin(fmt::format("refine: round {}, {} triangles, estimated error {:.3g}", ++number, round.triangles,
                      round.estimated_error));
    return true;
  };
  Adapted adapted = solve_adaptively(c.shape, c.sizing, c.element, c.scene, wanted, report);
  describe_mesh(adapted.model.mesh, r);
  r.adapt.emplace();
  r.adapt->stopped = adapted.stopped;
  for (const Round& round : adapted.rounds) {
    r.seconds.mesh += round.mesh;
    r.seconds.assemble += round.assemble;
    r.seconds.factor += round.factor;
    r.seconds.solve += round.solve - round.contact + round.estimate;
    r.seconds.contact += round.contact;
    r.adapt->rounds.emplace_back(round.triangles, round.estimated_error);
  }
  return adapted;
}

/// Faces that slide against friction do not minimize an energy: only the value of a functional is to be had.
void refuse_friction(const Case& c, const char* job, const char* table) {
  for (std::size_t k = 0; k < c.scene.laws.size(); ++k)
    if (has_friction(c.scene.laws[k]))
      throw Error(
          Fault::Usage,
          fmt::format("the {} needs cracks without friction: crack \"{}\" slides against it, and the state does not "
                      "minimize the energy; remove friction and tresca, or [{}] (kerf solve)",
                      job, c.shape.cracks[k].name, table));
}

/// The loops over variables say themselves what they need; cobyla needs no derivatives.
void refuse_optimization(const Case& c) {
  if (c.optimize->method != OptimizeMethod::LevelSet) return;
  refuse_friction(c, "level set", "optimize");
  for (const char* without : {"p1", "p2", "arnold-winther-c"})
    if (c.element.name == without)
      throw Error(Fault::Usage, fmt::format("the level set needs derivatives, which element \"{}\" does not have; use "
                                            "\"bdms\" (default), or \"afw\"",
                                            c.element.name));
}

/// What the element cannot do is refused before anything is solved.
void refuse_element(const Case& c, bool with_map, bool with_validation) {
  const Element& e = c.element;
  if (with_map && c.map_request.bounds && c.map_request.perturbation.kind != Perturbation::Kind::ClampedHole)
    better_element(e);
  const bool unseen = e.cut == Cut::LinearDivergence;  // some traces of its cubic edges are seen by no triangle
  if (with_validation && (!is_mixed(e) || per_vertex(e) > 0 || unseen))
    throw Error(
        Fault::Usage,
        fmt::format("validation condenses the body onto edges, which element \"{}\" does not allow; use \"bdms\" "
                    "(any degree), \"afw\" or \"arnold-winther-nc\"",
                    e.name));
}

void describe_failure(const Model& model, const State& state, Result& r) {
  r.status = "not converged";
  r.reason = !state.converged
                 ? "the contact set did not settle"
                 : fmt::format("the {} hold only to {:.2g} of the load",
                               r.contact ? "conditions of equilibrium and contact" : "equations of equilibrium",
                               state.certificate.kkt);
  if (!model.inner->skeleton.unseen.empty())
    *r.reason +=
        "; the traces of \"arnold-winther\" at vertices whose edges lie on two lines bear only loads that fit "
        "one symmetric stress there: use \"bdms\" with degree = 3";
}

// What a reader of the functional's value should know.
void note_on_functional(const Case& c, const Analysis& a, Result& r) {
  for (std::size_t i = 0; i < c.functional.terms.size(); ++i) {
    const Term& term = c.functional.terms[i];
    constexpr double integrable = 4;
    if (term.stress_power >= integrable && !c.shape.cracks.empty())
      r.state->notes.push_back(
          fmt::format("the stress to the power {:g} is not integrable at crack tips: unless its weight vanishes there, "
                      "the value of {} is that of this mesh",
                      term.stress_power, term.kind));
    if (term.kind != "energy_release_rate") continue;
    for (const CrackResult& crack : r.cracks)
      for (const TipResult& tip : crack.tips) {
        constexpr double same = 0.03;
        if (!tip.G || (tip.at - term.feature).norm() > 1e-9 * extent(c.shape)) continue;
        if (std::abs(a.term_value[i] - *tip.G) > same * std::abs(*tip.G))
          r.state->notes.push_back(fmt::format(
              "energy_release_rate is {:.4g}, the interaction integrals at that tip say {:.4g}: the ring has "
              "too few triangles (mesh.size), or holds more than the tip",
              a.term_value[i], *tip.G));
      }
  }
}

void describe_state(const Case& c, const Model& model, const State& state, const Indicator& indicator, Result& r) {
  r.state = state_result(model, state, indicator, energy_bounds(model, state));
  r.cracks = crack_results(model, state, c.shape);
  for (const CrackResult& crack : r.cracks)
    if (crack.penetration > 1e-6 * crack.max_opening && crack.penetration > 0)
      r.state->notes.push_back(
          fmt::format("the faces of crack \"{}\" (contact = \"open\") penetrate by up to {:.3g}; "
                      "contact = \"unilateral\" prevents it",
                      crack.name, crack.penetration));
  const bool contact = std::any_of(c.scene.laws.begin(), c.scene.laws.end(),
                                   [](const CrackLaw& law) { return law.kind == CrackLaw::Kind::Unilateral; });
  if (contact)
    r.contact = contact_result(state, c.backend == Backend::Umfpack ? ContactMethod::ActiveSet : c.contact, r.cracks);
}

/// A run so far.
struct Running {
  const RunOptions& options;
  Result r;
  std::vector<std::pair<std::string, std::filesystem::path>> pictures = {};
  Stopwatch whole = {}, watch = {};

  std::filesystem::path file(const std::string& name) const {
    return options.folder / name;
  }
  bool stop_asked() const {
    return options.stop_asked && options.stop_asked();
  }
  void begin(const std::string& phase) {
    if (stop_asked()) throw Error(Fault::Numerics, "stopped before " + phase);
    if (options.on_phase) options.on_phase(phase);
    watch.lap();
  }
  /// Takes the place of an earlier one of the same name.
  template <typename Drawing>
  void picture(const std::string& name, const std::string& caption, const Drawing& drawing) {
    draw(file(name), drawing);
    std::erase_if(pictures, [&](const auto& earlier) { return earlier.second == file(name); });
    pictures.emplace_back(caption, file(name));
  }
  void sum_up() {
    r.seconds.total += whole.lap();
    r.peak_memory_mb = peak_memory_mb();
  }
  /// Nothing further can be had. What there is goes to disk.
  void fail(const Error& e) {
    r.status = "failed";
    r.reason = e.what();
    sum_up();
    write_json(file("result.json"), r);
  }
};

struct Solved {
  Adapted adapted;
  PlotData data;
};

/// The state of a body with its files.
Solved solve_state(const Case& c, Running& p) {
  const Begin begin = [&p](const std::string& phase) { p.begin(phase); };
  Adapted adapted = c.adapt ? solve_refined(c, p.options, begin, p.r) : solve_once(c, p.options, begin, p.r);
  p.begin("recover");
  describe_state(c, adapted.model, adapted.state, adapted.indicator, p.r);
  PlotData data = plot_data(adapted.model, adapted.state, c.plane_strain);
  p.r.seconds.solve += p.watch.lap();
  p.begin("write the state");
  write_state_files(p.options.folder, c, adapted.model, adapted.state, adapted.indicator, data, p.r.cracks);
  if (c.output.png) {
    p.picture("mesh.png", "Mesh", mesh_picture(c, adapted.model));
    p.picture("von_mises.png", "Von Mises stress", stress_picture(c, adapted.model, data));
  }
  p.r.seconds.output += p.watch.lap();
  return {std::move(adapted), std::move(data)};
}

/// The value of the functional, and its map.
Analysis evaluate(const Case& c, const Solved& solved, bool with_map, Running& p) {
  const Model& model = solved.adapted.model;
  p.begin(with_map ? "map" : "functional");
  if (with_map) require_supports(c.functional, model);
  Analysis analysis = analyze(c.functional, model, solved.adapted.state, !with_map);
  p.r.functional = functional_result(c.functional, analysis);
  note_on_functional(c, analysis, p.r);
  if (!with_map) {
    p.r.seconds.solve += p.watch.lap();
    return analysis;
  }
  const PlotData& data = solved.data;
  const bool clamped = c.map_request.perturbation.kind == Perturbation::Kind::ClampedHole;
  if (!clamped) analysis.fields = recover_fields(analysis, data.corners);
  FullMap full = map_everywhere(analysis, c.functional, c.map_request, data.corners);
  p.r.map = map_result(c, analysis, full);
  if (c.map_request.bounds && clamped)
    p.r.state->notes.push_back("there are no bounds for maps of clamped holes");
  else if (c.map_request.bounds)
    add_bars(analysis, c.functional, c.map_request, c.shape, c.sizing, full, p.r.map->points);
  p.r.seconds.map = p.watch.lap();
  p.begin("write the map");
  write_map_files(p.options.folder, c, *p.r.map, model.mesh, data, full);
  if (c.output.png) p.picture("map.png", "Topological derivative", map_picture(c, model, data, full));
  p.r.seconds.output += p.watch.lap();
  return analysis;
}

void validate_expansion(const Case& c, Running& p) {
  p.begin("validate");
  ValidationRequest request = *c.validate;
  request.threads = p.options.threads;
  const Element& e = c.element;
  p.r.validate = {word(request.perturbation.kind), validate(c.shape, c.sizing, e, c.scene, c.functional, request)};
  p.r.seconds.validate = p.watch.lap();
  p.begin("write the validation");
  write_validation_csv(p.file("validate.csv"), *p.r.validate);
  if (c.output.png)
    p.picture("validate.png", "Validation: what the prediction leaves of the difference",
              validation_chart(*p.r.validate, c.title));
  p.r.seconds.output += p.watch.lap();
}

/// The design that [optimize] finds. Asked to stop it leaves its files, its pictures and a checkpoint.
Case optimize_shape(const Case& c, Running& p) {
  p.begin("optimize");
  Optimized found = optimize(c, p.options);
  p.r.seconds.optimize = p.watch.lap() - found.output;
  p.r.seconds.output += found.output;
  if (c.output.png) {
    p.picture("evolution.png", "Evolution of the design", Evolution{c.title, sentence(found.result), found.snapshots});
    p.picture("history.png", "Objective and volume", history_curves(found.result, found.names, c.title));
  }
  p.r.seconds.output += p.watch.lap();
  if (found.stopped)
    throw Error(Fault::Numerics, fmt::format("stopped after iteration {}; --resume goes on from there",
                                             found.result.history.empty() ? 0 : found.result.history.back().number));
  if (!found.result.feasible) {
    p.r.status = "infeasible";
    p.r.reason = "the design violates a constraint: " + found.result.stopped;
  }
  Case design = designed(c, found.result);
  p.r.optimize = std::move(found.result);
  p.r.optimize_names = std::move(found.names);
  p.r.identified = std::move(found.identified);
  return design;
}

/// After a state, a map or a validation of the given body the design is drawn alone: the last design_NNNN.vtu has its
/// state.
void draw_design(const Case& design, Running& p) {
  p.r.optimize->notes.push_back("state, map and validation are of the body before the optimization");
  if (!design.output.png) return;
  p.begin("draw the design");
  const Model model = prepare(triangulate(design.shape, design.sizing), design.element, design.scene, p.options.threads,
                              {.factorize = false});
  p.picture("design.png", "The design", design_picture(design, model));
  std::rotate(p.pictures.begin(), p.pictures.end() - 1, p.pictures.end());
  p.r.seconds.output += p.watch.lap();
}

/// The state of the optimal design; J is what the optimization says, over all load cases.
Solved solve_design(const Case& design, Running& p) {
  Solved solved = solve_state(design, p);
  if (design.output.png) p.picture("design.png", "The design", design_picture(design, solved.adapted.model));
  std::rotate(p.pictures.begin(), p.pictures.end() - (design.output.png ? 1 : 0), p.pictures.end());
  p.r.functional = {design.functional.kind, p.r.optimize->objective};
  p.r.seconds.output += p.watch.lap();
  return solved;
}

}  // namespace

Result run(const Case& read, Job job, const RunOptions& options) {
  const bool with_map = job == Job::Map || (job == Job::Run && read.map);
  const bool with_validation = job == Job::Validate || (job == Job::Run && read.validate);
  const bool with_optimization = job == Job::Optimize || (job == Job::Run && read.optimize);
  if (with_validation && !read.validate)
    throw Error(Fault::Usage, "the case has no table [validate]; add it with points and radii");
  if (with_optimization && !read.optimize)
    throw Error(Fault::Usage, "the case has no table [optimize]; add it with method and volume");
  if (options.resume && !with_optimization)
    throw Error(Fault::Usage, "there is nothing to resume: the case has no table [optimize]");
  if (with_map) refuse_friction(read, "map", "map");
  if (with_validation) refuse_friction(read, "validation", "validate");
  if (with_optimization) refuse_optimization(read);
  refuse_element(read, with_map, with_validation);
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot make the folder {}: {}", options.folder.string(), failed.message()));
  if (options.resume) check_checkpoint(options.folder, read);
  remove_earlier_results(options.folder, options.resume);
  if (read.output.vtk) require_vtk();

  Running p{.options = options};
  p.r.version = KERF_VERSION;
  p.r.case_name = read.name;
  p.r.title = read.title;
  if (read.synthetic) p.begin("make up the measurements");
  const Case given = with_data(read, options);
  p.r.seconds.solve += p.watch.lap();
  Case c = given;
  c.scene = loaded_scene(given);

  const bool before = !with_optimization || with_map || with_validation;
  std::optional<Solved> solved;
  std::optional<Analysis> analysis;
  try {
    if (before) solved.emplace(solve_state(c, p));
  } catch (const Error& e) {
    if (e.fault == Fault::Numerics && !p.stop_asked()) p.fail(e);
    throw;
  }
  // What cannot be had from here on leaves the state and everything before it.
  try {
    if (before) analysis.emplace(evaluate(c, *solved, with_map, p));
    if (with_validation) validate_expansion(c, p);
    if (with_optimization) {
      Case design = optimize_shape(given, p);
      if (before) {
        draw_design(design, p);
      } else {
        solved.emplace(solve_design(design, p));
        c = std::move(design);
      }
    }
  } catch (const Error& e) {
    if (e.fault != Fault::Numerics || p.stop_asked()) throw;
    if (!solved) p.fail(e);
    if (!solved) throw;
    p.r.status = "failed";
    p.r.reason = e.what();
    p.watch.lap();
  }

  p.begin("write");
  const Model& model = solved->adapted.model;
  write_probe_files(options.folder, c, model, solved->adapted.state, p.r.map && analysis ? &*analysis : nullptr);
  if (!certified(solved->adapted.state)) describe_failure(model, solved->adapted.state, p.r);
  p.r.seconds.output += p.watch.lap();
  p.sum_up();
  if (c.output.html) write_page(p.file("report.html"), p.r, p.pictures);
  write_json(p.file("result.json"), p.r);
  return p.r;
}

}  // namespace kerf
