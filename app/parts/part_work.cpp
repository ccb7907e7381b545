// What processes do together on a divided body, each on its part, and what the first one gathers. Every process takes
// its triangles of the undivided mesh with rings around them, divides these, solves with the others [theory: E.34], and
// writes its own piece of the files. Numbers of the whole are sums over own triangles (energies, area, the square of
// the error indicator, reactions) or largest values. What stands at points (peaks, profiles of cracks, probes, maps at
// points) is gathered as flat records; of several processes that have the same point the first one counts. Arc length
// along a crack is summed from the lengths of all its edges, put in the order of the undivided path. Every process must
// come by every collective call, whatever it finds on its part: decisions are made of sums. docs/theory/elements.md,
// "Solving in parts".

#include "app/parts/part_work.hpp"

#include "app/run/collect.hpp"
#include "app/run/map.hpp"
#include "app/run/margins.hpp"
#include "app/run/notes.hpp"
#include "app/run/peaks.hpp"
#include "app/run/solve.hpp"
#include "app/write/files.hpp"
#include "geometry/part.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/map.hpp"
#include "solver/adapting.hpp"
#include "solver/history.hpp"
#include "solver/recovery.hpp"
#include "solver/resultants.hpp"
#include "solver/shared_bounds.hpp"
#include "solver/shared_estimate.hpp"
#include "solver/shared_tips.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"
#include "topo/clamped_parts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace kerf {

std::string piece_name(std::string_view of, Index process) {
  return fmt::format("{}_{:04}.vtu", of, process);
}

namespace {

/// The larger of what the parts have.
std::optional<Peak> largest_of(Communicator& comm, const std::optional<Peak>& own) {
  struct Flat {
    double value, x, y, regular, u, v;
    char singular;
  };
  std::vector<Flat> flat;
  if (own) {
    const PlacedValue regular = own->regular.value_or(own->singular ? PlacedValue{Vec2::Zero(), nan} : own->largest);
    flat.push_back({own->largest.value, own->largest.at.x(), own->largest.at.y(), regular.value, regular.at.x(),
                    regular.at.y(), static_cast<char>(own->singular)});
  }
  std::optional<Peak> all;
  std::optional<PlacedValue> regular;
  for (const Flat& f : gathered(comm, flat)) {
    if (!all || f.value > all->largest.value)
      all = Peak{.largest = {Vec2(f.x, f.y), f.value}, .singular = f.singular != 0};
    if (std::isfinite(f.regular) && (!regular || f.regular > regular->value)) regular = {Vec2(f.u, f.v), f.regular};
  }
  if (all && all->singular) all->regular = regular;
  return all;
}

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

/// Least and largest value of each kind of place that may be left out (LeftOut), over all processes: those of the
/// first kind, and of the ones before it, where there are any.
std::array<PlacedValue, 2> extrema_of_parts(Communicator& comm, const OwnPlot& own, const Eigen::VectorXd& values,
                                            const std::vector<LeftOut>& left_out) {
  struct Flat {
    double value = nan, x = 0, y = 0;
  };
  std::vector<Flat> flat(6);  // least and largest, per kind
  for (std::size_t i = 0; i < own.points.size(); ++i) {
    const double v = values[own.corner[i]];
    const Flat here{v, own.points[i].x(), own.points[i].y()};
    // Kind k has the places that are left out for its reason or a weaker one.
    for (auto k = static_cast<std::size_t>(left_out[static_cast<std::size_t>(own.corner[i])]); k < 3; ++k) {
      if (std::isfinite(v) && !(v >= flat[2 * k].value)) flat[2 * k] = here;
      if (std::isfinite(v) && !(v <= flat[2 * k + 1].value)) flat[2 * k + 1] = here;
    }
  }
  std::array<PlacedValue, 2> all{PlacedValue{Vec2::Zero(), nan}, PlacedValue{Vec2::Zero(), nan}};
  const std::vector<Flat> every = gathered(comm, flat);
  for (std::size_t k = 0; k < 3 && !std::isfinite(all[0].value); ++k)
    for (std::size_t i = 0; i < every.size(); i += 6) {
      const Flat &least = every[i + 2 * k], &most = every[i + 2 * k + 1];
      if (std::isfinite(least.value) && !(least.value >= all[0].value)) all[0] = {Vec2(least.x, least.y), least.value};
      if (std::isfinite(most.value) && !(most.value <= all[1].value)) all[1] = {Vec2(most.x, most.y), most.value};
    }
  return all;
}

/// Per point the own triangle in which it lies, or none.
std::vector<Index> locate_own(const Model& model, const std::vector<Vec2>& points) {
  std::vector<Index> where = locate(model.mesh, points);
  for (Index& t : where)
    if (t >= own_triangles(model)) t = none;
  return where;
}

/// At listed points: of the first process in whose own triangles each of them lies.
std::vector<MapPoint> map_at_points(const Case& c, const Analysis& a, const std::vector<Vec2>& asked,
                                    Communicator& comm) {
  struct Flat {
    Index point;
    double value, angle;
    char masked;
  };
  std::vector<Index> mine;
  std::vector<Vec2> at;
  const std::vector<Index> where = locate_own(*a.model, asked);
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (where[i] != none) {
      mine.push_back(static_cast<Index>(i));
      at.push_back(asked[i]);
    }
  std::vector<Flat> own;
  const std::vector<MapPoint> found = at.empty() ? std::vector<MapPoint>() : map_at(a, c.functional, c.map_request, at);
  for (std::size_t i = 0; i < found.size(); ++i)
    own.push_back({mine[i], found[i].value, found[i].angle, static_cast<char>(found[i].masked)});
  std::vector<MapPoint> points;
  for (const Vec2& x : asked) points.push_back({.at = x, .value = nan, .masked = true});
  std::vector<bool> known(points.size(), false);
  for (const Flat& f : gathered(comm, own)) {
    if (known[static_cast<std::size_t>(f.point)]) continue;
    known[static_cast<std::size_t>(f.point)] = true;
    MapPoint& p = points[static_cast<std::size_t>(f.point)];
    p.value = f.value;
    p.angle = f.angle;
    p.masked = f.masked != 0;
  }
  return points;
}

Mapped map_part(const Case& c, const PartTask& task, Analysis& a, const PlotData& data, const OwnPlot& own,
                Communicator& comm, FoundTogether& found) {
  const Model& model = *a.model;
  if (!task.green.empty()) take_green(green_from(task.green), a);
  Mapped map = make_map({c.functional, c.map_request, {}}, a, data, task.zones);
  double masked = 0;
  for (Index t = 0; t < own_triangles(model); ++t)
    if (map.full.masked_centroid[static_cast<std::size_t>(t)]) masked += cell_area(model, t);
  MapResult r{.perturbation = std::string(word(c.map_request.perturbation.kind))};
  if (c.map && !c.map->points.empty()) r.points = map_at_points(c, a, c.map->points, comm);
  for (std::size_t k = 0; k < c.probes.size(); ++k) {
    const std::vector<MapPoint> at = map_at_points(c, a, c.probes[k].points, comm);
    for (std::size_t i = 0; i < at.size(); ++i) found.probes[k][i].back() = at[i].value;
  }
  const auto [least, most] = extrema_of_parts(comm, own, map.full.at_corners, map.left_out_corner);
  r.min = least;
  r.max = most;
  r.excluded_radius = task.zones.largest();
  r.radius = c.map_request.radius;
  r.masked_share = sum(comm, masked) / found.area;
  constexpr double rounding = 1e-9;
  if (r.masked_share > 1 - rounding) r.min = r.max = {Vec2::Constant(nan), nan};  // extrema of nothing
  r.biactive_length = a.biactive_length;
  r.oriented = map.full.angle.size() > 0;
  found.map = std::move(r);
  found.map_fields = map_fields(map);
  write_piece(task, "map", model.mesh, own, comm.here(), found.map_fields);
  return map;
}

/// The rows of probes, of the first process in whose own triangles each point lies; without a map.
void gather_probes(const Case& c, const Model& model, const State& state, Communicator& comm, FoundTogether& found) {
  struct Flat {
    std::size_t probe, point;
    std::array<double, 8> row;
  };
  std::vector<Flat> own;
  for (std::size_t k = 0; k < c.probes.size(); ++k) {
    const std::vector<Vec2>& points = c.probes[k].points;
    const std::vector<Index> where = locate_own(model, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (where[i] == none) continue;
      const std::vector<double> row = probe_row(model, state, where[i], points[i], nan);
      own.push_back({k, i, {}});
      std::ranges::copy(row, own.back().row.begin());
    }
    auto& rows = found.probes.emplace_back();
    for (const Vec2& x : points) rows.push_back(probe_row(model, state, none, x, nan));
  }
  std::vector<Flat> all = gathered(comm, own);
  std::ranges::reverse(all);  // the first process has the last word
  for (const Flat& f : all) found.probes[f.probe][f.point].assign(f.row.begin(), f.row.end());
}

/// Per crack what all know of it. `from`: MeshPart::from.
void gather_cracks(const Model& model, const State& state, const std::vector<std::vector<double>>& from,
                   Communicator& comm, FoundTogether& found) {
  struct Point {
    CrackPoint p;
    double slip;
  };
  struct Edge {
    double from, length;
  };
  for (Index c = 0; c < static_cast<Index>(model.mesh.cracks.size()); ++c) {
    const auto& path = model.mesh.cracks[static_cast<std::size_t>(c)];
    const std::vector<CrackPoint> profile = crack_profile(model, state, c);
    const bool slides = has_friction(model.scene.laws[static_cast<std::size_t>(c)]);
    const std::vector<double> slip = slides ? slip_profile(model, state, c) : std::vector<double>(profile.size(), 0);
    const std::size_t each = path.empty() ? 0 : profile.size() / path.size();
    const auto is_own = [&](std::size_t k) {
      return model.mesh.sides[static_cast<std::size_t>(path[k].edge)][1] < own_triangles(model);
    };
    const std::vector<double>& order = from[static_cast<std::size_t>(c)];
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < path.size(); ++k)
      if (is_own(k)) edges.push_back({order[k], length_along(model, path[k].edge)});
    edges = gathered(comm, edges);
    std::ranges::sort(edges, {}, &Edge::from);
    std::map<double, double> begin;  // along the curve, by the place along the chords
    double sum = 0;
    for (const Edge& e : edges) {
      begin[e.from] = sum;
      sum += e.length;
    }
    std::vector<Point> own;
    double done = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
      for (std::size_t i = k * each; is_own(k) && i < (k + 1) * each; ++i) {
        own.push_back({profile[i], slip[i]});
        own.back().p.s += begin.at(order[k]) - done;
      }
      done += length_along(model, path[k].edge);
    }
    std::vector<Point> all = gathered(comm, own);
    std::ranges::stable_sort(all, {}, [](const Point& q) { return q.p.s; });
    auto& points = found.profiles.emplace_back();
    auto& slips = found.slips.emplace_back();
    for (const Point& q : all) {
      points.push_back(q.p);
      if (slides) slips.push_back(q.slip);
    }
  }
}

void sum_reactions(const Model& model, const State& state, std::size_t labels, Communicator& comm,
                   FoundTogether& found) {
  std::vector<double> sums(4 * labels, 0);  // whether there are any, force, moment
  for (const LabelResultant& r : reactions(model, state)) {
    double* at = sums.data() + 4 * static_cast<std::size_t>(r.label);
    at[0] += 1;
    at[1] += r.of.force.x();
    at[2] += r.of.force.y();
    at[3] += r.of.moment;
  }
  comm.sum(sums);
  for (std::size_t l = 0; l < labels; ++l) {
    const double* at = sums.data() + 4 * l;
    if (at[0] == 0) continue;
    LabelResultant r{.label = static_cast<Index>(l)};
    r.of.force = Vec2(at[1], at[2]);
    r.of.moment = at[3];
    found.reactions.push_back(r);
  }
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
  if (indicator.stress > 0) found.error = indicator.relative;
  found.round = {.triangles = static_cast<Index>(sum(comm, own_triangles(model))),
                 .estimated_error = found.error.value_or(0),
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

}  // namespace

FoundTogether work_together(const Case& given, PartTask task, Communicator& comm) {
  Case c = given;
  c.sizing.curved = c.sizing.curved && !task.coarse.arc.empty();  // the first process may have drawn chords
  MeshPart part = mesh_part(task.coarse, task.process, static_cast<int>(comm.count()), comm.here(), c.divisions);
  const SharedTips tips(task.coarse, c.scene, c.divisions);
  const std::size_t undivided = task.coarse.triangles.size();
  const bool on_chords = is_of_polygon(c.shape, task.coarse);
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
  std::array<double, 4> sums{potential_energy(model, state), work_of_loads(model, state), area(model),
                             static_cast<double>(own_triangles(model))};
  comm.sum(sums);
  found.potential = sums[0];
  found.work = sums[1];
  found.area = sums[2];
  const double mean = mean_stress(model, state);
  found.mean_stress = std::sqrt(sum(comm, mean * mean * area(model)) / found.area);
  found.has_stress = sum(comm, has_stress(model, state) ? 1 : 0) > 0;
  found.unknowns = body.unknowns();
  found.interior = static_cast<Index>(interior_count(model.element) * sums[3]);
  found.effort = body.effort();
  found.seconds = model.seconds;
  gather_cracks(model, state, from, comm, found);
  gather_probes(c, model, state, comm, found);
  const Sums over_all = sums_over(comm);
  if (c.output.tips) found.tips = tips.intensities(model, state, found.profiles, over_all);
  if (c.output.energy_bounds)
    found.energy =
        energy_bounds(model, state, over_all, [&](const Eigen::VectorXd& forces) { return body.solve_open(forces); });
  body.drop_factor();
  sum_reactions(model, state, c.shape.labels.size(), comm, found);
  if (task.vtk || c.output.peaks || task.map || task.copy) {
    const PlotData data = plot_data(model, state, c.plane_strain);
    const OwnPlot own = own_plot(data, own_triangles(model));
    if (c.output.peaks) {
      found.von_mises = largest_of(comm, peak(own.points, data.von_mises(own.corner), task.zones));
      if (found.von_mises && !on_chords)  // corners of chords have a note
        refine_peak(model, state, data, c.plane_strain, task.zones, own.corner, comm, *found.von_mises);
      const Eigen::VectorXd moved = data.values.displacement.colwise().norm().transpose();
      found.displacement = largest_of(comm, peak(own.points, moved(own.corner), {}));
      const Eigen::VectorXd strained = principal_strains(model, data);
      found.strain = largest_of(comm, peak(own.points, strained(own.corner), task.zones));
      if (const auto top = found.von_mises ? top_on_chords(c, *found.von_mises) : std::nullopt)
        found.beside_chords =
            std::ranges::max(gathered(comm, std::vector{beside(model, state, data, c.plane_strain, top->at)}));
    }
    found.fields = state_fields(model, state, data, indicator);
    write_piece(task, "state", model.mesh, own, comm.here(), found.fields);
    const std::optional<Mapped> map =
        task.map ? std::optional(map_part(c, task, functional, data, own, comm, found)) : std::nullopt;
    if (task.copy) {
      const Index own_count = own_triangles(model);
      found.copied =
          gathered_by_first(comm, copied_corners(*whole, origin, own_count, model.mesh, data, map ? &*map : nullptr));
      if (map) found.centers = gathered_by_first(comm, copied_centers(origin, own_count, *map));
    }
  }
  found.state.certificate = state.certificate;
  found.state.converged = state.converged;
  found.state.contact_iterations = state.contact_iterations;
  found.state.linear_solves = state.linear_solves;
  found.state.seconds = state.seconds;
  return found;
}

}  // namespace kerf
