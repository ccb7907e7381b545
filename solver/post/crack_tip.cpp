// The frames of crack tips and the curve of the crack behind them. A tip is an end of a crack inside the body and on no
// other crack. From the vertices of its path: the straight part as far as the turn off the line is below 1e-4, or the
// smooth part as far as the curvature 2 turn/(l_1 + l_2) at a vertex has its like at a neighbour. A smooth part is a
// cubic per edge through the vertices, slopes from parabolas through three neighbours,
//   x(t) = a + t (b - a) + t (1 - t) ((1 - t) p - t q),   p and q the slopes at the ends less the chord,
// or the tangents of the arcs that the edges follow. It ends where it has turned by half a radian or comes back towards
// the tip, so that it is a graph over the distance from the tip: angle_about needs the crack at every distance once.
// The radius that is clear of everything else (`room`) bounds the rings of the integrals, which so lie in one material:
// an integral over two has a term of the border between them. At a tip on a border there is no K.
// docs/theory/fracture.md uses these frames.

#include "solver/post/crack_tip.hpp"

#include "solver/stress.hpp"
#include "solver/system.hpp"

#include "geometry/plane.hpp"
#include "geometry/topology.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// A turn this small moves K by the same part of itself; coordinates have rounding errors.
constexpr double no_turn = 1e-4;

/// Vertices and edges of a crack from one of its ends.
struct Walk {
  std::vector<Index> edges, vertices;
};

/// One vertex more than edges, both from the end that is asked for.
Walk walk(const Mesh& mesh, Index crack, bool start) {
  Walk w;
  for (const CrackEdge& c : mesh.cracks[crack]) {
    const auto& [a, b] = mesh.edges[c.edge];
    if (w.edges.empty()) w.vertices.push_back(c.forward ? a : b);
    w.edges.push_back(c.edge);
    w.vertices.push_back(c.forward ? b : a);
  }
  if (!start) {
    std::reverse(w.edges.begin(), w.edges.end());
    std::reverse(w.vertices.begin(), w.vertices.end());
  }
  return w;
}

/// Number of edges up to the first turn off the straight line.
std::size_t straight_edges(const std::vector<Vec2>& x) {
  for (std::size_t i = 2; i < x.size(); ++i) {
    const Vec2 back = x[i - 1] - x[0], along = x[i] - x[i - 1];
    if (std::abs(cross(back, along)) > no_turn * back.dot(along)) return i - 1;
  }
  return x.size() - 1;
}

/// Number of edges up to the first kink: a turn that is large, or has no like beside it.
/// `large`: 20 degrees, more than the turn at a vertex of a curve that is meshed as such. `alike`: curvatures that
/// differ by less than 60 % of the larger one.
std::size_t smooth_edges(const std::vector<Vec2>& x) {
  constexpr double large = 0.35, alike = 0.6;
  std::vector<double> turn(x.size(), 0), curvature(x.size(), 0);
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const Vec2 before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    turn[i] = std::atan2(cross(before, after), before.dot(after));
    curvature[i] = 2 * turn[i] / (before.norm() + after.norm());
  }
  const auto like = [&](std::size_t i, std::size_t j) {
    return j > 0 && j + 1 < x.size() &&
           std::abs(curvature[i] - curvature[j]) <= alike * std::max(std::abs(curvature[i]), std::abs(curvature[j]));
  };
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double size = std::abs(turn[i]);
    if (size > large || (size > no_turn && !like(i, i - 1) && !like(i, i + 1))) return i;
  }
  return x.size() - 1;
}

/// Derivatives per length of chord, of the parabolas through three neighbors.
/// At the two ends the slope of the same parabola, 2 chord - slope of the other end.
std::vector<Vec2> slopes(const std::vector<Vec2>& x) {
  const std::size_t n = x.size() - 1;
  std::vector<Vec2> chord(n), slope(n + 1);
  std::vector<double> l(n);
  for (std::size_t i = 0; i < n; ++i) {
    l[i] = (x[i + 1] - x[i]).norm();
    chord[i] = (x[i + 1] - x[i]) / l[i];
  }
  if (n == 1) return {chord[0], chord[0]};
  for (std::size_t i = 1; i < n; ++i) slope[i] = (l[i] * chord[i - 1] + l[i - 1] * chord[i]) / (l[i - 1] + l[i]);
  slope[0] = 2 * chord[0] - slope[1];
  slope[n] = 2 * chord[n - 1] - slope[n - 1];
  return slope;
}

/// The same where the edges follow arcs: their tangents away from the tip, `count` of them, each edge in so many parts.
/// Arc parameters run evenly over the parts of a divided edge. The last vertex is the end of the edge before it.
std::vector<Vec2> slopes_of_arcs(const Mesh& mesh, const Walk& w, std::size_t count, std::size_t parts) {
  std::vector<Vec2> slope(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = (i + 1 < count ? i : i - 1) / parts;
    const auto e = static_cast<std::size_t>(w.edges[k]);
    const Arc& arc = mesh.arcs[static_cast<std::size_t>(mesh.arc[e])];
    const double along_edge = static_cast<double>(i - k * parts) / static_cast<double>(parts),
                 place = mesh.edges[e][0] == w.vertices[k] ? along_edge : 1 - along_edge,
                 t = arc.from + place * (arc.to - arc.from);
    const Vec2 tangent = (arc.axes * Vec2(-std::sin(t), std::cos(t))).normalized();
    const Vec2 along = mesh.points[w.vertices[k + 1]] - mesh.points[w.vertices[k]];
    slope[i] = tangent.dot(along) < 0 ? Vec2(-tangent) : tangent;
  }
  return slope;
}

bool follow_arcs(const Mesh& mesh, std::span<const Index> edges) {
  return !mesh.arc.empty() &&
         std::ranges::all_of(edges, [&](Index e) { return mesh.arc[static_cast<std::size_t>(e)] != none; });
}

/// Cut where the curve has turned too far or comes back, so that it is a graph over the distance from the tip.
/// At least one edge stays.
void cut_to_graph(std::vector<Vec2>& x, const std::vector<Vec2>& slope) {
  constexpr double most_turn = 0.5;
  std::size_t last = 1;
  while (last + 1 < x.size() && x[last + 1].norm() > x[last].norm() &&
         std::abs(std::atan2(cross(slope[0], slope[last + 1]), slope[0].dot(slope[last + 1]))) < most_turn)
    ++last;
  x.resize(last + 1);
}

/// The points of a walk, every edge divided into two so many times as `refine` divides it.
std::vector<Vec2> places(const Mesh& mesh, const Walk& w, int divisions) {
  std::vector<Vec2> x{mesh.points[w.vertices.front()]};
  for (std::size_t i = 0; i < w.edges.size(); ++i) {
    std::vector<Vec2> along = divided_edge(mesh, w.edges[i], divisions);
    if (mesh.edges[w.edges[i]][0] != w.vertices[i]) std::ranges::reverse(along);
    x.insert(x.end(), along.begin() + 1, along.end());
  }
  return x;
}

/// The tangent at the tip is that of the curve, not of its last chord: K follows its direction to first order.
CrackTip make_tip(const Mesh& mesh, Index crack, bool start, const Walk& w, int divisions) {
  CrackTip tip{.crack = crack, .at_start = start, .at = mesh.points[w.vertices.front()]};
  std::vector<Vec2> x = places(mesh, w, divisions);
  for (Vec2& v : x) v -= tip.at;
  const std::size_t straight = straight_edges(x), smooth = smooth_edges(x);
  tip.curved = smooth > straight;
  x.resize((tip.curved ? smooth : straight) + 1);
  if (tip.curved) cut_to_graph(x, slopes(x));
  for (std::size_t i = 0; i + 1 < x.size(); ++i) tip.edges.push_back(w.edges[i >> divisions]);
  const bool arcs = tip.curved && follow_arcs(mesh, tip.edges);
  std::vector<Vec2> slope = arcs ? slopes_of_arcs(mesh, w, x.size(), std::size_t{1} << divisions) : slopes(x);
  const Vec2 back = (tip.curved ? slope.front() : x.back()).normalized();
  tip.frame << -back.x(), back.y(), -back.y(), -back.x();
  for (Vec2& v : x) v = Vec2(tip.frame.transpose() * v);
  for (Vec2& v : slope) v = Vec2(tip.frame.transpose() * v);
  tip.slopes = arcs ? std::move(slope) : slopes(x);
  tip.follows = arcs;
  tip.vertices = std::move(x);
  return tip;
}

std::array<Index, 2> regions_beside(const Mesh& mesh, Index edge) {
  return {region_of(mesh, mesh.sides[edge][0]), region_of(mesh, mesh.sides[edge][1])};
}

/// Whether two regions (none: what is outside all) are made of the same, without strains of their own.
bool one_material(const Scene& scene, const std::array<Index, 2>& regions) {
  std::array<Material, 2> m;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto place = static_cast<std::size_t>(regions[i] + 1);
    if (place < scene.eigenstrain.size() && scene.eigenstrain[place]) return false;
    m[i] = regions[i] == none ? scene.material : scene.regions[static_cast<std::size_t>(regions[i])];
  }
  return m[0].mu == m[1].mu && m[0].c == m[1].c && m[0].coupling == m[1].coupling && m[0].split == m[1].split &&
         (isotropic(m[0]) || m[0].axis == m[1].axis);
}

/// Whether an edge lies between materials; without a scene, between regions.
bool between_materials(const Mesh& mesh, const Scene* scene, Index edge) {
  return is_interface(mesh, edge) && (!scene || !one_material(*scene, regions_beside(mesh, edge)));
}

/// The edges of the boundary, of all cracks, and between materials.
std::vector<Index> ends_of_material(const Mesh& mesh, const Scene* scene) {
  std::vector<Index> ends;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none || mesh.crack[e] != none ||
        between_materials(mesh, scene, e))
      ends.push_back(e);
  return ends;
}

/// `ends`: of the material.
/// Not beyond the end of the smooth part: what follows is a kink, whose field is not that of the tip.
double room(const Mesh& mesh, std::span<const Index> ends, const CrackTip& tip) {
  if (tip.on_border) return 0;
  std::vector<Index> own = tip.edges;
  std::sort(own.begin(), own.end());
  double least = tip.vertices.back().norm();
  for (const Index e : ends)
    if (!std::binary_search(own.begin(), own.end(), e))
      least = std::min(least, distance(tip.at, mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]));
  return least;
}

}  // namespace

/// The first vertex of a path has one crack edge if no other crack comes there; on the boundary it is a mouth.
std::vector<std::array<bool, 2>> ends_inside(const Mesh& mesh) {
  std::vector<bool> on_boundary(mesh.points.size(), false);
  std::vector<int> crack_edges(mesh.points.size(), 0);
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const bool boundary = mesh.sides[e][0] == none || mesh.sides[e][1] == none;
    for (const Index v : mesh.edges[e]) {
      if (boundary) on_boundary[v] = true;
      if (mesh.crack[e] != none) ++crack_edges[v];
    }
  }
  const auto is_inside = [&](const CrackEdge& c, bool first) {
    const Index v = mesh.edges[c.edge][c.forward == first ? 0 : 1];
    return !on_boundary[v] && crack_edges[v] == 1;
  };
  std::vector<std::array<bool, 2>> inside;
  for (const auto& crack : mesh.cracks) {
    inside.push_back({false, false});
    if (!crack.empty()) inside.back() = {is_inside(crack.front(), true), is_inside(crack.back(), false)};
  }
  return inside;
}

/// Edges that end the material are listed once for all tips; each tip leaves out those of its own smooth part.
std::vector<CrackTip> find_tips(const Mesh& mesh, int divisions, const Scene* scene) {
  const std::vector<Index> ends = ends_of_material(mesh, scene);
  std::vector<bool> on_border(mesh.points.size(), false);
  for (const Index e : ends)
    if (between_materials(mesh, scene, e))
      for (const Index v : mesh.edges[e]) on_border[v] = true;
  const std::vector<std::array<bool, 2>> inside = ends_inside(mesh);
  std::vector<CrackTip> tips;
  for (Index crack = 0; crack < static_cast<Index>(mesh.cracks.size()); ++crack) {
    if (mesh.cracks[crack].empty()) continue;
    for (const bool start : {true, false}) {
      if (!inside[crack][start ? 0 : 1]) continue;
      const Walk w = walk(mesh, crack, start);
      CrackTip tip = make_tip(mesh, crack, start, w, divisions);
      tip.on_border = on_border[w.vertices.front()];
      tip.room = room(mesh, ends, tip);
      tips.push_back(std::move(tip));
    }
  }
  return tips;
}

/// The mirrored body has no end along the face and the ligament. Its other half ends nowhere nearer than this one.
CrackTip half_tip(const Mesh& mesh, std::span<const Index> face, std::span<const Index> ahead) {
  const auto shares = [&](Index e, Index v) { return mesh.edges[e][0] == v || mesh.edges[e][1] == v; };
  Index vertex = mesh.edges[face.front()][shares(ahead.front(), mesh.edges[face.front()][0]) ? 0 : 1];
  CrackTip tip{.at = mesh.points[vertex], .edges = {face.begin(), face.end()}, .vertices = {Vec2::Zero()}};
  for (const Index e : face) {
    vertex = mesh.edges[e][mesh.edges[e][0] == vertex ? 1 : 0];
    tip.vertices.push_back(mesh.points[vertex] - tip.at);
  }
  const Vec2 back = tip.vertices.back().normalized();
  tip.frame << -back.x(), back.y(), -back.y(), -back.x();
  for (Vec2& v : tip.vertices) v = Vec2((tip.frame.transpose() * v).x(), 0);
  tip.slopes = slopes(tip.vertices);
  tip.half = tip.frame.col(1).dot(outward_normal(mesh, face.front())) < 0 ? 1 : -1;
  std::vector<Index> line(face.begin(), face.end());
  line.insert(line.end(), ahead.begin(), ahead.end());
  std::ranges::sort(line);
  tip.room = tip.vertices.back().norm();
  for (const Index e : ends_of_material(mesh, nullptr))
    if (!std::ranges::binary_search(line, e))
      tip.room = std::min(tip.room, distance(tip.at, mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]));
  return tip;
}

/// p and q vanish on a straight edge; the derivative follows by the product rule.
CurvePoint curve_point(const CrackTip& tip, std::size_t edge, double t) {
  const Vec2 &a = tip.vertices[edge], &b = tip.vertices[edge + 1];
  const double l = (b - a).norm();
  const Vec2 p = l * tip.slopes[edge] - (b - a), q = l * tip.slopes[edge + 1] - (b - a);  // off the chord
  const double s = 1 - t;
  return {a + t * (b - a) + t * s * (s * p - t * q), (b - a) + s * (s - 2 * t) * p - t * (2 * s - t) * q};
}

/// The angle of x against the crack at the same distance, plus that of the crack itself: along a curved crack the upper
/// face has an angle near pi and the lower one near -pi, wherever the crack has turned to.
double angle_about(const CrackTip& tip, const Vec2& x) {
  if (!tip.curved) return std::atan2(x.y(), x.x());
  // The crack at the same distance, seen from the direction straight back.
  const double r = x.norm();
  const auto& v = tip.vertices;
  const auto after =
      std::lower_bound(v.begin() + 1, v.end() - 1, r, [](const Vec2& y, double radius) { return y.norm() < radius; });
  const Vec2 a = *(after - 1), along = *after - a;
  const double half = a.dot(along), square = along.squaredNorm();
  double t = (std::sqrt(std::max(half * half + square * (r * r - a.squaredNorm()), 0.0)) - half) / square;
  Vec2 there = -(a + t * along);
  // Newton's method for |x(t)| = r, from the point on the chord; the arc is near it, so that three steps reach
  // rounding.
  if (tip.follows && t <= 1) {  // cells reach to the curve, not to its chord
    constexpr int steps = 3;
    const auto edge = static_cast<std::size_t>(after - v.begin()) - 1;
    for (int step = 0; step < steps; ++step) {
      const CurvePoint c = curve_point(tip, edge, t);
      t -= 0.5 * (c.at.squaredNorm() - r * r) / c.at.dot(c.slope);
    }
    there = -curve_point(tip, edge, t).at;
  }
  return std::atan2(cross(there, x), there.dot(x)) + std::atan2(there.y(), there.x());
}

}  // namespace kerf
