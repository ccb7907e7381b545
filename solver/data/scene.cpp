// All data of a scene on a mesh, once: per label the edges and what acts on them, pressures in cracks, body force,
// eigenstrain (edge.cpp, triangle.cpp, strain.cpp), and what of them the rules do not resolve, one place per condition.
// Reported are
//   open (neither proof nor samples settle it), sampled only, prescribed displacements that jump (infinite energy),
//   squares that are not integrable, and gaps g that do more along an edge than a line,
//   sum_e |g - line|_e^2 > 0.1^2 sum_e |g|_e^2.
// All but "sampled" stop bounds and claims on the error. Which datum is enclosed by what: docs/theory/data.md, section
// What stands behind a guarantee [theory: D.2, D.3, D.4].

#include "solver/data.hpp"
#include "solver/data/all_triangles.hpp"

#include "solver/element/local.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

// The worst edge of one condition, if the rules leave any open.
void add_unseen(const Mesh& mesh, const std::vector<EdgeValues>& values, bool prescribed, const auto& edge_of,
                UnseenData which, std::vector<UnseenData>& all) {
  std::optional<UnseenData> found;
  double worst = -1;
  for (std::size_t j = 0; j < values.size(); ++j) {
    const EdgeValues& v = values[j];
    const bool open = v.how == Resolution::Open, jumps = prescribed && v.jumps, infinite = !v.rest.allFinite();
    const bool stops = open || jumps || infinite;
    if (!stops && v.how != Resolution::Sampled) continue;
    const double size = open ? infinity : stops ? std::max(1.0, v.rest.sum()) : 0;
    if (size <= worst) continue;
    worst = size;
    const EdgeLine line = edge_line(mesh, edge_of(j));
    which.at = line.a + v.worst * (line.b - line.a);
    which.how = open    ? "is not resolved"
                : jumps ? "jumps, which no displacement of finite energy does,"
                : stops ? "has a square that is not integrable"
                        : "is known at sampled points only";
    which.stops_bounds = stops;
    found = which;
  }
  if (found) all.push_back(*found);
}

// Where a gap does more along an edge than a straight line, by more than a tenth of its size along the crack: contact
// takes it at two points or so of each edge.
void add_unseen_gap(const Mesh& mesh, const CrackLaw& law, Index crack, std::vector<UnseenData>& all) {
  const EdgeRule rule = gauss(data_points), ends = gauss(2);
  double size = 0, worst = -1, left_out = 0;
  UnseenData found{.at = {}, .what = "the gap in a crack", .how = "does more than the mesh follows,", .crack = crack};
  for (const CrackEdge& c : mesh.cracks[static_cast<std::size_t>(crack)]) {
    const EdgeLine line = edge_line(mesh, c.edge);
    const double l = length(mesh, c.edge);
    const EdgeValues v = edge_values(law.gap, line, "gap of a crack");
    const auto value = [&](double s) { return law.gap(line.a + s * (line.b - line.a), line.n).x(); };
    const double first = value(ends.s[0]), slope = (value(ends.s[1]) - first) / (ends.s[1] - ends.s[0]);
    double square = v.rest.x(), beyond = square;
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
      square += rule.w[q] * std::pow(v.at(0, q), 2);
      beyond += rule.w[q] * std::pow(v.at(0, q) - first - slope * (rule.s[q] - ends.s[0]), 2);
    }
    size += l * square;
    left_out += l * beyond;
    if (l * beyond <= worst) continue;
    worst = l * beyond;
    found.at = line.a + v.worst * (line.b - line.a);
  }
  constexpr double much = 0.1;
  if (left_out > much * much * size) all.push_back(found);
}

}  // namespace

// Such data need no looks: the rules of all elements integrate them exactly.
bool is_polynomial(const VectorField& f) {
  constexpr int exact = 4;  // that the rules integrate against the displacements of every element
  return f.known() && f.known()->degree() >= 0 && f.known()->degree() <= exact;
}

// By the enclosure over the box about the mesh: at least the largest value, where that is finite.
double size_over(const VectorField& f, const Mesh& mesh) {
  if (!f.known()) return 0;
  Interval x{infinity, -infinity}, y = x;
  for (const Vec2& p : mesh.points) {
    x = {std::min(x.low, p.x()), std::max(x.high, p.x())};
    y = {std::min(y.low, p.y()), std::max(y.high, p.y())};
  }
  double size = 0;
  for (const Interval& v : f.known()->over(x, y)) size = std::max({size, std::abs(v.low), std::abs(v.high)});
  return std::isfinite(size) ? size : 0;
}

std::vector<UnseenData> unseen_data(const Mesh& mesh, const Scene& scene, const SceneData& data) {
  std::vector<UnseenData> all;
  const auto add = [&](const LoadedEdges& of, bool prescribed, const char* what) {
    add_unseen(
        mesh, of.values, prescribed, [&](std::size_t j) { return labeled(data, of.label)[j]; },
        {.label = of.label, .at = {}, .what = what, .how = ""}, all);
  };
  for (const LoadedEdges& s : data.supports) add(s, true, "the prescribed displacement");
  for (const LoadedEdges& t : data.tractions) add(t, false, "the traction");
  for (const LoadedCrack& c : data.pressures)
    add_unseen(
        mesh, c.values, false, [&](std::size_t j) { return mesh.cracks[c.crack][j].edge; },
        {.at = {}, .what = "the pressure in a crack", .how = "", .crack = c.crack}, all);
  const auto add_worst = [&](std::size_t count, const char* what, const auto& how, const auto& error) {
    for (const bool open : {true, false}) {
      double worst = -1;
      std::optional<UnseenData> found;
      for (std::size_t t = 0; t < count; ++t) {
        if (how(t) != (open ? Resolution::Open : Resolution::Sampled) || error(t) <= worst) continue;
        worst = error(t);
        found = UnseenData{none, centroid(mesh, static_cast<Index>(t)), what,
                           open ? "is not resolved" : "is known at sampled points only", open};
      }
      if (found) all.push_back(*found);
      if (found) return;
    }
  };
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c)
    if (has_gap(scene.laws[c])) add_unseen_gap(mesh, scene.laws[c], static_cast<Index>(c), all);
  if (scene.body)
    add_worst(
        data.body.size(), "the body force", [&](std::size_t t) { return data.body[t].how; },
        [&](std::size_t t) { return data.body[t].error; });
  add_worst(
      data.strain.how.size(), "the eigenstrain", [&](std::size_t t) { return data.strain.how[t]; },
      [&](std::size_t t) { return data.strain.error[static_cast<Eigen::Index>(t)]; });
  return all;
}

EdgeLine edge_line(const Mesh& mesh, Index e) {
  return {mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]], outward_normal(mesh, e)};
}

const LoadedCrack* pressure_in(const SceneData& data, Index crack) {
  const auto found = std::ranges::find(data.pressures, crack, &LoadedCrack::crack);
  return found == data.pressures.end() ? nullptr : &*found;
}

// P through its values at the eight points.
double pressure_at(const EdgeValues& on_edge, double s) {
  static const EdgeRule rule = gauss(data_points);
  return on_edge.at.row(0) * trace_basis(rule, s);
}

const std::vector<Index>& labeled(const SceneData& data, Index label) {
  static const std::vector<Index> nothing;
  return label < 0 || label >= static_cast<Index>(data.edges.size()) ? nothing : data.edges[label];
}

// Tractions are densities on the edge: on a curved edge they count times |dx/ds| over the chord. Prescribed
// displacements and pressures are values; the pressure gets the length with its normal (solver/system/skeleton.cpp).
SceneData boundary_data(const Mesh& mesh, const Scene& scene, const EdgeCurvatures& curvatures) {
  SceneData data;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const Index label = mesh.label[e];
    if (label == none) continue;
    if (label >= static_cast<Index>(data.edges.size())) data.edges.resize(static_cast<std::size_t>(label) + 1);
    data.edges[label].push_back(e);
  }
  const auto values = [&](Index label, const BoundaryField& f, const char* what, bool density) {
    LoadedEdges all{label, {}};
    double size = 0;
    for (const Index e : labeled(data, label)) size = std::max(size, size_on(f, edge_line({mesh, curvatures, e})));
    for (const Index e : labeled(data, label))
      all.values.push_back(edge_values(f, {mesh, curvatures, e}, what, density, size));
    return all;
  };
  for (const Support& s : scene.supports)
    data.supports.push_back(values(s.label, s.value, "prescribed displacement", false));
  for (const Traction& t : scene.tractions) data.tractions.push_back(values(t.label, t.value, "traction", true));
  for (std::size_t c = 0; c < std::min(mesh.cracks.size(), scene.laws.size()); ++c) {
    const BoundaryField& p = scene.laws[c].pressure;
    if (!p || scene.laws[c].kind == CrackLaw::Kind::Bonded) continue;
    LoadedCrack all{static_cast<Index>(c), {}};
    double size = 0;
    for (const CrackEdge& e : mesh.cracks[c]) size = std::max(size, size_on(p, edge_line({mesh, curvatures, e.edge})));
    for (const CrackEdge& e : mesh.cracks[c])
      all.values.push_back(edge_values(p, {mesh, curvatures, e.edge}, "pressure in a crack", false, size));
    data.pressures.push_back(std::move(all));
  }
  return data;
}

// The body force is looked at on all triangles together: looks are shared out among them.
SceneData scene_data(const Mesh& mesh, const Scene& scene, const TriangleRule& rule, int threads,
                     const EdgeCurvatures& curvatures) {
  SceneData data = boundary_data(mesh, scene, curvatures);
  data.strain = strain_data(mesh, scene, rule, threads, curvatures);
  if (!scene.body || is_polynomial(scene.body)) return data;
  std::vector<Index> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), Index(0));
  const auto cell = [&](Index t) { return cell_of(mesh, curvatures, t); };
  data.body = triangle_values(scene.body, all, cell, rule, size_over(scene.body, mesh), "body force", threads);
  return data;
}

// Polynomials of low degree are evaluated where they are wanted; of other fields the values at the points of the rule
// are stored, or those of their projection.
Points body_force(const SceneData& data, const Scene& scene, Index t, const Points& x) {
  if (!data.body.empty()) return data.body[t].at;
  Points value(2, x.cols());
  for (Eigen::Index q = 0; q < x.cols(); ++q) value.col(q) = scene.body(x.col(q));
  return value;
}

}  // namespace kerf
