#include "app/collect.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include "io/validation.hpp"
#include "kerf/fracture.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace kerf {

namespace {

// Von Mises stress with s_zz = nu (s_xx + s_yy) in plane strain, 0 in plane stress. 4 mu c = 1 - 2 nu in plane strain.
double von_mises(const Material& m, bool plane_strain, const Eigen::Vector4d& s) {
  const double mean = 0.5 * (s[0] + s[3]), difference = 0.5 * (s[0] - s[3]), shear = 0.5 * (s[1] + s[2]);
  const double share = plane_strain ? 4 * m.mu * m.c : 1;
  return std::sqrt(share * share * mean * mean + 3 * (difference * difference + shear * shear));
}

}  // namespace

PlotData plot_data(const Model& model, const State& state, bool plane_strain) {
  PlotData d;
  d.corners = split_for_stress(model.mesh);
  const std::vector<Material> materials = corner_materials(model, d.corners);
  for (const Index v : d.corners.vertex) d.points.push_back(model.mesh.points[v]);
  d.values = corner_values(model, state, d.corners);
  d.von_mises.resize(d.values.stress.cols());
  for (Eigen::Index i = 0; i < d.von_mises.size(); ++i)
    d.von_mises[i] = von_mises(materials[i], plane_strain, d.values.stress.col(i));
  return d;
}

StateResult state_result(const Model& model, const State& state, const Indicator& indicator,
                         const EnergyBounds& bounds) {
  StateResult r;
  r.element = model.inner->kernel.element.name;
  r.degree = model.inner->kernel.element.degree;
  r.condensed_unknowns = model.inner->ordering.size;
  r.unknowns = model.inner->ordering.size +
               interior_count(model.inner->kernel.element) * static_cast<Index>(model.mesh.triangles.size());
  r.residual = state.certificate.residual;
  r.energy = potential_energy(model, state);
  r.compliance = work_of_loads(model, state);
  r.area = area(model);
  if (std::isfinite(indicator.relative)) r.estimated_error = indicator.relative;
  r.notes = model.notes;
  if (std::isfinite(bounds.lower) && std::isfinite(bounds.upper)) r.energy_bounds = {bounds.lower, bounds.upper};
  if (!bounds.note.empty()) r.notes.push_back(bounds.note);
  return r;
}

std::vector<CrackResult> crack_results(const Model& model, const State& state, const Shape& shape) {
  std::vector<CrackResult> results;
  const std::vector<TipIntensity> tips = crack_tips(model, state);
  const auto word = [](CrackPoint::Status s) { return s == CrackPoint::Status::Closed ? "closed" : "open"; };
  for (Index c = 0; c < static_cast<Index>(model.mesh.cracks.size()); ++c) {
    CrackResult r;
    r.name = shape.cracks[c].name;
    const std::vector<CrackPoint> profile = crack_profile(model, state, c);
    for (std::size_t i = 0; i < profile.size(); ++i) {
      const CrackPoint& p = profile[i];
      const bool closed = p.status == CrackPoint::Status::Closed;
      r.length += p.length;
      (closed ? r.closed_length : p.status == CrackPoint::Status::Open ? r.open_length : r.biactive_length) += p.length;
      r.max_opening = std::max(r.max_opening, p.jump_n);
      if (p.status == CrackPoint::Status::Open) r.penetration = std::max(r.penetration, -p.jump_n);
      r.max_pressure = std::max(r.max_pressure, -p.sigma_n);
      r.rows.push_back({p.s, p.at, p.jump_n, p.jump_t, p.sigma_n, p.sigma_t, closed});
      if (i > 0 && (profile[i - 1].status == CrackPoint::Status::Closed) != closed)
        r.transitions.push_back({0.5 * (profile[i - 1].at + p.at), word(profile[i - 1].status), word(p.status)});
    }
    if (model.scene.laws[c].kind != CrackLaw::Kind::Unilateral) r.open_length = r.closed_length = r.biactive_length = 0;
    for (const TipIntensity& t : tips)
      if (t.crack == c) {
        TipResult tip{.at = t.at};
        if (std::isfinite(t.K_I)) {
          tip.K_I = t.K_I, tip.K_II = t.K_II, tip.G = t.G, tip.T = t.T;
          tip.spread = {t.spread_K_I, t.spread_K_II, t.spread_T};
        }
        r.tips.push_back(tip);
      }
    results.push_back(std::move(r));
  }
  return results;
}

ContactResultSummary contact_result(const State& state, ContactMethod method, const std::vector<CrackResult>& cracks) {
  ContactResultSummary r{.method = std::string(word(method)),
                         .iterations = state.contact_iterations,
                         .linear_solves = state.linear_solves,
                         .kkt = state.certificate.kkt};
  for (const CrackResult& c : cracks) {
    r.open_length += c.open_length;
    r.closed_length += c.closed_length;
    r.biactive_length += c.biactive_length;
  }
  return r;
}

std::vector<Vec2> singular_points(const Model& model) {
  const Mesh& mesh = model.mesh;
  std::set<Index> vertices;
  std::vector<Index> crack_at(mesh.points.size(), none);
  for (std::size_t number = 0; number < mesh.cracks.size(); ++number) {
    const auto& crack = mesh.cracks[number];
    for (const CrackEdge& c : crack)
      for (const Index v : mesh.edges[c.edge]) {
        if (crack_at[v] != none && crack_at[v] != static_cast<Index>(number)) vertices.insert(v);  // a junction
        crack_at[v] = static_cast<Index>(number);
      }
    for (std::size_t i = 0; i < crack.size(); ++i) {
      const auto start = [&](std::size_t k) { return mesh.edges[crack[k].edge][crack[k].forward ? 0 : 1]; };
      if (i == 0) {
        vertices.insert(start(0));
        vertices.insert(mesh.edges[crack.back().edge][crack.back().forward ? 1 : 0]);
        continue;
      }
      const Vec2 before = mesh.points[start(i)] - mesh.points[start(i - 1)];
      const Index end = mesh.edges[crack[i].edge][crack[i].forward ? 1 : 0];
      const Vec2 after = mesh.points[end] - mesh.points[start(i)];
      constexpr double kink = 0.05;                   // radians
      if (model.scene.laws[number].normal) continue;  // a curve
      if (std::abs(std::atan2(cross(before, after), before.dot(after))) > kink) vertices.insert(start(i));
    }
  }
  // Corners between materials; polygonal arcs turn by less per vertex.
  std::vector<std::vector<Vec2>> interfaces(mesh.points.size());
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()) && !mesh.region.empty(); ++e)
    if (is_interface(mesh, e))
      for (int end = 0; end < 2; ++end)
        interfaces[mesh.edges[e][end]].push_back((end == 0 ? 1 : -1) * tangent(mesh, e));
  for (std::size_t v = 0; v < interfaces.size(); ++v) {
    constexpr double straight = -0.94;  // cosine of 160 degrees
    if (interfaces[v].size() == 2 && interfaces[v][0].dot(interfaces[v][1]) > straight)
      vertices.insert(static_cast<Index>(v));
  }
  // Boundary vertices: interior angle, and whether the two edges are held in the same way.
  std::vector<double> angle(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const Vec2 a = mesh.points[t[(i + 1) % 3]] - mesh.points[t[i]],
                 b = mesh.points[t[(i + 2) % 3]] - mesh.points[t[i]];
      angle[t[i]] += std::atan2(cross(a, b), a.dot(b));
    }
  std::vector<int> held(mesh.points.size(), -1);
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.sides[e][0] != none && mesh.sides[e][1] != none) continue;
    int kind = 0;  // which components are held
    for (const Support& support : model.scene.supports)
      if (support.label == mesh.label[e]) kind += (support.first ? 1 : 0) + (support.second ? 2 : 0);
    for (const Index v : mesh.edges[e]) {
      constexpr double reentrant = 200 * std::numbers::pi / 180;  // polygonal arcs turn by less per vertex
      if (angle[v] > reentrant || (held[v] >= 0 && held[v] != kind)) vertices.insert(v);
      held[v] = kind;
    }
  }
  std::vector<Vec2> points;
  for (const Index v : vertices) points.push_back(mesh.points[v]);
  return points;
}

Extrema extrema(const Model& model, const FullMap& map, const std::vector<Vec2>& singular, double radius) {
  const Eigen::VectorXd& values = map.at_centroids;
  for (const bool with_masked : {false, true}) {
    Extrema e;
    bool any = false;
    for (Index t = 0; t < static_cast<Index>(values.size()); ++t) {
      if (!std::isfinite(values[t]) || (!with_masked && map.masked_centroid[static_cast<std::size_t>(t)])) continue;
      const Vec2 x = centroid(model.mesh, t);
      bool near = false;
      for (const Vec2& p : singular) near = near || (x - p).squaredNorm() < radius * radius;
      if (near) continue;
      if (!any || values[t] < e.min.value) e.min = {x, values[t]};
      if (!any || values[t] > e.max.value) e.max = {x, values[t]};
      any = true;
    }
    if (any) return e;
  }
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  return {{Vec2::Zero(), unknown}, {Vec2::Zero(), unknown}};
}

FunctionalResult functional_result(const Functional& j, const Analysis& analysis) {
  FunctionalResult r{j.kind, analysis.value};
  if (j.kind == "sum")
    for (std::size_t i = 0; i < j.terms.size(); ++i)
      r.terms.push_back({j.terms[i].kind, j.terms[i].factor, analysis.term_value.at(i)});
  return r;
}

MapResult map_result(const Case& c, const Analysis& analysis, const FullMap& map) {
  const Model& model = *analysis.model;
  MapResult r{.perturbation = word(c.map_request.perturbation.kind)};
  const std::vector<Vec2> singular = singular_points(model);
  constexpr double share = 0.02;  // of the body's extent
  r.excluded_radius = singular.empty() ? 0 : share * extent(c.shape);
  const Extrema e = extrema(model, map, singular, r.excluded_radius);
  r.min = e.min;
  r.max = e.max;
  if (c.map && !c.map->points.empty()) r.points = map_at(analysis, c.functional, c.map_request, c.map->points);
  r.radius = c.map_request.radius;
  double masked = 0;
  for (std::size_t t = 0; t < map.masked_centroid.size(); ++t)
    if (map.masked_centroid[t]) masked += area(model.mesh, static_cast<Index>(t));
  r.masked_share = masked / area(model);
  r.biactive_length = analysis.biactive_length;
  r.oriented = map.angle.size() > 0;
  return r;
}

std::vector<NamedField> state_fields(const Model& model, const State& state, const PlotData& data,
                                     const Indicator& indicator) {
  const Eigen::Index n = data.values.stress.cols(), cells = state.interior.cols();
  Eigen::MatrixXd symmetric(3, n), first(1, n), second(1, n), raw(4, cells);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector4d s = data.values.stress.col(i);
    const double shear = 0.5 * (s[1] + s[2]), mean = 0.5 * (s[0] + s[3]);
    const double radius = std::hypot(0.5 * (s[0] - s[3]), shear);
    symmetric.col(i) << s[0], s[3], shear;
    first(0, i) = mean + radius;
    second(0, i) = mean - radius;
  }
  for (Index t = 0; t < static_cast<Index>(cells); ++t) {
    const Eigen::Vector4d s =
        stress_at(model.inner->kernel, triangle(model, t), state.interior.col(t), centroid(model.mesh, t));
    raw.col(t) << s[0], s[3], s[1], s[2];
  }
  std::vector<NamedField> fields{{"u", false, data.values.displacement},
                                 {"sigma", false, symmetric},
                                 {"von_mises", false, data.von_mises.transpose()},
                                 {"principal_stress_1", false, first},
                                 {"principal_stress_2", false, second},
                                 {"gamma", false, data.values.rotation},
                                 {"sigma_raw", true, raw},
                                 {"error_indicator", true, indicator.eta.transpose()}};
  if (!model.mesh.region.empty()) {
    Eigen::MatrixXd region(1, cells);
    for (Index t = 0; t < static_cast<Index>(cells); ++t) region(0, t) = 1 + model.mesh.region[t];
    fields.push_back({"region", true, std::move(region)});
  }
  return fields;
}

std::vector<NamedField> design_fields(const Model& model, const PlotData& data) {
  const Eigen::Index n = data.values.stress.cols();
  Eigen::MatrixXd symmetric(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector4d s = data.values.stress.col(i);
    symmetric.col(i) << s[0], s[3], 0.5 * (s[1] + s[2]);
  }
  std::vector<NamedField> fields{{"u", false, data.values.displacement},
                                 {"sigma", false, std::move(symmetric)},
                                 {"von_mises", false, data.von_mises.transpose()}};
  if (!model.mesh.region.empty()) {
    Eigen::MatrixXd region(1, static_cast<Eigen::Index>(model.mesh.region.size()));
    for (std::size_t t = 0; t < model.mesh.region.size(); ++t)
      region(0, static_cast<Eigen::Index>(t)) = 1 + model.mesh.region[t];
    fields.push_back({"region", true, std::move(region)});
  }
  return fields;
}

std::vector<NamedField> crack_fields(const CrackResult& crack) {
  const Eigen::Index n = static_cast<Eigen::Index>(crack.rows.size());
  std::vector<NamedField> fields;
  const auto add = [&](const char* name, auto value) {
    Eigen::MatrixXd row(1, n);
    for (Eigen::Index i = 0; i < n; ++i) row(0, i) = value(crack.rows[static_cast<std::size_t>(i)]);
    fields.push_back({name, false, std::move(row)});
  };
  add("s", [](const CrackRow& r) { return r.s; });
  add("jump_n", [](const CrackRow& r) { return r.jump_n; });
  add("jump_t", [](const CrackRow& r) { return r.jump_t; });
  add("sigma_n", [](const CrackRow& r) { return r.sigma_n; });
  add("sigma_t", [](const CrackRow& r) { return r.sigma_t; });
  add("contact_status", [](const CrackRow& r) { return r.closed ? 1.0 : 0.0; });
  return fields;
}

}  // namespace kerf
