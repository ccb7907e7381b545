// The triangles of a mesh file as one connected mesh, and what is checked of it. Nodes with the same coordinates become
// one vertex: faces of a crack have nodes of their own in files of gmsh, and so have surfaces that were not glued. That
// two triangles have different nodes on a common edge is remembered per edge (`doubled`). A surface whose triangles all
// run clockwise is turned over as a whole; one that has both kinds is refused. Then, for the rim (edges with one
// triangle): no node lies inside another edge of it, no two edges cross, no vertex has more than two of them, and the
// angles of the triangles around a vertex add up to at most 2 pi. Edges that
// may touch are found by a grid of cells. All messages name elements and nodes by their tags in the file.

#include "io/mesh/welded.hpp"

#include "geometry/plane.hpp"
#include "geometry/topology.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

namespace kerf {

namespace {

/// Messages that name elements and nodes of the file.
class Blame {
 public:
  Blame(const RawMesh& raw) : raw_(raw) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Fault::Geometry, fmt::format("{}: {}", raw_.file, what));
  }
  std::string at(const Vec2& x) const {
    return fmt::format("({:.6g}, {:.6g})", x.x() + 0.0, x.y() + 0.0);
  }
  std::string node(Index n) const {
    return fmt::format("node {} at {}", raw_.tags[std::size_t(n)], at(raw_.points[std::size_t(n)]));
  }
  std::string element(std::size_t t) const {
    const RawTriangle& cell = raw_.triangles[t];
    const Vec2 middle = (raw_.points[std::size_t(cell.v[0])] + raw_.points[std::size_t(cell.v[1])] +
                         raw_.points[std::size_t(cell.v[2])]) /
                        3;
    return fmt::format("element {} at {}", cell.tag, at(middle));
  }
  std::string elements(std::size_t t, std::size_t u) const {
    return fmt::format("elements {} and {} at {}", raw_.triangles[t].tag, raw_.triangles[u].tag,
                       at(raw_.points[std::size_t(raw_.triangles[t].v[0])]));
  }

 private:
  const RawMesh& raw_;
};

double twice_area(const RawMesh& raw, const RawTriangle& t) {
  const Vec2 &a = raw.points[std::size_t(t.v[0])], &b = raw.points[std::size_t(t.v[1])],
             &c = raw.points[std::size_t(t.v[2])];
  return cross(b - a, c - a);
}

/// A surface of gmsh may be turned over as a whole. Per triangle whether it is to be turned.
std::vector<bool> turned(const RawMesh& raw, const Blame& blame) {
  struct Count {
    std::size_t left = 0, right = 0, first_left = 0, first_right = 0;
  };
  std::map<std::int32_t, Count> counts;
  std::vector<bool> clockwise(raw.triangles.size());
  for (std::size_t t = 0; t < raw.triangles.size(); ++t) {
    const RawTriangle& cell = raw.triangles[t];
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i)
      longest = std::max(
          longest, (raw.points[std::size_t(cell.v[i])] - raw.points[std::size_t(cell.v[(i + 1) % 3])]).squaredNorm());
    const double twice = twice_area(raw, cell);
    if (!(std::abs(twice) > 1e-12 * longest) || !std::isfinite(longest) || !std::isnormal(twice))
      blame.fail(fmt::format("{} has no area", blame.element(t)));
    Count& count = counts[cell.entity];
    clockwise[t] = twice < 0;
    if (twice < 0 && count.right++ == 0) count.first_right = t;
    if (twice > 0 && count.left++ == 0) count.first_left = t;
  }
  for (const auto& [entity, count] : counts)
    if (count.left > 0 && count.right > 0)
      blame.fail(
          fmt::format("{} is turned over: its corners run the other way round than those of the other triangles "
                      "of its surface",
                      blame.element(count.left < count.right ? count.first_left : count.first_right)));
  return clockwise;
}

/// Nodes of triangles that lie in one place get one vertex; vertices in the order of the nodes.
void number_vertices(const RawMesh& raw, Welded& out) {
  std::vector<bool> used(raw.points.size(), false);
  for (const RawTriangle& t : raw.triangles)
    for (const Index v : t.v) used[std::size_t(v)] = true;
  std::vector<Index> order;
  for (std::size_t p = 0; p < used.size(); ++p)
    if (used[p]) order.push_back(Index(p));
  const auto less = [&](Index a, Index b) {
    const Vec2 &p = raw.points[std::size_t(a)], &q = raw.points[std::size_t(b)];
    return p.x() != q.x() ? p.x() < q.x() : p.y() != q.y() ? p.y() < q.y() : a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<Index> first(raw.points.size(), none);
  for (std::size_t i = 0; i < order.size(); ++i)
    first[std::size_t(order[i])] = i > 0 && raw.points[std::size_t(order[i])] == raw.points[std::size_t(order[i - 1])]
                                       ? first[std::size_t(order[i - 1])]
                                       : order[i];
  out.vertex.assign(raw.points.size(), none);
  for (std::size_t p = 0; p < used.size(); ++p) {
    if (!used[p]) continue;
    if (first[p] == Index(p)) {
      out.vertex[p] = Index(out.node.size());
      out.node.push_back(Index(p));
      out.mesh.points.push_back(raw.points[p]);
    } else {
      out.vertex[p] = out.vertex[std::size_t(first[p])];
    }
  }
}

/// Why the triangles cannot be connected.
[[noreturn]] void explain(const Blame& blame, const Welded& w, const std::vector<std::array<Index, 3>>& triangles) {
  std::map<std::array<Index, 3>, std::size_t> corners;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::array<Index, 3> key = triangles[t];
    std::sort(key.begin(), key.end());
    if (const auto [place, fresh] = corners.emplace(key, t); !fresh)
      blame.fail(fmt::format("{} have the same corners", blame.elements(place->second, t)));
  }
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> on_edge;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) on_edge[std::minmax(triangles[t][i], triangles[t][(i + 1) % 3])].push_back(t);
  for (const auto& [ends, list] : on_edge)
    if (list.size() > 2)
      blame.fail(fmt::format("the edge from {} to {} has {} triangles; it may have two",
                             blame.node(w.node[std::size_t(ends.first)]), blame.node(w.node[std::size_t(ends.second)]),
                             list.size()));
  std::map<std::pair<Index, Index>, std::size_t> half;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (const auto [place, fresh] = half.emplace(std::pair(triangles[t][i], triangles[t][(i + 1) % 3]), t); !fresh)
        blame.fail(fmt::format("{} overlap: they lie on the same side of an edge", blame.elements(place->second, t)));
  blame.fail("the triangles do not fit together");
}

/// Whether two triangles have different nodes on the edge between them.
std::vector<bool> doubled_edges(const RawMesh& raw, const Welded& w) {
  const Mesh& mesh = w.mesh;
  std::vector<bool> doubled(mesh.edges.size(), false);
  const auto node = [&](Index triangle, Index vertex) {
    for (const Index n : raw.triangles[std::size_t(triangle)].v)
      if (w.vertex[std::size_t(n)] == vertex) return n;
    return none;
  };
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [left, right] = mesh.sides[e];
    if (left == none || right == none) continue;
    for (const Index v : mesh.edges[e])
      if (node(left, v) != node(right, v)) doubled[e] = true;
  }
  return doubled;
}

}  // namespace

Welded weld(const RawMesh& raw) {
  const Blame blame(raw);
  if (raw.triangles.empty()) blame.fail("there are no triangles; mesh the surfaces (gmsh -2), and save them");
  const std::vector<bool> clockwise = turned(raw, blame);
  Welded out;
  number_vertices(raw, out);
  std::vector<std::array<Index, 3>> triangles;
  triangles.reserve(raw.triangles.size());
  for (std::size_t t = 0; t < raw.triangles.size(); ++t) {
    auto [a, b, c] = raw.triangles[t].v;
    if (clockwise[t]) std::swap(b, c);
    triangles.push_back({out.vertex[std::size_t(a)], out.vertex[std::size_t(b)], out.vertex[std::size_t(c)]});
  }
  try {
    out.mesh = connect(out.mesh.points, triangles, {});
  } catch (const std::invalid_argument&) {
    explain(blame, out, triangles);
  }
  out.doubled = doubled_edges(raw, out);
  Vec2 low = out.mesh.points.front(), high = low;
  for (const Vec2& x : out.mesh.points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  out.extent = (high - low).norm();
  return out;
}

namespace {

/// Edges of the rim in the cells of a grid that they pass.
class RimGrid {
 public:
  RimGrid(const Mesh& mesh, const std::vector<Index>& rim, double extent) : mesh_(mesh) {
    double sum = 0;
    for (const Index e : rim) sum += length(mesh, e);
    // Cells about as long as the mean edge; not more than 2000 across, however fine the mesh is at a tip.
    step_ = std::max(sum / double(rim.size()), extent / 2000);
    origin_ = mesh.points.front();
    for (const Index e : rim) each_cell(e, [&](std::uint64_t key) { cells_[key].push_back(e); });
  }

  template <typename Visit>
  void each_near(Index edge, Visit&& visit) const {
    each_cell(edge, [&](std::uint64_t key) {
      if (const auto found = cells_.find(key); found != cells_.end())
        for (const Index other : found->second) visit(other);
    });
  }

 private:
  static std::uint64_t key(std::int32_t i, std::int32_t j) {
    return (std::uint64_t(std::uint32_t(i)) << 32) | std::uint32_t(j);
  }

  /// Column by column; a margin, so that what touches shares a cell.
  template <typename Visit>
  void each_cell(Index edge, Visit&& visit) const {
    Vec2 a = (mesh_.points[std::size_t(mesh_.edges[std::size_t(edge)][0])] - origin_) / step_;
    Vec2 b = (mesh_.points[std::size_t(mesh_.edges[std::size_t(edge)][1])] - origin_) / step_;
    if (a.x() > b.x()) std::swap(a, b);
    constexpr double margin = 1e-6;
    const auto floor = [](double x) { return std::int32_t(std::floor(x)); };
    for (std::int32_t i = floor(a.x() - margin); i <= floor(b.x() + margin); ++i) {
      const double wide = b.x() - a.x();
      const auto y = [&](double x) {
        return wide > margin ? a.y() + (b.y() - a.y()) * std::clamp((x - a.x()) / wide, 0.0, 1.0) : a.y();
      };
      double low = std::min(y(i - margin), y(i + 1 + margin)), high = std::max(y(i - margin), y(i + 1 + margin));
      if (wide <= margin) low = std::min(a.y(), b.y()), high = std::max(a.y(), b.y());
      for (std::int32_t j = floor(low - margin); j <= floor(high + margin); ++j) visit(key(i, j));
    }
  }

  const Mesh& mesh_;
  double step_;
  Vec2 origin_;
  std::unordered_map<std::uint64_t, std::vector<Index>> cells_;
};

void check_touching(const Blame& blame, const Welded& w, const std::vector<Index>& rim) {
  const Mesh& mesh = w.mesh;
  const RimGrid grid(mesh, rim, w.extent);
  const auto ends = [&](Index e) { return mesh.edges[std::size_t(e)]; };
  const auto point = [&](Index v) -> const Vec2& { return mesh.points[std::size_t(v)]; };
  // Hanging nodes first: edges cross there, too.
  for (const bool hanging : {true, false})
    for (const Index e : rim)
      grid.each_near(e, [&](Index f) {
        const auto [a, b] = ends(e);
        const auto [c, d] = ends(f);
        if (hanging) {
          for (const Index v : {c, d})
            if (v != a && v != b && distance(point(v), point(a), point(b)) <= 1e-12 * w.extent)
              blame.fail(fmt::format("{} lies on the edge from {} to {} without being one of its ends: a hanging node",
                                     blame.node(w.node[std::size_t(v)]), blame.node(w.node[std::size_t(a)]),
                                     blame.node(w.node[std::size_t(b)])));
          return;
        }
        if (a == c || a == d || b == c || b == d || !cross_inside(point(a), point(b), point(c), point(d))) return;
        const auto triangle = [&](Index edge) {
          const auto& [left, right] = mesh.sides[std::size_t(edge)];
          return std::size_t(std::max(left, right));
        };
        blame.fail(fmt::format("{} overlap", blame.elements(triangle(e), triangle(f))));
      });
}

void check_fans(const Blame& blame, const Welded& w, const std::vector<Index>& rim) {
  const Mesh& mesh = w.mesh;
  std::vector<std::int32_t> ends(mesh.points.size(), 0);
  for (const Index e : rim)
    for (const Index v : mesh.edges[std::size_t(e)]) ++ends[std::size_t(v)];
  for (std::size_t v = 0; v < ends.size(); ++v)
    if (ends[v] > 2) blame.fail(fmt::format("the body touches itself at {}; its rim must not", blame.node(w.node[v])));
  std::vector<double> around(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 p = mesh.points[std::size_t(t[(i + 1) % 3])] - mesh.points[std::size_t(t[i])],
                 q = mesh.points[std::size_t(t[(i + 2) % 3])] - mesh.points[std::size_t(t[i])];
      around[std::size_t(t[i])] += std::atan2(cross(p, q), p.dot(q));
    }
  for (std::size_t v = 0; v < around.size(); ++v)
    if (around[v] > 2 * pi + 0.1)
      blame.fail(fmt::format("triangles overlap around {}: their angles there add up to {:.4g} degrees",
                             blame.node(w.node[v]), around[v] * 180 / pi));
}

}  // namespace

void check_rim(const RawMesh& raw, const Welded& w) {
  const Blame blame(raw);
  const Mesh& mesh = w.mesh;
  std::vector<Index> rim;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none) rim.push_back(Index(e));
  if (rim.empty()) blame.fail("the triangles have no rim: they overlap");
  check_touching(blame, w, rim);
  const std::vector<Index> piece = pieces(mesh, std::vector<bool>(mesh.edges.size(), false));
  for (std::size_t t = 0; t < piece.size(); ++t)
    if (piece[t] != 0)
      blame.fail(
          fmt::format("there are several bodies: {} is not connected with {}", blame.element(t), blame.element(0)));
  check_fans(blame, w, rim);
}

}  // namespace kerf
