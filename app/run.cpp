#include "app/run.hpp"

#include "app/files.hpp"
#include "report/validation.hpp"
#include "solver/adaptive.hpp"
#include "solver/bounds.hpp"
#include "solver/extended.hpp"
#include "solver/spread.hpp"
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

ContactMethod contact_method(const Case& c) {
  return c.contact == "uzawa"        ? ContactMethod::Uzawa
         : c.contact == "active-set" ? ContactMethod::ActiveSet
                                     : ContactMethod::DualQp;
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
  r.seconds.mesh = watch.lap();
  begin("assemble and factorise");
  Model model = prepare(std::move(mesh), element(c.element, c.degree), c.scene, options.threads);
  r.seconds.assemble = model.seconds.assemble;
  r.seconds.factor = model.seconds.factor;
  begin("solve");
  watch.lap();
  State state = c.backend == "umfpack" ? solve_extended(model) : solve(model, contact_method(c));
  Indicator indicator = error_indicator(model, state);
  r.seconds.solve = watch.lap() - state.seconds.contact;
  r.seconds.contact = state.seconds.contact;
  return {std::move(model), std::move(state), std::move(indicator), {}, {}};
}

Adapted solve_refined(const Case& c, const RunOptions& options, const Begin& begin, Result& r) {
  begin("solve and refine");
  const Adaptation wanted{.error = c.adapt->error,
                          .max_triangles = c.adapt->max_triangles,
                          .contact = contact_method(c),
                          .saddle_point = c.backend == "umfpack",
                          .threads = options.threads};
  int number = 0;
  const auto report = [&](const Round& round) {
    begin(fmt::format("refine: round {}, {} triangles, estimated error {:.3g}", ++number, round.triangles,
                      round.estimated_error));
    return true;
  };
  Adapted adapted = solve_adaptively(c.shape, c.sizing, element(c.element, c.degree), c.scene, wanted, report);
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

/// Faces that slide against friction do not minimise an energy: only the value of a functional is to be had.
void refuse_friction(const Case& c, const char* job, const char* table) {
  for (std::size_t k = 0; k < c.scene.laws.size(); ++k)
    if (has_friction(c.scene.laws[k]))
      throw Error(
          Fault::Usage,
          fmt::format("the {} needs cracks without friction: crack \"{}\" slides against it, and the state does not "
                      "minimise the energy; remove friction and tresca, or [{}] (kerf solve)",
                      job, c.shape.cracks[k].name, table));
}

/// What the element cannot do is refused before anything is solved.
void refuse_element(const Case& c, bool with_map, bool with_validation) {
  const Element& e = element(c.element, c.degree);
  if (with_map && c.map_request.bounds && c.map_request.perturbation.kind != Perturbation::Kind::ClampedHole)
    better_element(e);
  const bool unseen = e.cut == Cut::LinearDivergence;  // some traces of its cubic edges are seen by no triangle
  if (with_validation && (!is_mixed(e) || per_vertex(e) > 0 || unseen))
    throw Error(
        Fault::Usage,
        fmt::format("validation condenses the body onto edges, which element \"{}\" does not allow; use \"bdms\" "
                    "(any degree), \"afw\" or \"arnold-winther-nc\"",
                    c.element));
}

void describe_failure(const Model& model, const State& state, Result& r) {
  r.status = "not converged";
  r.reason = !state.converged
                 ? "the contact set did not settle"
                 : fmt::format("the {} hold only to {:.2g} of the load",
                               r.contact ? "conditions of equilibrium and contact" : "equations of equilibrium",
                               state.certificate.kkt);
  if (!model.skeleton.unseen.empty())
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
  if (contact) r.contact = contact_result(state, c.backend == "umfpack" ? "active-set" : c.contact, r.cracks);
}

}  // namespace

Result run(const Case& c, Job job, const RunOptions& options) {
  Stopwatch whole, watch;
  const auto begin = [&](const std::string& phase) {
    if (options.stop_asked && options.stop_asked()) throw Error(Fault::Numerics, "stopped before " + phase);
    if (options.on_phase) options.on_phase(phase);
    watch.lap();
  };
  const bool with_map = job == Job::Map || (job == Job::Run && c.map);
  const bool with_validation = job == Job::Validate || (job == Job::Run && c.validate);
  if (with_validation && !c.validate)
    throw Error(Fault::Usage, "the case has no table [validate]; add it with points and radii");
  if (with_map) refuse_friction(c, "map", "map");
  if (with_validation) refuse_friction(c, "validation", "validate");
  refuse_element(c, with_map, with_validation);
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot make the folder {}: {}", options.folder.string(), failed.message()));
  remove_earlier_results(options.folder);
  if (c.output.vtk) require_vtk();
  const auto file = [&](const std::string& name) { return options.folder / name; };

  Result r;
  r.version = KERF_VERSION;
  r.case_name = c.name;
  r.title = c.title;

  const auto sum_up = [&] {
    r.seconds.total = whole.lap();
    r.peak_memory_mb = peak_memory_mb();
  };
  std::optional<Adapted> solved;
  try {
    solved.emplace(c.adapt ? solve_refined(c, options, begin, r) : solve_once(c, options, begin, r));
  } catch (const Error& e) {
    const bool stopped = options.stop_asked && options.stop_asked();
    if (e.fault == Fault::Numerics && !stopped) {
      r.status = "failed";
      r.reason = e.what();
      sum_up();
      write_json(file("result.json"), r);
    }
    throw;
  }
  const Model& model = solved->model;
  const State& state = solved->state;
  const Indicator& indicator = solved->indicator;

  begin("recover");
  describe_state(c, model, state, indicator, r);
  const PlotData data = plot_data(model, state, c.plane_strain);
  r.seconds.solve += watch.lap();

  std::vector<std::pair<std::string, std::filesystem::path>> pictures;
  const auto picture = [&](const std::string& name, const std::string& caption, const auto& p) {
    draw(file(name), p);
    pictures.emplace_back(caption, file(name));
  };
  begin("write the state");
  write_state_files(options.folder, c, model, state, indicator, data, r.cracks);
  if (c.output.png) {
    picture("mesh.png", "Mesh", mesh_picture(c, model));
    picture("von_mises.png", "Von Mises stress", stress_picture(c, model, data));
  }
  r.seconds.output += watch.lap();

  // What cannot be had from here on leaves the state and everything before it.
  std::optional<Analysis> analysis;
  try {
    begin(with_map ? "map" : "functional");
    if (with_map) require_supports(c.functional, model);
    analysis = analyse(c.functional, model, state, !with_map);
    r.functional = functional_result(c.functional, *analysis);
    note_on_functional(c, *analysis, r);
    if (with_map) {
      if (c.map_request.perturbation.kind != Perturbation::Kind::ClampedHole)
        analysis->fields = recover_fields(*analysis, data.corners);
      FullMap full = map_everywhere(*analysis, c.functional, c.map_request, data.corners);
      r.map = map_result(c, *analysis, full);
      if (c.map_request.bounds) {
        if (c.map_request.perturbation.kind == Perturbation::Kind::ClampedHole)
          r.state->notes.push_back("there are no bounds for maps of clamped holes");
        else
          add_bars(*analysis, c.functional, c.map_request, c.shape, c.sizing, full, r.map->points);
      }
      r.seconds.map = watch.lap();
      begin("write the map");
      write_map_files(options.folder, c, *r.map, model.mesh, data, full);
      if (c.output.png) picture("map.png", "Topological derivative", map_picture(c, model, data, full));
      r.seconds.output += watch.lap();
    } else {
      r.seconds.solve += watch.lap();
    }
    if (with_validation) {
      begin("validate");
      ValidationRequest request = *c.validate;
      request.threads = options.threads;
      const Element& e = element(c.element, c.degree);
      r.validate = {word(request.perturbation.kind), validate(c.shape, c.sizing, e, c.scene, c.functional, request)};
      r.seconds.validate = watch.lap();
      begin("write the validation");
      write_validation_csv(file("validate.csv"), *r.validate);
      if (c.output.png)
        picture("validate.png", "Validation: what the prediction leaves of the difference",
                validation_chart(*r.validate, c.title));
      r.seconds.output += watch.lap();
    }
  } catch (const Error& e) {
    const bool stopped = options.stop_asked && options.stop_asked();
    if (e.fault != Fault::Numerics || stopped) throw;
    r.status = "failed";
    r.reason = e.what();
    watch.lap();
  }

  begin("write");
  write_probe_files(options.folder, c, model, state, r.map ? &*analysis : nullptr);
  if (!certified(state)) describe_failure(model, state, r);
  r.seconds.output += watch.lap();
  sum_up();
  if (c.output.html) write_page(file("report.html"), r, pictures);
  write_json(file("result.json"), r);
  return r;
}

}  // namespace kerf
