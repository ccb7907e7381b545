// The largest values of a state, told apart from those that only the mesh makes large. Around each singular point
// (tips, kinks, reentrant corners, ends of supports) there is a zone in which values are those of the mesh, of radius
//   min(0.02 extent, max(0.1 distance to the next such point, 2 edges));
// a largest value in a zone is "singular" and has the largest one outside beside it. Where pressure in a crack may be
// infinite the pressure says itself: with mean values p_0, p_1, p_2 over distances [h, 2h], [2h, 4h], [4h, 8h] from the
// point, h two edges, it is taken to be infinite if log2(p_0/p_1) > 0.05 and > 0.6 log2(p_1/p_2), since a power of the
// distance has two equal slopes and a bounded pressure a smaller one nearer to the point. At other tips two edges are
// left out, where the discrete pressure is false [theory: F.8]. Also: strains and displacements beyond linear
// elasticity, largest stresses at corners of chords that stand for curves. docs/theory/fracture.md, "False pressure at
// sliding tips".

#include "app/run/peaks.hpp"

#include "geometry/curved.hpp"
#include "solver/recovery.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace kerf {

namespace {

std::string point_in_words(const Vec2& x) {
  return fmt::format("({:.4g}, {:.4g})", x.x(), x.y());
}

}  // namespace

Eigen::VectorXd principal_strains(const Model& model, const PlotData& data) {
  const std::vector<Material> materials = corner_materials(model, data.corners);
  const Eigen::Matrix4Xd free = corner_eigenstrains(model, data.corners).topRows<4>();
  Eigen::VectorXd out(data.values.stress.cols());
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const Eigen::Vector3d s = symmetric_part(data.values.stress.col(i));
    const Eigen::Vector4d g =
        displacement_gradient(materials[static_cast<std::size_t>(i)], {s[0], s[2], s[2], s[1]}, 0) + free.col(i);
    out[i] = 0.5 * (std::abs(g[0] + g[3]) + std::hypot(g[0] - g[3], g[1] + g[2]));
  }
  return out;
}

bool SingularZones::hold(const Vec2& x) const {
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((x - points[i]).squaredNorm() < radius[i] * radius[i]) return true;
  return false;
}

double SingularZones::largest() const {
  return radius.empty() ? 0 : *std::ranges::max_element(radius);
}

namespace {

constexpr double share_of_body = 0.02, share_of_feature = 0.1;
constexpr int poor_edges = 2;

}  // namespace

SingularZones singular_zones(const Model& model, double extent) {
  const Mesh& mesh = model.mesh;
  const std::vector<Index> vertices = singular_vertices(model);
  std::vector<double> edge(mesh.points.size(), 0);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    for (const Index v : mesh.edges[e]) edge[v] = std::max(edge[v], length(mesh, static_cast<Index>(e)));
  SingularZones zones;
  for (const Index v : vertices) {
    double next = infinity;
    for (const Index w : vertices)
      if (w != v) next = std::min(next, (mesh.points[w] - mesh.points[v]).norm());
    zones.points.push_back(mesh.points[v]);
    zones.radius.push_back(std::min(share_of_body * extent, std::max(share_of_feature * next, poor_edges * edge[v])));
  }
  return zones;
}

std::optional<Peak> peak(std::span<const Vec2> points, const Eigen::VectorXd& values, const SingularZones& zones) {
  PlacedValue largest{Vec2::Zero(), nan}, regular = largest;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const PlacedValue here{points[static_cast<std::size_t>(i)], values[i]};
    if (!(here.value <= largest.value)) largest = here;
    if (!(here.value <= regular.value) && !zones.hold(here.at)) regular = here;
  }
  if (std::isnan(largest.value)) return std::nullopt;
  // A stress that is the same everywhere is largest where rounding says.
  constexpr double rounding = 1e-9;
  if (regular.value >= (1 - rounding) * largest.value) largest = regular;
  Peak p{.largest = largest, .singular = zones.hold(largest.at)};
  if (p.singular && !std::isnan(regular.value)) p.regular = regular;
  return p;
}

namespace {

/// A point of a crack where its pressure may be infinite.
struct Suspect {
  double s;  // along the crack
  Vec2 at;
  double edges;  // the length of the poor ones beside it
  int end;       // 0: start, 1: end, -1: between
};

/// The points that lie on the crack's path: at its ends, or between two rows.
std::vector<Suspect> suspects(const CrackResult& crack, const PressureProfiles& of) {
  constexpr double bent = 1.05;
  const std::vector<CrackRow>& rows = crack.rows;
  const std::size_t poor = poor_edges * of.per_edge;
  const auto beside = [&](std::size_t i, std::size_t j) { return std::abs(rows[i].s - rows[j].s); };
  std::vector<Suspect> found;
  if (rows.size() <= 2 * poor) return found;
  for (const Vec2& x : of.singular) {
    if ((x - rows.front().at).norm() <= bent * rows.front().s)
      found.push_back({0, x, beside(0, poor), 0});
    else if ((x - rows.back().at).norm() <= bent * (crack.length - rows.back().s))
      found.push_back({crack.length, x, beside(rows.size() - 1, rows.size() - 1 - poor), 1});
    else
      for (std::size_t i = of.per_edge; i < rows.size(); i += of.per_edge) {
        const double before = (x - rows[i - 1].at).norm(), after = (x - rows[i].at).norm();
        if (before + after > bent * beside(i, i - 1)) continue;
        found.push_back({rows[i - 1].s + before, x,
                         std::max(beside(i, std::min(i + poor, rows.size() - 1)), beside(i - 1, i - std::min(i, poor))),
                         -1});
        break;
      }
  }
  return found;
}

/// Whether the pressure grows like a power of the distance towards the point; also where too few edges say.
bool is_infinite(const CrackResult& crack, const Suspect& point) {
  constexpr double grows = 0.05, as_fast = 0.6;
  std::array<double, 3> sum{}, count{};
  double largest = 0;
  for (const CrackRow& row : crack.rows) {
    const double pressure = std::max(0.0, -row.sigma_n - row.fluid_pressure);
    const double octave = std::log2(std::abs(row.s - point.s) / point.edges);
    if (octave < 3) largest = std::max(largest, pressure);
    if (octave < 0 || octave >= 3) continue;
    sum[static_cast<std::size_t>(octave)] += pressure;
    count[static_cast<std::size_t>(octave)] += 1;
  }
  if (largest <= 1e-9 * crack.max_pressure) return false;
  if (std::ranges::any_of(count, [](double n) { return n < 2; })) return true;
  if (sum[0] <= 0) return false;  // open beside it
  const auto slope = [&](std::size_t i) {
    return sum[i + 1] > 0 ? std::log2(sum[i] / count[i] / (sum[i + 1] / count[i + 1])) : infinity;
  };
  return slope(0) > grows && slope(0) > as_fast * slope(1);
}

}  // namespace

void add_pressures(const PressureProfiles& of, std::vector<CrackResult>& cracks) {
  for (std::size_t number = 0; number < cracks.size(); ++number) {
    CrackResult& crack = cracks[number];
    if (!(crack.max_pressure > 0)) continue;
    SingularZones zones;
    std::vector<bool> left_out(crack.rows.size(), false);
    const double feature = std::min(crack.length, crack.closed_length);
    for (const Suspect& point : suspects(crack, of)) {
      if (is_infinite(crack, point)) {
        zones.points.push_back(point.at);
        zones.radius.push_back(std::max(point.edges, std::min(share_of_body * of.extent, share_of_feature * feature)));
      } else if (point.end >= 0 && of.tips[number][static_cast<std::size_t>(point.end)]) {
        for (std::size_t i = 0; i < poor_edges * of.per_edge; ++i)
          left_out[point.end == 0 ? i : left_out.size() - 1 - i] = true;
      }
    }
    std::vector<Vec2> at;
    Eigen::VectorXd pressure(static_cast<Eigen::Index>(crack.rows.size()));
    for (const CrackRow& row : crack.rows) {
      const bool out = left_out[at.size()];
      pressure[static_cast<Eigen::Index>(at.size())] = out ? nan : -row.sigma_n - row.fluid_pressure;
      at.push_back(row.at);
    }
    crack.pressure = peak(at, pressure, zones);
    if (crack.pressure) crack.max_pressure = std::max(0.0, crack.pressure->largest.value);
  }
}

std::vector<std::string> notes_on_size(const std::optional<Peak>& strain, const std::optional<Peak>& displacement,
                                       double extent) {
  constexpr double small_strain = 0.05, small_displacement = 0.1;
  std::vector<std::string> notes;
  if (strain) {
    const std::optional<PlacedValue> regular = strain->singular ? strain->regular : std::optional(strain->largest);
    if (regular && regular->value > small_strain)
      notes.push_back(
          fmt::format("strains reach {:.2g} at {}: linear elasticity is about small ones (below {:g}); "
                      "check the units of young and of the loads, or read the results per load",
                      regular->value, point_in_words(regular->at), small_strain));
  }
  if (displacement && displacement->largest.value > small_displacement * extent)
    notes.push_back(fmt::format(
        "displacements reach {:.2g} of the extent of the body at {}: linear elasticity is "
        "about small ones (below {:g})",
        displacement->largest.value / extent, point_in_words(displacement->largest.at), small_displacement));
  return notes;
}

namespace {

bool lies_on(const Arc& arc, const Vec2& x) {
  constexpr double sagitta = 0.02;  // corners lie off the curve, so that the area is right
  return std::abs((arc.axes.inverse() * (x - arc.center)).norm() - 1) < sagitta;
}

}  // namespace

double beside(const Model& model, const State& state, const PlotData& data, bool plane_strain, const Vec2& at) {
  const auto found = std::ranges::find(data.points, at);
  if (found == data.points.end()) return 0;
  const Index vertex = data.corners.vertex[static_cast<std::size_t>(found - data.points.begin())];
  const Mesh& mesh = model.mesh;
  const StrainData& strain = model.inner->data.strain;
  double largest = 0;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edges[e];
    const auto& [left, right] = mesh.sides[e];
    if ((a != vertex && b != vertex) || (left != none && right != none)) continue;
    const Index t = left != none ? left : right;
    if (t >= own_triangles(model)) continue;
    const Vec2 middle = 0.5 * (mesh.points[a] + mesh.points[b]);
    const Eigen::Vector4d s = stress_at(model.inner->kernel, triangle(model, t), state.interior.col(t), middle);
    const auto half = [&](int k) { return mesh.triangles[t][k] == a || mesh.triangles[t][k] == b ? 0.5 : 0.0; };
    const double e33 = strain.empty() ? 0 : strain_33_at(strain, t, Vec2(half(1), half(2)))[0];
    largest = std::max(largest, von_mises(material_of(mesh, model.scene, t), plane_strain, s, e33));
  }
  return largest;
}

std::optional<PlacedValue> top_on_chords(const Case& c, const Peak& von_mises) {
  const std::optional<PlacedValue> top = von_mises.singular ? von_mises.regular : std::optional(von_mises.largest);
  if (!top || c.sizing.curved) return std::nullopt;
  const std::vector<Arc> arcs = arcs_of(c.shape);
  return std::ranges::any_of(arcs, [&](const Arc& arc) { return lies_on(arc, top->at); }) ? top : std::nullopt;
}

bool lies_on_chords_of_file(const Case& c, const Mesh& mesh, const Peak& von_mises) {
  const std::optional<PlacedValue> top = von_mises.singular ? von_mises.regular : std::optional(von_mises.largest);
  if (!top || !c.mesh || !mesh.arc.empty() || !arcs_of(c.shape).empty()) return false;
  std::map<Index, std::array<Index, 2>> around;  // of a vertex of the rim, those before and behind it
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [left, right] = mesh.sides[e];
    if (left != none && right != none) continue;
    auto [a, b] = mesh.edges[e];
    if (left == none) std::swap(a, b);
    around.try_emplace(a, std::array{none, none}).first->second[1] = b;
    around.try_emplace(b, std::array{none, none}).first->second[0] = a;
  }
  const auto point = [&](Index v) -> const Vec2& { return mesh.points[static_cast<std::size_t>(v)]; };
  const auto turn = [&](Index v) {
    const auto& [before, behind] = around.at(v);
    const Vec2 p = point(v) - point(before), q = point(behind) - point(v);
    return std::atan2(cross(p, q), p.dot(q));
  };
  const auto nearest = std::ranges::min_element(
      around, {}, [&](const auto& vertex) { return (point(vertex.first) - top->at).squaredNorm(); });
  const auto& [before, behind] = nearest->second;
  const double own = turn(nearest->first), length = (point(nearest->first) - point(before)).norm();
  if (!((point(nearest->first) - top->at).norm() < length)) return false;
  constexpr double least = 0.5 * pi / 180, most = 35 * pi / 180;
  return std::ranges::all_of(std::array{own, turn(before), turn(behind)}, [&](double angle) {
    return std::abs(angle) > least && std::abs(angle) < most && angle * own > 0;
  });
}

std::string note_on_chords_of_file(const PlacedValue& top) {
  return fmt::format(
      "the largest von Mises stress, {:.4g} at {}, lies where straight edges of domain.file stand for a curve: their "
      "corners are notches, and a finer mesh does not take them away; save it with second order (gmsh: "
      "Mesh.ElementOrder = 2), and edges follow the curve",
      top.value, point_in_words(top.at));
}

std::string note_on_chords(const Case& c, const PlacedValue& top, double beside) {
  constexpr double worth_saying = 1.02;
  if (beside == 0 || top.value < worth_saying * beside) return {};
  return fmt::format(
      "the largest von Mises stress, {:.4g} at {}, lies at a corner of the chords that stand for a curved side, where "
      "it is larger than on the curve; in the middle of the chords beside it it is {:.4g}{}",
      top.value, point_in_words(top.at), beside,
      c.why_chords.empty() ? "; with mesh.curved = true edges follow the curve" : "");
}

}  // namespace kerf
