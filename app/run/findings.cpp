// What is found of a solved body, by one process or by several. Each process measures what it has, all of the body or
// its own triangles, and all put it together by the communicator, whose one-process form costs nothing. Numbers of the
// body are sums over own triangles (energies, area, reactions) or largest values. What stands at points (peaks,
// profiles of cracks, probes, maps at points) is gathered as flat records; of several processes that have the same
// point the first one counts. Arc length along a crack is summed from the lengths of all its edges, put in the order of
// the undivided path. Every process must come by every collective call, whatever it finds on its part: decisions are
// made of what all know. docs/theory/elements.md, "Solving in parts".

#include "app/run/findings.hpp"

#include "app/run/collect.hpp"
#include "app/run/margins.hpp"
#include "app/run/notes.hpp"
#include "app/run/reserve.hpp"
#include "app/run/solve.hpp"
#include "app/write/files.hpp"
#include "kerf/fracture.hpp"
#include "solver/half_cracks.hpp"
#include "solver/history.hpp"
#include "solver/recovery.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"
#include "topo/analysis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace kerf {

SolvedPart whole(const Case& c, const Model& model, const State& state, const Indicator& indicator) {
  static Alone alone;
  return {.model = model,
          .state = state,
          .indicator = indicator,
          .comm = alone,
          .tips = ends_inside(model.mesh),
          .of_polygon = is_of_polygon(c.shape, model.mesh),
          .intensities = [&model, &state](const auto&) { return crack_tips(model, state); },
          .energy_bounds = [&model, &state] { return energy_bounds(model, state); }};
}

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

namespace {

bool has_all(const SolvedPart& s) {
  return s.comm.count() == 1;
}

/// Whether a corner is one of an own triangle.
std::vector<bool> own_corners(const Model& model, const PlotData& data) {
  std::vector<bool> own(data.points.size(), false);
  for (Index t = 0; t < own_triangles(model); ++t)
    for (const Index corner : data.corners.of[static_cast<std::size_t>(t)])
      own[static_cast<std::size_t>(corner)] = true;
  return own;
}

/// Smallest and largest of the finite values seen.
struct Extrema {
  struct Flat {
    double value = nan, x = 0, y = 0;
    PlacedValue placed() const {
      return {Vec2(x, y), value};
    }
  };
  Flat min{}, max{};
  void see(const Flat& f) {
    if (!std::isfinite(f.value)) return;
    if (!(f.value >= min.value)) min = f;
    if (!(f.value <= max.value)) max = f;
  }
};

/// Of the values at corners that are left out for no stronger reason than is needed to have any, over all processes.
Extrema extrema(const Model& model, const PlotData& data, const Mapped& map, Communicator& comm) {
  const std::vector<bool> own = own_corners(model, data);
  std::vector<Extrema> here(3);  // the places that are left out for this reason or a weaker one
  for (std::size_t i = 0; i < own.size(); ++i)
    for (auto k = static_cast<std::size_t>(map.left_out_corner[i]); own[i] && k < here.size(); ++k)
      here[k].see({map.full.at_corners[static_cast<Eigen::Index>(i)], data.points[i].x(), data.points[i].y()});
  const std::vector<Extrema> all = gathered(comm, here);
  Extrema e;
  for (std::size_t k = 0; k < here.size() && !std::isfinite(e.min.value); ++k)
    for (std::size_t i = k; i < all.size(); i += here.size()) {
      e.see(all[i].min);
      e.see(all[i].max);
    }
  return e;
}

/// Per point the own triangle in which it lies, or none.
std::vector<Index> locate_own(const Model& model, const Locator& locator, const std::vector<Vec2>& points) {
  std::vector<Index> where;
  for (const Vec2& x : points) {
    const Index t = locate(model.mesh, locator, x);
    where.push_back(t < own_triangles(model) ? t : none);
  }
  return where;
}

/// Of each point what the first process has, of those that have it; `own`: of some of them.
template <typename T>
void gather_first(Communicator& comm, const std::vector<T>& own, std::vector<T>& all) {
  std::vector<bool> known(all.size(), false);
  for (const T& f : gathered(comm, own))
    if (auto&& seen = known[static_cast<std::size_t>(f.point)]; !seen) {
      seen = true;
      all[static_cast<std::size_t>(f.point)] = f;
    }
}

std::vector<MapPoint> map_at_points(const Analysis& a, const Functional& j, const MapRequest& request,
                                    const std::vector<Vec2>& asked, Communicator& comm) {
  if (comm.count() == 1) return map_at(a, j, request, asked);
  struct Flat {
    Index point;
    double value = nan, angle = 0;
    char masked = 1;
  };
  std::vector<Index> mine;
  std::vector<Vec2> at;
  const std::vector<Index> where = locate_own(*a.model, make_locator(a.model->mesh), asked);
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (where[i] != none) {
      mine.push_back(static_cast<Index>(i));
      at.push_back(asked[i]);
    }
  std::vector<Flat> own, all;
  const std::vector<MapPoint> found = at.empty() ? std::vector<MapPoint>() : map_at(a, j, request, at);
  for (std::size_t i = 0; i < found.size(); ++i)
    own.push_back({mine[i], found[i].value, found[i].angle, static_cast<char>(found[i].masked)});
  for (std::size_t i = 0; i < asked.size(); ++i) all.push_back({.point = static_cast<Index>(i)});
  gather_first(comm, own, all);
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < asked.size(); ++i)
    points.push_back({.at = asked[i], .value = all[i].value, .angle = all[i].angle, .masked = all[i].masked != 0});
  return points;
}

/// Per edge of a crack how far along its curve it begins, by how far that is along all chords.
std::map<double, double> begins(const Model& model, Index crack, const std::vector<bool>& own,
                                const std::vector<double>& order, Communicator& comm) {
  struct Edge {
    double from, length;
  };
  const auto& path = model.mesh.cracks[static_cast<std::size_t>(crack)];
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < path.size(); ++k)
    if (own[k]) edges.push_back({order[k], length_along(model, path[k].edge)});
  edges = gathered(comm, edges);
  std::ranges::sort(edges, {}, &Edge::from);
  std::map<double, double> begin;
  double sum = 0;
  for (const Edge& e : edges) {
    begin[e.from] = sum;
    sum += e.length;
  }
  return begin;
}

struct Profile {
  std::vector<CrackPoint> points;
  std::vector<double> slip;  // with friction
};

Profile gather_profile(const SolvedPart& s, Index crack, Profile here) {
  struct Point {
    CrackPoint p;
    double slip;
  };
  const Model& model = s.model;
  const auto& path = model.mesh.cracks[static_cast<std::size_t>(crack)];
  const bool slides = !here.slip.empty() || has_friction(model.scene.laws[static_cast<std::size_t>(crack)]);
  const std::size_t each = path.empty() ? 0 : here.points.size() / path.size();
  const std::vector<double>& order = (*s.from)[static_cast<std::size_t>(crack)];
  std::vector<bool> is_own;
  for (const CrackEdge& e : path)
    is_own.push_back(model.mesh.sides[static_cast<std::size_t>(e.edge)][1] < own_triangles(model));
  const std::map<double, double> begin = begins(model, crack, is_own, order, s.comm);
  std::vector<Point> own;
  double done = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    for (std::size_t i = k * each; is_own[k] && i < (k + 1) * each; ++i) {
      own.push_back({here.points[i], slides ? here.slip[i] : 0});
      own.back().p.s += begin.at(order[k]) - done;
    }
    done += length_along(model, path[k].edge);
  }
  std::vector<Point> all = gathered(s.comm, own);
  std::ranges::stable_sort(all, {}, [](const Point& q) { return q.p.s; });
  Profile found;
  for (const Point& q : all) {
    found.points.push_back(q.p);
    if (slides) found.slip.push_back(q.slip);
  }
  return found;
}

Profile profile_of(const SolvedPart& s, Index crack) {
  Profile here{crack_profile(s.model, s.state, crack), {}};
  if (has_friction(s.model.scene.laws[static_cast<std::size_t>(crack)]))
    here.slip = slip_profile(s.model, s.state, crack);
  return has_all(s) ? here : gather_profile(s, crack, std::move(here));
}

std::vector<LabelResultant> find_reactions(const SolvedPart& s, std::size_t labels) {
  const std::vector<LabelResultant> own = reactions(s.model, s.state);
  if (has_all(s)) return own;
  std::vector<double> sums(4 * labels, 0);  // whether there are any, force, moment
  for (const LabelResultant& r : own) {
    double* at = sums.data() + 4 * static_cast<std::size_t>(r.label);
    at[0] += 1;
    at[1] += r.of.force.x();
    at[2] += r.of.force.y();
    at[3] += r.of.moment;
  }
  s.comm.sum(sums);
  std::vector<LabelResultant> all;
  for (std::size_t l = 0; l < labels; ++l) {
    const double* at = sums.data() + 4 * l;
    if (at[0] != 0) all.push_back({static_cast<Index>(l), {Vec2(at[1], at[2]), at[3]}});
  }
  return all;
}

/// Pieces that contact alone holds are settled in one way, whatever was asked for, and so are large contact and parts.
ContactMethod method_of(const Case& c, const Model& model) {
  if (model.inner->own || has_large_contact(model) || c.backend == Backend::Umfpack) return ContactMethod::ActiveSet;
  return model.inner->semicoercive.empty() ? c.contact : ContactMethod::DualQp;
}

}  // namespace

void find_numbers(const Case& c, const SolvedPart& s, Findings& found) {
  const Element& e = s.model.inner->kernel.element;
  const Skeleton& skeleton = s.model.inner->skeleton;
  Index rows = 0;
  for (Index u = 0; u < skeleton.total; ++u)
    if (s.model.inner->ordering.row[u] != none && owns(s.model, u)) ++rows;
  std::array<double, 6> sums{potential_energy(s.model, s.state),
                             work_of_loads(s.model, s.state),
                             area(s.model),
                             static_cast<double>(own_triangles(s.model)),
                             static_cast<double>(rows),
                             has_stress(s.model, s.state) ? 1.0 : 0.0};
  s.comm.sum(sums);
  StateResult& r = found.state;
  r.element = e.name;
  r.degree = e.degree;
  r.condensed_unknowns = static_cast<Index>(sums[4]);
  r.unknowns = r.condensed_unknowns + interior_count(e) * static_cast<Index>(sums[3]);
  r.residual = s.state.certificate.residual;
  r.work_error = s.state.certificate.work;
  r.energy = sums[0];
  r.compliance = sums[1];
  r.area = sums[2];
  if (s.indicator.eta.size() > 0 && std::isfinite(s.indicator.relative)) r.estimated_error = s.indicator.relative;
  r.thickness = c.thickness;
  r.of_polygon = s.of_polygon;
  found.has_stress = sums[5] > 0;
  found.solved.certificate = s.state.certificate;
  found.solved.converged = s.state.converged;
  found.solved.contact_iterations = s.state.contact_iterations;
  found.solved.linear_solves = s.state.linear_solves;
  found.solved.seconds = s.state.seconds;
  found.reactions = find_reactions(s, c.shape.labels.size());
}

std::vector<CrackResult> find_cracks(const Case& c, const SolvedPart& s, bool with_tips, Findings& found) {
  const std::size_t per_edge = static_cast<std::size_t>(s.model.inner->skeleton.per_edge) / 2;
  std::vector<CrackResult> cracks;
  found.profiles.clear();
  for (std::size_t k = 0; k < s.model.mesh.cracks.size(); ++k) {
    Profile profile = profile_of(s, static_cast<Index>(k));
    cracks.push_back(crack_result(c.shape.cracks[k].name, s.model.scene.laws[k], profile.points, profile.slip,
                                  {s.tips[k], per_edge}));
    found.profiles.push_back(std::move(profile.points));
  }
  if (with_tips)
    for (const TipIntensity& tip : s.intensities(found.profiles))
      cracks[static_cast<std::size_t>(tip.crack)].tips.push_back(tip_result(tip));
  if (has_all(s)) add_half_cracks(s.model, s.state, c.shape, c.planes, with_tips, cracks);
  return cracks;
}

Findings find_state(const Case& c, const SolvedPart& s, Seconds& seconds) {
  Stopwatch watch;
  Findings found;
  find_numbers(c, s, found);
  found.method = method_of(c, s.model);
  seconds.recover += watch.lap();
  if (c.output.energy_bounds) {
    found.energy = s.energy_bounds();
    seconds.energy_bounds += watch.lap();
  }
  found.cracks = find_cracks(c, s, c.output.tips, found);
  (c.output.tips && !found.cracks.empty() ? seconds.tips : seconds.recover) += watch.lap();
  if (turn_often(found.cracks)) {
    const double mean = mean_stress(s.model, s.state);
    found.mean_stress = std::sqrt(sum(s.comm, mean * mean * area(s.model)) / found.state.area);
  }
  seconds.recover += watch.lap();
  return found;
}

void find_peaks(const Case& c, const SolvedPart& s, const PlotData& data, const SingularZones& zones, Findings& found) {
  const std::vector<bool> own = own_corners(s.model, data);
  const auto largest = [&](Eigen::VectorXd values, const SingularZones& left_out) {
    for (std::size_t i = 0; i < own.size(); ++i)
      if (!own[i]) values[static_cast<Eigen::Index>(i)] = nan;
    return largest_of(s.comm, peak(data.points, values, left_out));
  };
  StateResult& r = found.state;
  r.von_mises = largest(data.von_mises, zones);
  if (r.von_mises && !s.of_polygon)  // corners of chords have a note
    refine_peak(s, data, c.plane_strain, zones, own, *r.von_mises);
  r.displacement = largest(data.values.displacement.colwise().norm().transpose(), {});
  found.strain = largest(principal_strains(s.model, data), zones);
  const std::size_t per_edge = static_cast<std::size_t>(s.model.inner->skeleton.per_edge) / 2;
  add_pressures({s.tips, per_edge, zones.points, extent(c.shape)}, found.cracks);
  if (const auto top = r.von_mises ? top_on_chords(c, *r.von_mises) : std::nullopt)
    found.beside_chords =
        std::ranges::max(gathered(s.comm, std::vector{beside(s.model, s.state, data, c.plane_strain, top->at)}));
  r.reserves = reserves_of(c, s, data, zones, found);
}

Mapped find_map(const MapTask& task, Analysis& analysis, const PlotData& data, const SingularZones& zones,
                Communicator& comm) {
  Mapped map = make_map(task, analysis, data, zones);
  const Model& model = *analysis.model;
  MapResult& r = map.result;
  r.perturbation = word(task.request.perturbation.kind);
  if (!task.points.empty()) r.points = map_at_points(analysis, task.functional, task.request, task.points, comm);
  Extrema e;
  if (is_everywhere(map.full))
    e = extrema(model, data, map, comm);
  else
    for (const MapPoint& p : r.points) e.see({p.value, p.at.x(), p.at.y()});
  r.min = e.min.placed();
  r.max = e.max.placed();
  r.radius = task.request.radius;
  r.biactive_length = analysis.biactive_length;
  if (!is_everywhere(map.full)) return map;
  r.excluded_radius = zones.largest();
  std::array<double, 3> sums{0, area(model), 0};  // masked, of all, how many triangles are not
  for (Index t = 0; t < own_triangles(model); ++t)
    (map.full.masked_centroid[static_cast<std::size_t>(t)] ? sums[0] : sums[2]) +=
        map.full.masked_centroid[static_cast<std::size_t>(t)] ? cell_area(model, t) : 1;
  comm.sum(sums);
  r.masked_share = sums[0] / sums[1];
  if (sums[2] == 0) r.min = r.max = {Vec2::Constant(nan), nan};  // extrema of nothing
  r.oriented = map.full.angle.size() > 0;
  r.second = map.full.c2.size() > 0 && map.full.second_note.empty();
  return map;
}

std::vector<std::vector<std::vector<double>>> find_probes(const Case& c, const SolvedPart& s, const MapTask& task,
                                                          const Analysis* analysis) {
  struct Row {
    Index point;
    std::array<double, 8> of;
  };
  std::vector<std::vector<std::vector<double>>> found;
  if (c.probes.empty()) return found;
  const Locator locator = make_locator(s.model.mesh);
  for (const Probe& probe : c.probes) {
    const std::vector<Index> where = locate_own(s.model, locator, probe.points);
    std::vector<Row> own, all;
    for (std::size_t i = 0; i < where.size(); ++i) {
      all.push_back({static_cast<Index>(i), probe_row(s.model, s.state, none, probe.points[i])});
      if (where[i] != none)
        own.push_back({static_cast<Index>(i), probe_row(s.model, s.state, where[i], probe.points[i])});
    }
    gather_first(s.comm, own, all);
    auto& rows = found.emplace_back();
    for (const Row& row : all) rows.emplace_back(row.of.begin(), row.of.end());
    if (!analysis) continue;
    MapRequest request = task.request;
    request.bounds = request.second = false;
    const std::vector<MapPoint> map = map_at_points(*analysis, task.functional, request, probe.points, s.comm);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].back() = map[i].value;
  }
  return found;
}

}  // namespace kerf
