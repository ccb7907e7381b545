// Scalars of the stress (von Mises, principal stresses), and the places where it may be infinite: tips, kinks and
// junctions of cracks, corners between materials, reentrant corners, and the ends of supports. Whether the corner of an
// angle between two sides that are free, held or on rollers is singular follows from the exponents of its
// eigenfunctions [Williams 1952]: a free or a clamped corner above pi; free beside clamped counts at any angle; a
// roller continues the body as its mirror image, which doubles the angle. Where a crack meets rollers squarely its
// mirror image goes on behind them, and its end is no tip. With d = (s11 - s22)/2 and t = (s11 + s22)/2
//   sigma_vM^2 = 3 (d^2 + s12^2) + m^2,   m = t in plane stress and (1 - 2 nu) t + E e33 in plane strain.

#include "solver/stress.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace kerf {

namespace {

using Vertices = std::set<Index>;

// The vertex at which an edge of a crack begins on the crack's path, and the one at which it ends.
Index start_of(const Mesh& mesh, const CrackEdge& c) {
  return mesh.edges[c.edge][c.forward ? 0 : 1];
}
Index end_of(const Mesh& mesh, const CrackEdge& c) {
  return mesh.edges[c.edge][c.forward ? 1 : 0];
}

/// A vertex that two cracks name.
void add_junctions(const Mesh& mesh, Vertices& vertices) {
  std::vector<Index> crack_at(mesh.points.size(), none);
  for (std::size_t number = 0; number < mesh.cracks.size(); ++number)
    for (const CrackEdge& c : mesh.cracks[number])
      for (const Index v : mesh.edges[c.edge]) {
        if (crack_at[v] != none && crack_at[v] != static_cast<Index>(number)) vertices.insert(v);
        crack_at[v] = static_cast<Index>(number);
      }
}

/// About 3 degrees: less is a chord of a curve, or rounding.
constexpr double kink = 0.05;  // radians

/// Whether the supports hold a side along its normal `n` alone.
/// Along the normal of the side itself: of one that is not parallel to an axis by a support in the normal frame alone.
bool on_rollers(const Scene& scene, Index label, const Vec2& n) {
  bool held = false;
  for (const Support& support : scene.supports) {
    if (support.label != label) continue;
    const bool along_x = std::abs(n.y()) < kink, along_y = std::abs(n.x()) < kink;
    const bool normal = support.first && !support.second
                            ? support.normal_frame || along_x
                            : support.second && !support.first && !support.normal_frame && along_y;
    if (!normal) return false;
    held = true;
  }
  return held;
}

/// Vertices where a straight side is held by rollers on both sides of the vertex; elsewhere 0. Its normal.
std::vector<Vec2> normals_of_rollers(const Mesh& mesh, const Scene& scene) {
  std::vector<Vec2> normal(mesh.points.size(), Vec2::Zero());
  std::vector<int> count(mesh.points.size(), 0);
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.sides[e][0] != none && mesh.sides[e][1] != none) continue;
    const Vec2 n = outward_normal(mesh, e);
    if (on_rollers(scene, mesh.label[e], n))
      for (const Index v : mesh.edges[e]) normal[v] += 0.5 * n, ++count[v];
  }
  constexpr double straight = 1 - kink * kink / 2;
  for (std::size_t v = 0; v < normal.size(); ++v)
    if (count[v] != 2 || normal[v].norm() < straight) normal[v].setZero();
  return normal;
}

/// The edges of a crack with a law that has a normal of its own are chords of a curve, and their turns are no kinks.
void add_ends_and_kinks(const Mesh& mesh, const Scene& scene, Vertices& vertices) {
  const std::vector<Vec2> rollers = normals_of_rollers(mesh, scene);
  const auto is_mirrored = [&](Index v, Index next) {
    const Vec2 along = (mesh.points[next] - mesh.points[v]).normalized();
    return std::abs(rollers[v].dot(along)) > 1 - kink * kink / 2;
  };
  for (std::size_t number = 0; number < mesh.cracks.size(); ++number) {
    const auto& crack = mesh.cracks[number];
    if (crack.empty()) continue;
    const Index start = start_of(mesh, crack.front()), end = end_of(mesh, crack.back());
    if (!is_mirrored(start, end_of(mesh, crack.front()))) vertices.insert(start);
    if (!is_mirrored(end, start_of(mesh, crack.back()))) vertices.insert(end);
    if (scene.laws[number].normal) continue;  // a curve
    for (std::size_t i = 1; i < crack.size(); ++i) {
      const Index v = start_of(mesh, crack[i]);
      const Vec2 before = mesh.points[v] - mesh.points[start_of(mesh, crack[i - 1])];
      const Vec2 after = mesh.points[end_of(mesh, crack[i])] - mesh.points[v];
      if (std::abs(std::atan2(cross(before, after), before.dot(after))) > kink) vertices.insert(v);
    }
  }
}

/// Only where two edges of a border meet: where three regions meet nothing is said here.
void add_corners_between_materials(const Mesh& mesh, Vertices& vertices) {
  if (mesh.region.empty()) return;
  constexpr double straight = -0.94;  // cosine of 160 degrees; polygonal arcs turn by less per vertex
  std::vector<std::vector<Vec2>> interfaces(mesh.points.size());
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (is_interface(mesh, e))
      for (int end = 0; end < 2; ++end)
        interfaces[mesh.edges[e][end]].push_back((end == 0 ? 1 : -1) * tangent(mesh, e));
  for (std::size_t v = 0; v < interfaces.size(); ++v)
    if (interfaces[v].size() == 2 && interfaces[v][0].dot(interfaces[v][1]) > straight)
      vertices.insert(static_cast<Index>(v));
}

// The angle that the triangles fill around every vertex.
std::vector<double> angles(const Mesh& mesh) {
  std::vector<double> angle(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const Vec2 a = mesh.points[t[(i + 1) % 3]] - mesh.points[t[i]],
                 b = mesh.points[t[(i + 2) % 3]] - mesh.points[t[i]];
      angle[t[i]] += std::atan2(cross(a, b), a.dot(b));
    }
  return angle;
}

// How a piece of the boundary is held.
// Normal: rollers on a straight side. Else: one component that is not the normal one.
enum class Held { Free, Fully, Normal, Else };

Held held(const Scene& scene, Index label, const Vec2& n) {
  bool first = false, second = false;
  for (const Support& support : scene.supports)
    if (support.label == label) first = first || support.first, second = second || support.second;
  if (!first && !second) return Held::Free;
  if (first && second) return Held::Fully;
  return on_rollers(scene, label, n) ? Held::Normal : Held::Else;
}

/// By how much an edge turns the angle of the body at its end `v`, where its arc leaves the chord.
/// Angles of triangles are those between chords; the body's own angle is that between tangents.
double turned_by_arc(const Mesh& mesh, Index e, Index v) {
  if (mesh.arc.empty() || mesh.arc[e] == none) return 0;
  const bool starts = mesh.edges[e][0] == v;
  const Arc& arc = mesh.arcs[mesh.arc[e]];
  const Vec2 chord = (starts ? 1 : -1) * tangent(mesh, e);
  const double t = parameter(arc, mesh.points[v]);
  Vec2 along = velocity(arc, t);
  if (along.dot(chord) < 0) along = -along;
  const double turn = std::atan2(cross(chord, along), chord.dot(along));
  return starts == (mesh.sides[e][0] != none) ? -turn : turn;
}

/// Whether stresses are infinite where two sides meet at an angle [Williams 1952]. A roller continues the body as its
/// mirror image, with the angle doubled.
bool is_singular(double angle, Held one, Held other) {
  constexpr double square = pi / 2 + kink, round = 0.9 * pi;
  if (angle > reentrant_angle) return true;
  if (one == Held::Normal && other == Held::Normal) return angle > square && angle < round;  // more: chords of a curve
  if (one == other) return false;
  const auto mirrors = [](Held a, Held b) { return a == Held::Normal && (b == Held::Free || b == Held::Fully); };
  return !(mirrors(one, other) || mirrors(other, one)) || angle > square;
}

/// Pairs of boundary edges at a vertex, in the order of their numbers; the angle is that of all triangles around it.
void add_corners_and_ends_of_supports(const Model& model, Vertices& vertices) {
  const Mesh& mesh = model.mesh;
  std::vector<double> angle = angles(mesh);
  std::vector<std::vector<Held>> beside(mesh.points.size());
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.sides[e][0] != none && mesh.sides[e][1] != none) continue;
    const Held how = held(model.scene, mesh.label[e], outward_normal(mesh, e));
    for (const Index v : mesh.edges[e]) {
      angle[v] += turned_by_arc(mesh, e, v);
      beside[v].push_back(how);
    }
  }
  for (std::size_t v = 0; v < beside.size(); ++v)
    for (std::size_t i = 1; i < beside[v].size(); ++i)
      if (is_singular(angle[v], beside[v][i - 1], beside[v][i])) vertices.insert(static_cast<Index>(v));
}

}  // namespace

Eigen::Vector3d symmetric_part(const Eigen::Vector4d& s) {
  return {s[0], s[3], 0.5 * (s[1] + s[2])};
}

// 4 mu c = 1 - 2 nu in plane strain.
// E = 2 mu (1 + nu) = mu (3 - 4 mu c), as nu = (1 - 4 mu c)/2.
double von_mises(const Material& m, bool plane_strain, const Eigen::Vector4d& s, double e33) {
  const double mean = 0.5 * (s[0] + s[3]), difference = 0.5 * (s[0] - s[3]), shear = 0.5 * (s[1] + s[2]);
  const double share = plane_strain ? 4 * m.mu * m.c : 1, young = m.mu * (3 - 4 * m.mu * m.c);
  const double beyond = share * mean + (plane_strain && e33 != 0 ? young * e33 : 0);  // of s33
  return std::sqrt(beyond * beyond + 3 * (difference * difference + shear * shear));
}

PrincipalStresses principal_stresses(const Eigen::Vector4d& s) {
  const double shear = 0.5 * (s[1] + s[2]), mean = 0.5 * (s[0] + s[3]);
  const double radius = std::hypot(0.5 * (s[0] - s[3]), shear);
  return {mean + radius, mean - radius};
}

std::vector<Index> singular_vertices(const Model& model) {
  Vertices vertices;
  add_junctions(model.mesh, vertices);
  add_ends_and_kinks(model.mesh, model.scene, vertices);
  add_corners_between_materials(model.mesh, vertices);
  add_corners_and_ends_of_supports(model, vertices);
  return {vertices.begin(), vertices.end()};
}

std::vector<Vec2> singular_points(const Model& model) {
  std::vector<Vec2> points;
  for (const Index v : singular_vertices(model)) points.push_back(model.mesh.points[v]);
  return points;
}

}  // namespace kerf
