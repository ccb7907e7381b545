#include "app/parts.hpp"

#include "app/coarse_copy.hpp"
#include "app/collect.hpp"
#include "app/draw.hpp"
#include "app/files.hpp"
#include "app/map.hpp"
#include "app/page_data.hpp"
#include "app/peaks.hpp"
#include "app/ranks.hpp"
#include "app/solve.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/map.hpp"
#include "kerf/mesher.hpp"
#include "solver/history.hpp"
#include "solver/packer.hpp"
#include "solver/recovery.hpp"
#include "solver/resultants.hpp"
#include "solver/shared_bounds.hpp"
#include "solver/shared_tips.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

// What the others are told. The case they have read themselves.

struct Task {
  Mesh coarse;
  std::vector<Index> process;  // per triangle of it
  std::string folder;
  int divisions = 0, threads = 1;
  bool vtk = true, estimate = true, peaks = true, tips = true, bounds = true, copy = false, map = false;
  SingularZones zones = {};  // of the body, which a part does not show
  Floating floating = {};
  std::vector<Index> piece = {};  // SharedBody
  ContactGuess contact = {};
};

void put(const std::vector<Vec2>& points, Packer& to) {
  std::vector<double> flat;
  for (const Vec2& x : points) flat.insert(flat.end(), {x.x(), x.y()});
  to.put(flat);
}

std::vector<Vec2> points_from(Unpacker& from) {
  const auto flat = from.all<double>();
  std::vector<Vec2> points;
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) points.emplace_back(flat[i], flat[i + 1]);
  return points;
}

constexpr char parts = 'p';  // what a task begins with

std::string packed(const Task& task) {
  Packer to;
  to.put(parts);
  const Mesh& m = task.coarse;
  put(m.points, to);
  to.put(m.triangles);
  to.put(m.edges);
  to.put(m.edges_of);
  to.put(m.sides);
  to.put(m.label);
  to.put(m.crack);
  to.put(m.cracks.size());
  for (const auto& path : m.cracks) to.put(path);
  to.put(m.region);
  to.put(task.process);
  to.put(std::vector<char>(task.folder.begin(), task.folder.end()));
  to.put(task.divisions);
  to.put(task.threads);
  to.put(task.vtk);
  to.put(task.estimate);
  to.put(task.peaks);
  to.put(task.tips);
  to.put(task.bounds);
  to.put(task.copy);
  to.put(task.map);
  put(task.zones.points, to);
  to.put(task.zones.radius);
  to.put(task.floating.motions.size());
  for (const RigidMotion& m : task.floating.motions) {
    put({m.center, m.translation}, to);
    to.put(m.rotation);
  }
  to.put(task.piece);
  to.put(task.contact.size());
  for (const auto& faces : task.contact) to.put(faces);
  to.put(task.floating.pins.size());
  for (const Pin& p : task.floating.pins) {
    put({p.edge[0], p.edge[1]}, to);
    to.put(p.at);
  }
  return std::move(to).take();
}

Task unpacked(std::string_view bytes) {
  Unpacker from(bytes);
  if (from.get<char>() != parts) throw std::logic_error("a task of another kind");
  Task task;
  Mesh& m = task.coarse;
  m.points = points_from(from);
  m.triangles = from.all<std::array<Index, 3>>();
  m.edges = from.all<std::array<Index, 2>>();
  m.edges_of = from.all<std::array<Index, 3>>();
  m.sides = from.all<std::array<Index, 2>>();
  m.label = from.all<Index>();
  m.crack = from.all<Index>();
  m.cracks.resize(from.get<std::size_t>());
  for (auto& path : m.cracks) path = from.all<CrackEdge>();
  m.region = from.all<Index>();
  task.process = from.all<Index>();
  const auto folder = from.all<char>();
  task.folder.assign(folder.begin(), folder.end());
  task.divisions = from.get<int>();
  task.threads = from.get<int>();
  task.vtk = from.get<bool>();
  task.estimate = from.get<bool>();
  task.peaks = from.get<bool>();
  task.tips = from.get<bool>();
  task.bounds = from.get<bool>();
  task.copy = from.get<bool>();
  task.map = from.get<bool>();
  task.zones.points = points_from(from);
  task.zones.radius = from.get<double>();
  task.floating.motions.resize(from.get<std::size_t>());
  for (RigidMotion& m : task.floating.motions) {
    const std::vector<Vec2> both = points_from(from);
    m = {both.at(0), both.at(1), from.get<double>()};
  }
  task.piece = from.all<Index>();
  task.contact.resize(from.get<std::size_t>());
  for (auto& faces : task.contact) faces = from.all<FaceMotion>();
  task.floating.pins.resize(from.get<std::size_t>());
  for (Pin& p : task.floating.pins) {
    const std::vector<Vec2> both = points_from(from);
    p = {{both.at(0), both.at(1)}, from.get<int>()};
  }
  return task;
}

// What all find together.

struct FoundTogether {
  State state;  // certificate and counts alone
  double potential = 0, work = 0, area = 0;
  Index unknowns = 0, interior = 0;
  std::optional<double> error;
  std::optional<EnergyBounds> energy;
  double mean_stress = 0;
  bool has_stress = false;
  std::optional<Peak> von_mises, displacement, strain;
  double beside_chords = 0;  // top_on_chords
  std::vector<LabelResultant> reactions;
  std::vector<std::vector<CrackPoint>> profiles;  // per crack, in the order of its path
  std::vector<std::vector<double>> slips;
  std::vector<TipIntensity> tips;
  std::vector<NamedField> fields, map_fields;  // names, kinds and components of the files
  std::optional<MapResult> map;
  std::vector<std::vector<std::vector<double>>> probes;  // rows of each
  std::vector<CopiedCorner> copied;
  PartedEffort effort;
  ModelSeconds seconds;
};

/// The larger of what the parts have.
std::optional<Peak> largest_of(Peers& peers, const std::optional<Peak>& own) {
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
  for (const Flat& f : gathered(peers, flat)) {
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

std::string piece_name(std::string_view of, Index process) {
  return fmt::format("{}_{:04}.vtu", of, process);
}

/// Leaves names, kinds and components of the fields.
void write_piece(const Task& task, std::string_view name, const OwnPlot& own, Index here,
                 std::vector<NamedField>& fields) {
  const auto triangles = static_cast<Eigen::Index>(own.triangles.size());
  for (NamedField& f : fields)
    f.values =
        f.per_cell ? Eigen::MatrixXd(f.values.leftCols(triangles)) : Eigen::MatrixXd(f.values(Eigen::all, own.corner));
  if (task.vtk)
    write_vtu(std::filesystem::path(task.folder) / piece_name(name, here), own.points, own.triangles, fields);
  for (NamedField& f : fields) f.values.resize(f.values.rows(), 0);
}

/// Least and largest value of each kind of place that may be left out (LeftOut), over all processes: those of the
/// first kind, and of the ones before it, where there are any.
std::array<PlacedValue, 2> extrema(Peers& peers, const OwnPlot& own, const Eigen::VectorXd& values,
                                   const std::vector<LeftOut>& left_out) {
  struct Flat {
    double value = nan, x = 0, y = 0;
  };
  std::vector<Flat> flat(6);  // least and largest, per kind
  for (std::size_t i = 0; i < own.points.size(); ++i) {
    const double v = values[own.corner[i]];
    const Flat here{v, own.points[i].x(), own.points[i].y()};
    for (auto k = static_cast<std::size_t>(left_out[static_cast<std::size_t>(own.corner[i])]); k < 3; ++k) {
      if (std::isfinite(v) && !(v >= flat[2 * k].value)) flat[2 * k] = here;
      if (std::isfinite(v) && !(v <= flat[2 * k + 1].value)) flat[2 * k + 1] = here;
    }
  }
  std::array<PlacedValue, 2> all{PlacedValue{Vec2::Zero(), nan}, PlacedValue{Vec2::Zero(), nan}};
  const std::vector<Flat> every = gathered(peers, flat);
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
std::vector<MapPoint> map_at_points(const Case& c, const Analysis& a, const std::vector<Vec2>& asked, Peers& peers) {
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
  for (const Flat& f : gathered(peers, own)) {
    if (known[static_cast<std::size_t>(f.point)]) continue;
    known[static_cast<std::size_t>(f.point)] = true;
    MapPoint& p = points[static_cast<std::size_t>(f.point)];
    p.value = f.value;
    p.angle = f.angle;
    p.masked = f.masked != 0;
  }
  return points;
}

/// The map of energies, which needs no adjoint.
Mapped map_part(const Case& c, const Task& task, const Model& model, const State& state, const PlotData& data,
                const OwnPlot& own, Peers& peers, FoundTogether& found) {
  Analysis a = analyze(c.functional, model, state);
  Mapped map = make_map({c.functional, c.map_request, {}}, a, data, task.zones);
  double masked = 0;
  for (Index t = 0; t < own_triangles(model); ++t)
    if (map.full.masked_centroid[static_cast<std::size_t>(t)]) masked += area(model.mesh, t);
  MapResult r{.perturbation = std::string(word(c.map_request.perturbation.kind))};
  if (c.map && !c.map->points.empty()) r.points = map_at_points(c, a, c.map->points, peers);
  for (std::size_t k = 0; k < c.probes.size(); ++k) {
    const std::vector<MapPoint> at = map_at_points(c, a, c.probes[k].points, peers);
    for (std::size_t i = 0; i < at.size(); ++i) found.probes[k][i].back() = at[i].value;
  }
  const auto [least, most] = extrema(peers, own, map.full.at_corners, map.left_out_corner);
  r.min = least;
  r.max = most;
  r.excluded_radius = task.zones.radius;
  r.radius = c.map_request.radius;
  r.masked_share = sum(peers, masked) / found.area;
  for (const auto& profile : found.profiles)
    for (const CrackPoint& p : profile)
      if (p.status == CrackPoint::Status::Biactive) r.biactive_length += p.length;
  r.oriented = map.full.angle.size() > 0;
  found.map = std::move(r);
  found.map_fields = map_fields(map);
  write_piece(task, "map", own, peers.here(), found.map_fields);
  return map;
}

/// The rows of probes, of the first process in whose own triangles each point lies; without a map.
void gather_probes(const Case& c, const Model& model, const State& state, Peers& peers, FoundTogether& found) {
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
  std::vector<Flat> all = gathered(peers, own);
  std::ranges::reverse(all);  // the first process has the last word
  for (const Flat& f : all) found.probes[f.probe][f.point].assign(f.row.begin(), f.row.end());
}

/// Per crack what all know of it. `from`: MeshPart::from.
void gather_cracks(const Model& model, const State& state, const std::vector<std::vector<double>>& from, Peers& peers,
                   FoundTogether& found) {
  struct Point {
    CrackPoint p;
    double slip;
  };
  for (Index c = 0; c < static_cast<Index>(model.mesh.cracks.size()); ++c) {
    const auto& path = model.mesh.cracks[static_cast<std::size_t>(c)];
    const std::vector<CrackPoint> profile = crack_profile(model, state, c);
    const bool slides = has_friction(model.scene.laws[static_cast<std::size_t>(c)]);
    const std::vector<double> slip = slides ? slip_profile(model, state, c) : std::vector<double>(profile.size(), 0);
    const std::size_t each = path.empty() ? 0 : profile.size() / path.size();
    std::vector<Point> own;
    double done = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
      const auto e = static_cast<std::size_t>(path[k].edge);
      for (std::size_t i = k * each; model.mesh.sides[e][1] < own_triangles(model) && i < (k + 1) * each; ++i) {
        own.push_back({profile[i], slip[i]});
        own.back().p.s += from[static_cast<std::size_t>(c)][k] - done;
      }
      done += length(model.mesh, path[k].edge);
    }
    std::vector<Point> all = gathered(peers, own);
    std::ranges::stable_sort(all, {}, [](const Point& q) { return q.p.s; });
    auto& points = found.profiles.emplace_back();
    auto& slips = found.slips.emplace_back();
    for (const Point& q : all) {
      points.push_back(q.p);
      if (slides) slips.push_back(q.slip);
    }
  }
}

void sum_reactions(const Model& model, const State& state, std::size_t labels, Peers& peers, FoundTogether& found) {
  std::vector<double> sums(4 * labels, 0);  // whether there are any, force, moment
  for (const LabelResultant& r : reactions(model, state)) {
    double* at = sums.data() + 4 * static_cast<std::size_t>(r.label);
    at[0] += 1;
    at[1] += r.of.force.x();
    at[2] += r.of.force.y();
    at[3] += r.of.moment;
  }
  peers.sum(sums);
  for (std::size_t l = 0; l < labels; ++l) {
    const double* at = sums.data() + 4 * l;
    if (at[0] == 0) continue;
    LabelResultant r{.label = static_cast<Index>(l)};
    r.of.force = Vec2(at[1], at[2]);
    r.of.moment = at[3];
    found.reactions.push_back(r);
  }
}

/// What every process does.
FoundTogether work(const Case& c, Task task, Peers& peers) {
  MeshPart part = mesh_part(task.coarse, task.process, static_cast<int>(peers.count()), peers.here(), task.divisions);
  const SharedTips tips(task.coarse, c.scene, task.divisions);
  const auto whole = task.map || task.copy ? std::make_shared<const Mesh>(std::move(task.coarse)) : nullptr;
  task.coarse = {};
  task.process = {};
  const std::vector<std::vector<double>> from = part.from;
  const std::vector<Index> origin = part.origin;
  SharedBody body(std::move(part), c.element, c.scene, task.threads, task.floating, task.piece, peers, whole);
  const Model& model = body.model();
  State state = body.solve(task.contact);
  FoundTogether found;
  std::array<double, 4> sums{potential_energy(model, state), work_of_loads(model, state), area(model),
                             static_cast<double>(own_triangles(model))};
  peers.sum(sums);
  found.potential = sums[0];
  found.work = sums[1];
  found.area = sums[2];
  const double mean = mean_stress(model, state);
  found.mean_stress = std::sqrt(sum(peers, mean * mean * area(model)) / found.area);
  found.has_stress = sum(peers, has_stress(model, state) ? 1 : 0) > 0;
  found.unknowns = body.unknowns();
  found.interior = static_cast<Index>(interior_count(model.element) * sums[3]);
  found.effort = body.effort();
  found.seconds = model.seconds;
  gather_cracks(model, state, from, peers, found);
  gather_probes(c, model, state, peers, found);
  const Sums over_all{[&peers](std::span<double> v) { peers.sum(v); },
                      [&peers](std::span<double> v) { peers.largest(v); }};
  if (task.tips) found.tips = tips.intensities(model, state, found.profiles, over_all);
  if (task.bounds) found.energy = energy_bounds(model, state, over_all);
  sum_reactions(model, state, c.shape.labels.size(), peers, found);
  Indicator indicator;
  if (task.estimate && can_estimate_error(model.element)) {
    indicator = error_indicator(model, state);
    std::array<double, 2> squares{indicator.error, indicator.stress};
    peers.sum(squares);
    if (squares[1] > 0) found.error = std::sqrt(squares[0] / squares[1]);
  }
  if (task.vtk || task.peaks || task.map || task.copy) {
    const PlotData data = plot_data(model, state, c.plane_strain);
    const OwnPlot own = own_plot(data, own_triangles(model));
    if (task.peaks) {
      found.von_mises = largest_of(peers, peak(own.points, data.von_mises(own.corner), task.zones));
      const Eigen::VectorXd moved = data.values.displacement.colwise().norm().transpose();
      found.displacement = largest_of(peers, peak(own.points, moved(own.corner), {}));
      const Eigen::VectorXd strained = principal_strains(model, data);
      found.strain = largest_of(peers, peak(own.points, strained(own.corner), task.zones));
      if (const auto top = found.von_mises ? top_on_chords(c, *found.von_mises) : std::nullopt)
        found.beside_chords =
            std::ranges::max(gathered(peers, std::vector{beside(model, state, data, c.plane_strain, top->at)}));
    }
    found.fields = state_fields(model, state, data, indicator);
    write_piece(task, "state", own, peers.here(), found.fields);
    const std::optional<Mapped> map =
        task.map ? std::optional(map_part(c, task, model, state, data, own, peers, found)) : std::nullopt;
    if (task.copy)
      found.copied = gathered(
          peers, copied_corners(*whole, origin, own_triangles(model), model.mesh, data, map ? &*map : nullptr));
  }
  found.state.certificate = state.certificate;
  found.state.converged = state.converged;
  found.state.contact_iterations = state.contact_iterations;
  found.state.linear_solves = state.linear_solves;
  found.state.seconds = state.seconds;
  return found;
}

// Of the first process.

/// Throws Error(Usage) for what needs more of the whole than the sums of its parts.
void refuse(const Model& coarse, const Case& c, bool with_map) {
  const auto fail = [&](const std::string& why) {
    throw Error(Fault::Usage,
                fmt::format("{}: on several processes none has the whole of a divided mesh, and {}; use a "
                            "smaller mesh.size instead",
                            place_of(c, "mesh.refine"), why));
  };
  if (!coarse.inner->standing.empty()) fail("what contact alone holds is known of the whole alone");
  if (coarse.inner->system.penalty > 0 && has_free_pressure(coarse.mesh, coarse.scene, coarse.inner->skeleton))
    fail("the level of the pressure in an enclosed incompressible body is that of the whole");
  for (const Term& term : c.functional.terms)
    if (!term.energy && !term.work && !term.volume)
      fail(fmt::format("functional \"{}\" is not evaluated there (energy, compliance and volume are)", term.kind));
  if (!with_map) return;
  require_supports(c.functional, coarse);
  if (std::ranges::any_of(c.functional.terms, &Term::volume)) fail("the map of a volume is not made there");
  const bool works = std::ranges::any_of(c.functional.terms, &Term::work);
  if ((works && !has_self_adjoint_work(coarse)) || has_frictional_cracks(c.scene))
    fail("a map that needs an adjoint (friction, compliances with prescribed displacements) is not made there");
  if (!has_series(c.map_request.perturbation)) fail("the map of clamped holes takes solves of the whole");
  if (c.map_request.second) fail("the second term takes solves of the whole");
}

/// The body before its mesh is divided, graded at the ends of contact: a model without a factor, and what the faces do
/// there.
struct Undivided {
  Model model;
  ContactGuess contact;
};
Undivided undivided(const Case& c, const Journal& journal) {
  const int threads = journal.options.threads;
  Undivided u;
  Mesh mesh;
  if (may_touch(c.scene)) {
    const Adapted a = solve_graded(c.shape, c.sizing, c.element, c.scene,
                                   {.contact = c.contact, .estimate = false, .threads = threads, .given = c.mesh});
    u.contact = contact_guess(a.model, a.state);
    mesh = a.model.mesh;
  } else {
    mesh = c.mesh ? *c.mesh : triangulate(c.shape, c.sizing);
  }
  u.model = prepare(std::move(mesh), c.element, c.scene, threads, {.factorize = false});
  return u;
}

/// What limits the map, which is that of the body and not of its mesh.
std::vector<std::string> limits_before_division(const Case& c, const Undivided& u, const MapResult& map, int threads) {
  if (!may_answer_by_pressure(u.model.scene)) return {};
  const Model model = prepare(u.model.mesh, c.element, c.scene, threads);
  const State state = solve(model, c.contact);
  return limits_of_map({c.functional, c.map_request, {}}, analyze(c.functional, model, state), map);
}

/// Numbers of the mesh divided so many times: its triangles are similar to those before.
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

/// The pictures, and the map for the page.
void draw(const Case& c, const Result& r, CoarseCopy& copy, Journal& journal) {
  const Model& model = copy.adapted.model;
  journal.picture("mesh.png", [&] { return mesh_picture(journal.title, model.mesh); });
  journal.picture("von_mises.png", [&] { return stress_picture(journal.title, model, copy.data); });
  if (!r.map) return;
  copy.map.result = *r.map;
  static const std::vector<Vec2> everywhere;
  const MapTask task{c.functional, c.map_request, c.map ? c.map->points : everywhere};
  journal.picture("map.png", [&] { return map_picture(journal.title, task, model, copy.data, copy.map); });
  if (journal.html) add_map(journal.arrays, task, copy.map, model, copy.data);
}

Analysis analyzed(const Functional& j, const FoundTogether& found) {
  Analysis a{};
  for (const Term& term : j.terms) {
    a.term_value.push_back(std::pow(term.energy ? found.potential : term.work ? found.work : found.area, term.power));
    a.value += term.factor * a.term_value.back();
  }
  return a;
}

}  // namespace

void work_on_part(const Case& c, std::string_view task, Peers& peers) {
  work(c, unpacked(task), peers);
}

CoarseCopy solve_in_parts(const Case& c, bool with_map, Processes& processes, Journal& journal, Result& r) {
  journal.begin("mesh");
  const std::shared_ptr<Ranks> ranks = processes.ranks(c.petsc);
  Task task{.folder = std::filesystem::absolute(journal.options.folder).string(),
            .divisions = c.divisions,
            .threads = journal.options.threads,
            .vtk = journal.vtk,
            .estimate = c.output.estimate,
            .peaks = c.output.peaks,
            .tips = c.output.tips,
            .bounds = c.output.energy_bounds,
            .copy = journal.png || journal.html,
            .map = with_map};
  Undivided before = undivided(c, journal);
  const Model& coarse = before.model;
  refuse(coarse, c, with_map);
  if (coarse.mesh.triangles.size() < least_of_part * static_cast<std::size_t>(processes.count()))
    throw Error(Fault::Usage,
                fmt::format("{}: {} triangles before they are divided are too few for {} processes; use a "
                            "smaller mesh.size, or fewer processes",
                            place_of(c, "mesh.refine"), coarse.mesh.triangles.size(), processes.count()));
  describe_divided(coarse.mesh, c.divisions, r);
  task.process = shares(coarse, *ranks);
  task.coarse = coarse.mesh;
  task.floating = floating_of(coarse, c.divisions);
  task.contact = before.contact;
  task.piece = pieces_for_pressure(coarse.mesh, c.scene);
  if (task.peaks || task.map) task.zones = singular_zones(coarse, extent(c.shape));
  const SingularZones zones = task.peaks ? task.zones : SingularZones{};
  journal.seconds.mesh += journal.lap();

  journal.begin("solve in parts");
  FoundTogether found;
  processes.work(packed(task), [&](Peers& peers) { found = work(c, std::move(task), peers); });
  journal.seconds.assemble += found.seconds.assemble;
  journal.seconds.contact += found.state.seconds.contact;
  journal.seconds.solve += journal.lap() - found.seconds.assemble - found.state.seconds.contact;

  StateResult& s = r.state.emplace();
  s.element = c.element.name;
  s.degree = c.element.degree;
  s.condensed_unknowns = found.unknowns;
  s.unknowns = found.unknowns + found.interior;
  s.residual = found.state.certificate.residual;
  s.work_error = found.state.certificate.work;
  s.energy = found.potential;
  s.compliance = found.work;
  s.area = found.area;
  require_energy(s.energy, found.has_stress);
  s.estimated_error = found.error;
  s.von_mises = found.von_mises;
  s.displacement = found.displacement;
  s.thickness = c.thickness;
  s.notes = coarse.notes;
  if (const std::string note = lost_digits(found.state); !note.empty()) s.notes.push_back(note);
  for (const std::string& note : notes_on_data(coarse.mesh, c.scene, coarse.inner->data, c.shape))
    s.notes.push_back(note);
  if (const std::string odd = implausible(c.units, c.young); !odd.empty()) s.notes.push_back(odd);
  const std::vector<std::string> about_mesh = c.mesh ? notes_on_file(c) : crowded_tips(c.shape, c.sizing);
  s.notes.insert(s.notes.end(), about_mesh.begin(), about_mesh.end());
  for (const std::string& note : notes_on_size(found.strain, found.displacement, extent(c.shape)))
    s.notes.push_back(note);
  if (const auto top = s.von_mises ? top_on_chords(c, *s.von_mises) : std::nullopt)
    if (const std::string note = note_on_chords(c, *top, found.beside_chords); !note.empty()) s.notes.push_back(note);
  if (c.output.tips && (std::ranges::any_of(c.scene.laws, has_pressure) || has_eigenstrain(c.scene)))
    s.notes.emplace_back("no K, G and T in parts at tips of cracks with a fluid pressure or with an eigenstrain");
  s.notes.emplace_back(
      "solved in parts, of which no process has the whole: pictures and page show it at the corners of the mesh before "
      "it was divided; state.pvtu has the fields");
  if (found.energy) add_energy_bounds(*found.energy, s);
  add_resultants(coarse, found.reactions, c.shape, s);
  r.solver = solver_result(found.effort);
  for (std::size_t k = 0; k < found.profiles.size(); ++k)
    r.cracks.push_back(crack_result(c.shape.cracks[k].name, c.scene.laws[k], found.profiles[k], found.slips[k]));
  for (const TipIntensity& tip : found.tips)
    r.cracks[static_cast<std::size_t>(tip.crack)].tips.push_back(tip_result(tip));
  add_pressures(zones, r.cracks);
  for (const std::string& note : notes_on_faces(r.cracks, c.scene)) s.notes.push_back(note);
  ContactMeasures contact{.stress = found.mean_stress, .profiles = std::move(found.profiles)};
  for (Index k = 0; k < static_cast<Index>(r.cracks.size()); ++k) contact.modulus.push_back(modulus_beside(coarse, k));
  for (const std::string& note : notes_on_contact(r.cracks, contact)) s.notes.push_back(note);
  if (may_touch(c.scene)) r.contact = contact_result(found.state, ContactMethod::ActiveSet, r.cracks);
  r.functional = functional_result(c.functional, analyzed(c.functional, found));
  if (!certified(found.state)) {
    r.status = "not converged";
    r.reason = failure(coarse, found.state);
  }
  journal.begin("write the state");
  const auto write_grid = [&](const std::string& name, const std::vector<NamedField>& fields) {
    std::vector<std::string> pieces;
    for (Index p = 0; p < static_cast<Index>(processes.count()); ++p) pieces.push_back(piece_name(name, p));
    if (journal.vtk) write_pvtu(journal.file(name + ".pvtu"), pieces, fields);
  };
  write_grid("state", found.fields);
  if (found.map) {
    r.map = std::move(found.map);
    for (std::string& note : limits_before_division(c, before, *r.map, journal.options.threads))
      s.notes.push_back(std::move(note));
    write_grid("map", found.map_fields);
    if (!r.map->points.empty())
      write_map_files(journal, {c.functional, c.map_request, c.map->points}, {.result = *r.map}, {}, {});
  }
  write_crack_files(journal, r.cracks);
  for (std::size_t k = 0; k < c.probes.size(); ++k)
    write_probe_file(journal, c.probes[k], std::move(found.probes[k]), {});
  CoarseCopy copy = coarse_copy(std::move(before.model), found.copied);
  draw(c, r, copy, journal);
  journal.seconds.output += journal.lap();
  return copy;
}

}  // namespace kerf
