// A body solved in parts: what is refused, the mesh and the tasks, and the result of all. The first process meshes the
// body before it is divided and solves that for what must be known of the whole: ends of contact and the set of
// touching points to begin with, rigid motions that nothing holds, singular points, Green's tensor for maps of clamped
// holes. It partitions the mesh, sends the others a PartTask, works on its own part (part_work.cpp), and makes the
// result of what all found. With mesh.adapt this is one round: the indicator of the divided triangles, squares added
// per undivided one, grades the next undivided mesh. After n divisions there are
//   T_n = 4^n T_0 triangles,  E_{n+1} = 2 E_n + 3 T_n edges,  P_{n+1} = P_n + E_n vertices.
// Pictures and the page show the corners of the undivided mesh. docs/theory/elements.md, "Solving in parts".

#include "app/parts/parts.hpp"

#include "app/parts/part_work.hpp"
#include "app/processes.hpp"
#include "app/run/coarse_copy.hpp"
#include "app/run/collect.hpp"
#include "app/run/map.hpp"
#include "app/run/notes.hpp"
#include "app/run/peaks.hpp"
#include "app/run/solve.hpp"
#include "app/write/draw.hpp"
#include "app/write/files.hpp"
#include "app/write/page_data.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/map.hpp"
#include "kerf/mesher.hpp"
#include "kerf/stop.hpp"
#include "solver/adapting.hpp"
#include "solver/divided.hpp"
#include "solver/error_bars.hpp"
#include "solver/recovery.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"
#include "topo/clamped_parts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

[[noreturn]] void fail_in_parts(const Case& c, const std::string& why) {
  throw Error(Fault::Usage,
              fmt::format("{}: on several processes none has the whole of the mesh, and {}; start kerf as "
                          "one process",
                          place_of(c, "solver.backend"), why));
}

/// Throws Error(Usage) for what needs more of the whole than the sums of its parts, as the case says it.
void refuse_in_parts(const Case& c) {
  if (c.optimize && !c.optimize->load_cases.empty())
    fail_in_parts(c, "its loads are those of [[boundary]] and [body] alone, not those of [[load_case]]");
  if (c.bounds) fail_in_parts(c, "[bounds] asks for intervals, which take the whole");
  if (c.adapt && c.adapt->of) fail_in_parts(c, "mesh.adapt.of asks for intervals, which take the whole");
  if (c.map_request.bounds) fail_in_parts(c, "the error bars of a map (map.bounds) take the whole");
  if (std::ranges::any_of(c.probes, &Probe::bounds)) fail_in_parts(c, "the stresses at a probe are not bounded there");
}
/// The same, as its mesh shows it.
void refuse_parts(const Model& coarse, const Case& c, bool with_map) {
  const auto fail = [&](const char* why) { fail_in_parts(c, why); };
  if (!coarse.inner->semicoercive.empty()) fail("what contact alone holds is known of the whole alone");
  require_known_loads(c.functional, coarse);
  require_finite(c.functional, coarse);
  if (!with_map) return;
  require_supports(c.functional, coarse);
  if (c.map_request.second) fail("the second term takes solves of the whole");
}

/// The same body with measured displacements, without a factor.
Model measured_body(const Case& c, const Model& coarse, const Support& measured) {
  Model body = prepare(coarse.mesh, c.element, measured_scene(c.scene, measured), coarse.threads, {.factorize = false});
  if (!body.inner->semicoercive.empty())
    fail_in_parts(c, "what contact alone holds of the body with measured displacements is known of the whole alone");
  return body;
}

/// The body before its mesh is divided, graded at the ends of contact: a model without a factor, and what the faces do
/// there.
struct Undivided {
  Model model;
  ContactGuess contact;
  std::vector<Vec2> ends;  // of contact
};
/// `given`: the mesh, or nothing.
Undivided undivided(const Case& c, const std::shared_ptr<const Mesh>& given, const Journal& journal) {
  const int threads = journal.options.threads;
  Undivided u;
  Mesh mesh;
  if (c.adapt) {  // as those of one process begin: graded by the indicator alone
    mesh = given ? *given : triangulate(c.shape, c.sizing);
    if (has_contact(c.scene)) {
      const Model model = prepare(mesh, c.element, c.scene, threads);
      const State state = solve(model, c.contact);
      u.contact = contact_guess(model, state);
      u.ends = contact_ends(model, state);
    }
  } else if (has_contact(c.scene)) {
    Adapted a = solve_graded(c.shape, c.sizing, c.element, c.scene,
                             {.contact = c.contact, .estimate = false, .threads = threads, .given = given});
    u.contact = contact_guess(a.model, a.state);
    u.ends = std::move(a.sizing.ends);
    mesh = std::move(a.model.mesh);
  } else {
    mesh = given ? *given : triangulate(c.shape, c.sizing);
  }
  check_division(mesh, c.element, c.divisions);
  u.model = prepare(std::move(mesh), c.element, c.scene, threads, {.factorize = false});
  return u;
}

/// What limits the map, which is that of the body and not of its mesh.
std::vector<std::string> limits_before_division(const Case& c, const Undivided& u, const MapResult& map, int threads) {
  if (!has_series(c.map_request.perturbation))  // they are those of the scene
    return limits_of_map({c.functional, c.map_request, {}}, {.model = &u.model, .state = nullptr}, map);
  if (!may_answer_by_pressure(u.model.scene)) return {};
  const Model model = prepare(u.model.mesh, c.element, c.scene, threads);
  const State state = solve(model, c.contact);
  return limits_of_map({c.functional, c.map_request, {}}, analyze(c.functional, model, state), map);
}

/// Numbers of the mesh divided so many times: its triangles are similar to those before, but beside curved edges.
void describe_divided(const Mesh& coarse, int divisions, Result& r) {
  double triangles = static_cast<double>(coarse.triangles.size()), edges = static_cast<double>(coarse.edges.size()),
         points = static_cast<double>(coarse.points.size());
  for (int k = 0; k < divisions; ++k) {
    points += edges;
    edges = 2 * edges + 3 * triangles;
    triangles *= 4;
  }
  if (triangles > 2e9 || edges > 2e9)
    throw Error(Fault::Usage, "mesh.refine: more triangles or edges than can be numbered; divide the mesh less often");
  r.triangles = static_cast<Index>(triangles);
  r.vertices = static_cast<Index>(points);
  r.mesh = quality(coarse);
  r.mesh.h_min = std::ldexp(r.mesh.h_min, -divisions);
  r.mesh.h_max = std::ldexp(r.mesh.h_max, -divisions);
}

/// The rounds of a solution; one without mesh.adapt.
struct InParts {
  InParts(const Case& of, bool map, Processes& with, Journal& to, Result& result)
      : c(of), with_map(map), processes(with), journal(to), r(result) {
    processes.take_options(of.petsc);
  }

  FoundTogether solve() {
    if (c.adapt) require(c.element, can_estimate_error);
    if (c.precision == FactorPrecision::Single && !processes.by_kerf())
      throw Error(Fault::Usage, fmt::format("{}: -pc_type selects a solver of PETSc, whose factors are in double "
                                            "precision; leave out solver.precision",
                                            place_of(c, "solver.precision")));
    std::vector<Round> rounds;
    std::shared_ptr<const Mesh> given = c.mesh;
    while (true) {
      journal.begin("mesh");
      before = undivided(c, given, journal);
      PartTask task = task_for(before);
      task.rounds = rounds;
      journal.seconds.mesh += journal.lap();
      journal.begin("solve in parts");
      FoundTogether found;
      processes.work(packed(task), [&](Communicator& comm) { found = work_together(c, std::move(task), comm); });
      journal.seconds.assemble += found.seconds.assemble;
      journal.seconds.contact += found.of.solved.seconds.contact;
      journal.seconds.solve += journal.lap() - found.seconds.assemble - found.of.solved.seconds.contact;
      if (!before.model.mesh.arc.empty()) r.mesh = found.mesh;
      rounds.push_back(found.round);
      if (c.adapt && found.stopped.empty()) {
        if (stop_requested()) throw Stopped{};
        journal.begin(fmt::format("refine: round {}, {} triangles, estimated error {:.3g}", rounds.size(),
                                  found.round.triangles, found.round.estimated_error));
        given = std::make_shared<const Mesh>(next(found));
        continue;
      }
      if (c.adapt) r.adapt = adapt_result(rounds, found.stopped);
      return found;
    }
  }

  Undivided before = {};

 private:
  /// Green's tensor is smooth: that of the mesh before it is divided, of one degree more.
  std::string green_before_division(const Undivided& u) const {
    const Model model = prepare(u.model.mesh, better_element(c.element), c.scene, journal.options.threads);
    const State state = kerf::solve(model, c.contact);
    std::vector<Vec2> points;
    if (c.map) points = c.map->points;
    for (const Probe& probe : c.probes) points.insert(points.end(), probe.points.begin(), probe.points.end());
    return packed(*green_of_body(analyze(c.functional, model, state), c.functional, c.map_request, points));
  }

  PartTask task_for(const Undivided& u) {
    const Mesh& mesh = u.model.mesh;
    refuse_parts(u.model, c, with_map);
    if (mesh.triangles.size() < least_of_part * static_cast<std::size_t>(processes.count()))
      throw Error(Fault::Usage,
                  fmt::format("{}: {} triangles before they are divided are too few for {} processes; use a "
                              "smaller mesh.size, or fewer processes",
                              place_of(c, "mesh.refine"), mesh.triangles.size(), processes.count()));
    describe_divided(mesh, c.divisions, r);
    PartTask task{.coarse = mesh,
                  .process = shares(u.model, [this](const auto& start,
                                                    const auto& near) { return processes.partition(start, near); }),
                  .folder = std::filesystem::absolute(journal.options.folder).string(),
                  .threads = journal.options.threads,
                  .vtk = journal.vtk,
                  .copy = journal.png || journal.html || with_map,
                  .map = with_map,
                  .floating = floating_of(u.model, c.divisions),
                  .piece = pieces_for_pressure(mesh, c.scene),
                  .contact = u.contact};
    if (c.output.peaks || task.map) task.zones = singular_zones(u.model, extent(c.shape));
    if (with_map && !has_series(c.map_request.perturbation)) task.green = green_before_division(u);
    for (const Term& term : c.functional.terms)
      if (term.measured) task.measured = floating_of(measured_body(c, u.model, *term.measured), c.divisions);
    return task;
  }

  Mesh next(const FoundTogether& found) const {
    Sizing sizing = c.sizing;
    sizing.size = target_size(sizing, c.shape);
    sizing.ends = before.ends;
    const Adaptation wanted{.error = c.adapt->error, .max_triangles = c.adapt->max_triangles, .divisions = c.divisions};
    return next_mesh(c.shape, sizing, wanted, before.model.mesh, static_cast<double>(c.element.order),
                     {.eta = found.eta, .relative = found.round.estimated_error});
  }

  const Case& c;
  bool with_map;
  Processes& processes;
  Journal& journal;
  Result& r;
};

/// On the way that the state was solved.
std::vector<std::string> notes_on_parts(const Case& c, bool with_map, const SharedEffort& effort) {
  std::vector<std::string> notes;
  if (with_map && !has_series(c.map_request.perturbation))
    notes.emplace_back(
        "the map of clamped holes takes Green's tensor, which is smooth, of the mesh before it was divided and of one "
        "degree more");
  notes.emplace_back(
      "solved in parts, of which no process has the whole: pictures and page show it at the corners of the mesh before "
      "it was divided; state.pvtu has the fields");
  if (!c.half_tips.empty())
    notes.push_back(
        fmt::format("no K, G and T at ({:.6g}, {:.6g}), the tip of a crack in a plane of symmetry: several processes "
                    "do not compute them",
                    c.half_tips[0].x(), c.half_tips[0].y()));
  if (effort.unfinished > 0)
    notes.push_back(
        fmt::format("{} of {} solves in parts ended before they were as exact as asked ({}); the rounds "
                    "that followed made up for it",
                    effort.unfinished, effort.solves, effort.ended));
  return notes;
}

/// The files that name the pieces of all.
void write_grids(const FoundTogether& found, int processes, const Journal& journal) {
  const auto write_grid = [&](const std::string& name, const std::vector<NamedField>& fields) {
    std::vector<std::string> pieces;
    for (Index p = 0; p < static_cast<Index>(processes); ++p) pieces.push_back(piece_name(name, p));
    if (journal.vtk) write_pvtu(journal.file(name + ".pvtu"), pieces, fields);
  };
  write_grid("state", found.fields);
  if (found.map) write_grid("map", found.map_fields);
}

}  // namespace

void work_on_part(const Case& c, std::string_view task, Communicator& comm) {
  work_together(c, unpacked(task), comm);
}

RunState solve_in_parts(Case& c, bool with_map, Journal& journal, Result& r) {
  refuse_in_parts(c);
  journal.whole = false;
  Processes& processes = *journal.options.processes;
  InParts in_parts(c, with_map, processes, journal, r);
  FoundTogether found = as_it_can(c, [&] { return in_parts.solve(); });  // it folds before there is a task
  RunState::Together together{.functional = std::move(found.functional), .probes = std::move(found.probes)};
  if (found.map) together.limits = limits_before_division(c, in_parts.before, *found.map, journal.options.threads);
  write_grids(found, processes.count(), journal);
  CoarseCopy copy = coarse_copy(std::move(in_parts.before.model), found.copied, found.centers);
  copy.adapted.state = found.of.solved;
  if (found.map) copy.map.result = std::move(*found.map);
  together.map = std::move(copy.map);
  found.of.solver = solver_result(found.effort);
  found.of.notes = notes_on_parts(c, with_map, found.effort);
  return {std::move(copy.adapted), std::move(copy.data), std::move(found.of), std::move(together)};
}

}  // namespace kerf
