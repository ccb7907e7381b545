#include "app/run.hpp"

#include "app/collect.hpp"
#include "solver/adaptive.hpp"
#include "solver/bounds.hpp"
#include "solver/extended.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <limits>

namespace kerf {

namespace {

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::vector<std::vector<double>> probe_rows(const Model& model, const State& state, const Probe& probe, bool with_map) {
  const std::vector<Index> where = locate(model.mesh, probe.points);
  const std::vector<double> map =
      with_map ? energy_map(model, state, probe.points)
               : std::vector<double>(probe.points.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < probe.points.size(); ++i) {
    const Vec2& x = probe.points[i];
    std::vector<double> row(8, std::numeric_limits<double>::quiet_NaN());  // an empty cell: outside the body
    row[0] = x.x(), row[1] = x.y();
    if (where[i] != none) {
      const Vec2 u = recovered_displacement(model, state, where[i], x).col(0);
      const Eigen::Vector4d s = stress_at(model.kernel, triangle(model, where[i]), state.interior.col(where[i]), x);
      row = {x.x(), x.y(), u.x(), u.y(), s[0], s[3], 0.5 * (s[1] + s[2]), map[i]};
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

MapResult map_result(const Model& model, const State& state, const Case& c, const FullMap& full) {
  MapResult r{.perturbation = "hole"};
  const std::vector<Vec2> singular = singular_points(model);
  constexpr double share = 0.02;  // of the body's extent
  r.excluded_radius = singular.empty() ? 0 : share * extent(c.shape);
  const Extrema e = extrema(model, full.at_centroids, singular, r.excluded_radius);
  r.min = e.min;
  r.max = e.max;
  if (c.map) {
    const std::vector<double> values = energy_map(model, state, c.map->points);
    for (std::size_t i = 0; i < values.size(); ++i) r.points.push_back({.at = c.map->points[i], .value = values[i]});
  }
  return r;
}

std::vector<std::vector<double>> map_rows(const MapResult& r, const PlotData& data, const FullMap& full) {
  std::vector<std::vector<double>> rows;
  for (const MapPoint& p : r.points) rows.push_back({p.at.x(), p.at.y(), p.value});
  if (r.points.empty())
    for (std::size_t i = 0; i < data.points.size(); ++i)
      rows.push_back({data.points[i].x(), data.points[i].y(), full.at_corners[static_cast<Eigen::Index>(i)]});
  return rows;
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

// What an earlier run left under the names of the interface: a stale map beside a new state would mislead.
void remove_earlier_results(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string(), type = entry.path().extension().string();
    const bool numbered = (name.starts_with("crack_") && (type == ".csv" || type == ".vtp")) ||
                          (name.starts_with("probe_") && type == ".csv");
    for (const char* known :
         {"result.json", "state.vtu", "map.vtu", "map.csv", "mesh.png", "von_mises.png", "map.png", "report.html"})
      if (name == known) old.push_back(entry.path());
    if (numbered) old.push_back(entry.path());
  }
  for (const auto& path : old) {
    std::error_code failed;
    std::filesystem::remove(path, failed);
    if (failed) throw Error(Fault::Files, fmt::format("cannot remove {}: {}", path.string(), failed.message()));
  }
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
  if (with_map)
    for (std::size_t k = 0; k < c.scene.laws.size(); ++k)
      if (has_friction(c.scene.laws[k]))
        throw Error(
            Fault::Usage,
            fmt::format("the map needs cracks without friction: crack \"{}\" slides against it, and the state does "
                        "not minimise the energy; remove friction and tresca, or [map] (kerf solve)",
                        c.shape.cracks[k].name));
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
  r.functional = {c.functional, r.state->energy};
  const PlotData data = plot_data(model, state, c.plane_strain);
  r.seconds.solve += watch.lap();

  FullMap full;
  if (with_map) {
    begin("map");
    full = energy_map(model, state, data.corners, data.values);
    r.map = map_result(model, state, c, full);
    r.seconds.map = watch.lap();
  }

  begin("write");
  if (c.output.vtk) {
    write_vtu(file("state.vtu"), data.points, data.corners.of, state_fields(model, state, data, indicator));
    if (with_map) {
      const std::vector<NamedField> fields{{"topological_derivative", false, full.at_corners.transpose()},
                                           {"topological_derivative_at_centroid", true, full.at_centroids.transpose()}};
      write_vtu(file("map.vtu"), data.points, data.corners.of, fields);
    }
  }
  for (const CrackResult& crack : r.cracks) {
    write_crack_csv(file("crack_" + crack.name + ".csv"), crack);
    if (!c.output.vtk) continue;
    std::vector<std::vector<Vec2>> line(1);
    for (const CrackRow& row : crack.rows) line[0].push_back(row.at);
    write_vtp(file("crack_" + crack.name + ".vtp"), line, crack_fields(crack));
  }
  if (with_map) write_csv(file("map.csv"), {"x", "y", "topological_derivative"}, map_rows(*r.map, data, full));
  for (const Probe& probe : c.probes)
    write_csv(file("probe_" + probe.name + ".csv"),
              {"x", "y", "u_x", "u_y", "s_xx", "s_yy", "s_xy", "topological_derivative"},
              probe_rows(model, state, probe, with_map));
  std::vector<std::pair<std::string, std::filesystem::path>> pictures;
  if (c.output.png) {
    const auto picture = [&](const std::string& name, const std::string& caption, const Picture& p) {
      draw(file(name), p);
      pictures.emplace_back(caption, file(name));
    };
    picture("mesh.png", "Mesh", mesh_picture(c, model));
    picture("von_mises.png", "Von Mises stress", stress_picture(c, model, data));
    if (with_map) picture("map.png", "Topological derivative", map_picture(c, model, data, full));
  }

  if (!certified(state)) {
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
  r.seconds.output = watch.lap();
  sum_up();
  if (c.output.html) write_page(file("report.html"), r, pictures);
  write_json(file("result.json"), r);
  return r;
}

}  // namespace kerf
