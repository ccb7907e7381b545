// What processes do together on a divided body, each on its part. Every process takes its triangles of the undivided
// mesh with rings around them, divides these, solves with the others [theory: E.34], finds with them what is asked of
// the body (app/run/findings.cpp), and writes its own piece of the files. Every process must come by every collective
// call, whatever it finds on its part: decisions are made of sums. docs/theory/elements.md, "Solving in parts".

#include "app/parts/part_work.hpp"

#include "app/run/collect.hpp"
#include "app/run/notes.hpp"
#include "app/write/files.hpp"
#include "geometry/part.hpp"
#include "kerf/adaptive.hpp"
#include "solver/adapting.hpp"
#include "solver/shared_bounds.hpp"
#include "solver/shared_estimate.hpp"
#include "solver/shared_tips.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"
#include "topo/clamped_parts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace kerf {

std::string piece_name(std::string_view of, Index process) {
  return fmt::format("{}_{:04}.vtu", of, process);
}

namespace {

/// Points and fields of own triangles alone.
struct OwnPlot {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> corner;  // per point, of all corners here
};

OwnPlot own_plot(const PlotData& data, Index triangles) {
  OwnPlot own;
  std::vector<Index> place(data.points.size(), none);
  for (Index t = 0; t < triangles; ++t) {
    std::array<Index, 3> of{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Index corner = data.corners.of[static_cast<std::size_t>(t)][i];
      Index& at = place[static_cast<std::size_t>(corner)];
      if (at == none) {
        at = static_cast<Index>(own.points.size());
        own.points.push_back(data.points[static_cast<std::size_t>(corner)]);
        own.corner.push_back(corner);
      }
      of[i] = at;
    }
    own.triangles.push_back(of);
  }
  return own;
}

/// Leaves names, kinds and components of the fields.
void write_piece(const PartTask& task, std::string_view name, const Mesh& mesh, const OwnPlot& own, Index here,
                 std::vector<NamedField>& fields) {
  const auto triangles = static_cast<Eigen::Index>(own.triangles.size());
  for (NamedField& f : fields)
    f.values =
        f.per_cell ? Eigen::MatrixXd(f.values.leftCols(triangles)) : Eigen::MatrixXd(f.values(Eigen::all, own.corner));
  if (task.vtk)
    write_vtu(std::filesystem::path(task.folder) / piece_name(name, here), own.points, own.triangles, fields,
              middle_points(mesh, own.triangles));
  for (NamedField& f : fields) f.values.resize(f.values.rows(), 0);
}

/// Whether J asks for the adjoint of a state.
bool needs_adjoint(const Functional& j, const Model& part, Communicator& comm) {
  const bool self_adjoint = sum(comm, has_self_adjoint_work(part) ? 0 : 1) == 0;
  return std::ranges::any_of(j.terms, [&](const Term& term) {
    return !term.energy && !term.measured && !term.volume && !(term.work && self_adjoint);
  });
}

/// The body in parts, or the same with measured displacements.
struct Bodies {
  const Case& c;
  const PartTask& task;
  Communicator& comm;
  std::shared_ptr<const Mesh> whole;
  SharedBody make(MeshPart part, const Scene& scene, const Floating& floating) const {
    return {std::move(part),
            c.element,
            scene,
            task.threads,
            floating,
            task.piece,
            comm,
            whole,
            c.precision == FactorPrecision::Single ? Precision::Single : Precision::Double};
  }
};

/// J; with a map all that it takes besides the state. `again`: the part once more, for a misfit.
Analysis analyze_in_parts(const Bodies& bodies, SharedBody& body, const State& state, std::optional<MeshPart> again) {
  const auto& [c, task, comm, whole] = bodies;
  const auto measured = [&](const Support& displacement) {
    const auto other = std::make_shared<SharedBody>(
        bodies.make(std::move(again.value()), measured_scene(c.scene, displacement), task.measured));
    return std::pair(std::shared_ptr<const Model>(other, &other->model()),
                     std::make_shared<const State>(other->solve(task.contact)));
  };
  return analyze(c.functional, body.model(), state, whole_body(body, state, comm, measured), !task.map);
}

/// The indicator of all triangles here, and the error of the body.
Indicator estimate(const Case& c, const Model& model, const State& state, Communicator& comm, FoundTogether& found) {
  Indicator indicator;
  if (!c.output.estimate || !can_estimate_error(model.element)) return indicator;
  const Sums over_all = sums_over(comm);
  indicator = error_indicator(model, state, over_all);
  add_chords(c.shape, c.divisions, model, state, indicator, over_all);
  found.round = {.triangles = static_cast<Index>(sum(comm, own_triangles(model))),
                 .estimated_error = indicator.stress > 0 ? indicator.relative : 0,
                 .assemble = model.seconds.assemble,
                 .solve = state.seconds.solve};
  return indicator;
}

/// Why this round is the last one: on all processes the same.
std::string end_of_rounds(const Case& c, const PartTask& task, const Model& model, Communicator& comm,
                          const FoundTogether& found) {
  const std::string here = unseen_by_estimate(model);
  std::string unseen;
  for (const std::string& words : comm.exchange(std::vector<std::string>(static_cast<std::size_t>(comm.count()), here)))
    if (unseen.empty()) unseen = words;
  std::vector<Round> rounds = task.rounds;
  rounds.push_back(found.round);
  return reason_to_end(rounds, unseen, {.error = c.adapt->error, .max_triangles = c.adapt->max_triangles});
}

/// Of the triangles of all processes.
Quality quality_of_all(const MeshPart& p, Communicator& comm) {
  std::vector<bool> use(p.mesh.triangles.size(), false);
  std::fill_n(use.begin(), p.own, true);
  const Quality own = quality(part_without_cracks(p.mesh, use));
  std::array<double, 3> most{-own.h_min, own.h_max, -own.min_angle_deg};
  comm.largest(most);
  std::array<double, 2> sums{own.mean_quality * p.own, static_cast<double>(p.own)};
  comm.sum(sums);
  return {-most[0], most[1], -most[2], sums[0] / sums[1]};
}

/// Per triangle of the mesh before it was divided; of the first process.
Eigen::VectorXd on_undivided(const Eigen::VectorXd& eta, const std::vector<Index>& origin, Index own, std::size_t count,
                             Communicator& comm) {
  struct Square {
    Index triangle;
    double of;
  };
  std::vector<Square> here;
  for (Index t = 0; t < own; ++t) here.push_back({origin[static_cast<std::size_t>(t)], eta[t] * eta[t]});
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count));
  for (const Square& s : gathered_by_first(comm, here)) squares[s.triangle] += s.of;
  return squares.cwiseSqrt();
}

/// What a part does not show of its body.
struct OfWhole {
  OfWhole(const Case& c, const Mesh& coarse)
      : tips(coarse, c.scene, c.divisions), ends(ends_inside(coarse)), on_chords(is_of_polygon(c.shape, coarse)) {}
  SharedTips tips;
  std::vector<std::array<bool, 2>> ends;
  bool on_chords;
};

const std::vector<Vec2> everywhere;

/// A solved part, whose triangles come from those of the mesh before it was divided.
struct DividedPart {
  const SolvedPart& solved;
  const PartTask& task;
  const std::vector<Index>& origin;
  const Mesh* whole;
};

/// The largest values, the map, and the fields of both, with what the first process draws of them.
void find_fields(const DividedPart& part, const Case& c, const MapTask& map_task, Analysis& functional,
                 FoundTogether& found) {
  const auto& [solved, task, origin, whole] = part;
  const Model& model = solved.model;
  Communicator& comm = solved.comm;
  if (!task.vtk && !c.output.peaks && !task.map && !task.copy) return;
  const PlotData data = plot_data(model, solved.state, c.plane_strain);
  const Index own_count = own_triangles(model);
  const OwnPlot own = own_plot(data, own_count);
  if (c.output.peaks) find_peaks(c, solved, data, task.zones, found.of);
  found.fields = state_fields(model, solved.state, data, solved.indicator);
  write_piece(task, "state", model.mesh, own, comm.here(), found.fields);
  std::optional<Mapped> map;
  if (task.map) {
    map = find_map(map_task, functional, data, task.zones, comm);
    found.map = map->result;
    found.map_fields = map_fields(*map);
    write_piece(task, "map", model.mesh, own, comm.here(), found.map_fields);
  }
  if (!task.copy) return;
  found.copied =
      gathered_by_first(comm, copied_corners(*whole, origin, own_count, model.mesh, data, map ? &*map : nullptr));
  if (map) found.centers = gathered_by_first(comm, copied_centers(origin, own_count, *map));
}

}  // namespace

FoundTogether work_together(const Case& given, PartTask task, Communicator& comm) {
  Case c = given;
  c.sizing.curved = c.sizing.curved && !task.coarse.arc.empty();  // the first process may have drawn chords
  MeshPart part = mesh_part(task.coarse, task.process, static_cast<int>(comm.count()), comm.here(), c.divisions);
  const OfWhole whole_body(c, task.coarse);
  const std::size_t undivided = task.coarse.triangles.size();
  FoundTogether found;
  if (!task.coarse.arc.empty()) found.mesh = quality_of_all(part, comm);
  const auto whole = task.map || task.copy ? std::make_shared<const Mesh>(std::move(task.coarse)) : nullptr;
  task.coarse = {};
  task.process = {};
  const std::vector<std::vector<double>> from = part.from;
  const std::vector<Index> origin = part.origin;
  const Bodies bodies{c, task, comm, whole};
  std::optional<MeshPart> again;
  if (std::ranges::any_of(c.functional.terms, [](const Term& term) { return term.measured.has_value(); })) again = part;
  SharedBody body = bodies.make(std::move(part), c.scene, task.floating);
  const Model& model = body.model();
  State state = body.solve(task.contact, task.map && needs_adjoint(c.functional, model, comm));
  const Indicator indicator = estimate(c, model, state, comm, found);
  if (c.adapt) {
    found.stopped = end_of_rounds(c, task, model, comm, found);
    if (found.stopped.empty()) {
      found.eta = on_undivided(indicator.eta, origin, own_triangles(model), undivided, comm);
      return found;
    }
  }
  Analysis functional = analyze_in_parts(bodies, body, state, std::move(again));
  body.drop_factor();
  found.functional.value = functional.value;
  found.functional.term_value = functional.term_value;
  found.effort = body.effort();
  found.seconds = model.seconds;
  const Sums over_all = sums_over(comm);
  const SolvedPart solved{
      .model = model,
      .state = state,
      .indicator = indicator,
      .comm = comm,
      .tips = whole_body.ends,
      .of_polygon = whole_body.on_chords,
      .from = &from,
      .intensities =
          [&](const auto& profiles) { return whole_body.tips.intensities(model, state, profiles, over_all); },
      .energy_bounds =
          [&] {
            return energy_bounds(model, state, over_all,
                                 [&](const Eigen::VectorXd& forces) { return body.solve_open(forces); });
          }};
  Seconds unseen;
  found.of = find_state(c, solved, unseen);
  body.drop_factor();
  const MapTask map_task{c.functional, c.map_request, c.map ? c.map->points : everywhere};
  if (!task.green.empty()) take_green(green_from(task.green), functional);
  find_fields({solved, task, origin, whole.get()}, c, map_task, functional, found);
  found.probes = find_probes(c, solved, map_task, task.map ? &functional : nullptr);
  return found;
}

}  // namespace kerf
