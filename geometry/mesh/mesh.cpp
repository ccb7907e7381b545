// The mesh and its connections: edges between pairs of vertices by a counting sort of half edges, triangles on the left
// and right of every edge (an edge runs from its smaller to its larger vertex), labels, cracks, regions; corners split
// at cracks, connected pieces, and refinement of every triangle into four. Edges are sorted by (smaller, larger)
// vertex, so that their numbers follow from the vertices alone: two meshes with the same vertices in the same order
// have the same edges in the same directions. Divided edges of curved sides lie on their arcs, bit for bit those that
// `refine` makes.

#include "kerf/mesh.hpp"
#include "geometry/plane.hpp"
#include "geometry/topology.hpp"
#include "kerf/folded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr Index next(Index i) {
  return i == 2 ? 0 : i + 1;
}
constexpr Index previous(Index i) {
  return i == 0 ? 2 : i - 1;
}

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, c - a);
}

/// A triangle's edge, filed under its smaller vertex.
struct Half {
  Index other;     // the larger vertex
  Index triangle;  // on its left when it runs from the smaller to the larger vertex there, else on its right
  std::int8_t edge;
  std::int8_t side;
};

/// A clockwise triangle would turn every normal of its edges.
void check_triangle(const std::vector<Vec2>& points, const std::array<Index, 3>& v, std::size_t number) {
  for (const Index i : v)
    if (i < 0 || std::size_t(i) >= points.size())
      throw std::invalid_argument(fmt::format("triangle {} names vertex {} of {}", number, i, points.size()));
  const double twice = twice_area(points[std::size_t(v[0])], points[std::size_t(v[1])], points[std::size_t(v[2])]);
  if (!(twice > 0) || !std::isfinite(twice))
    throw std::invalid_argument(
        fmt::format("triangle {} ({}, {}, {}) is degenerate or clockwise", number, v[0], v[1], v[2]));
}

/// Number of the edge between two vertices, edges sorted by (smaller, larger) vertex; none when there is no such edge.
Index find_edge(const Mesh& mesh, const std::vector<Index>& first, Index a, Index b) {
  const auto [low, high] = std::minmax(a, b);
  if (low < 0 || std::size_t(low) + 1 >= first.size()) return none;
  const auto begin = mesh.edges.begin() + first[std::size_t(low)];
  const auto end = mesh.edges.begin() + first[std::size_t(low) + 1];
  const auto found = std::lower_bound(begin, end, high, [](const auto& edge, Index v) { return edge[1] < v; });
  return found != end && (*found)[1] == high ? Index(found - mesh.edges.begin()) : none;
}

void mark(Mesh& mesh, const std::vector<Index>& first, std::span<const Marked> marked) {
  Index cracks = 0;
  for (const Marked& m : marked) cracks = std::max(cracks, m.crack + 1);
  mesh.cracks.resize(std::size_t(cracks));
  for (const Marked& m : marked) {
    const Index e = find_edge(mesh, first, m.a, m.b);
    if (e == none) throw std::invalid_argument(fmt::format("marked pair ({}, {}) is no edge of the mesh", m.a, m.b));
    if (m.label != none) mesh.label[std::size_t(e)] = m.label;
    if (m.crack == none) continue;
    if (mesh.sides[std::size_t(e)][0] == none || mesh.sides[std::size_t(e)][1] == none)
      throw std::invalid_argument(fmt::format("crack edge ({}, {}) lies on the boundary", m.a, m.b));
    if (mesh.crack[std::size_t(e)] != none)
      throw std::invalid_argument(fmt::format("edge ({}, {}) is marked as crack twice", m.a, m.b));
    mesh.crack[std::size_t(e)] = m.crack;
    mesh.cracks[std::size_t(m.crack)].push_back({e, m.a < m.b});
  }
}

}  // namespace

Mesh connect(std::vector<Vec2> points, std::vector<std::array<Index, 3>> triangles, std::span<const Marked> marked,
             std::vector<Index> region) {
  if (!region.empty() && region.size() != triangles.size())
    throw std::invalid_argument(fmt::format("regions of {} triangles for {}", region.size(), triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) check_triangle(points, triangles[t], t);

  // Counting sort of the half edges by their smaller vertex, then each short list by the larger one.
  std::vector<Index> start(points.size() + 1, 0);
  for (const auto& v : triangles)
    for (Index i = 0; i < 3; ++i)
      ++start[std::size_t(std::min(v[std::size_t(next(i))], v[std::size_t(previous(i))])) + 1];
  for (std::size_t v = 0; v < points.size(); ++v) start[v + 1] += start[v];
  std::vector<Half> halves(3 * triangles.size());
  std::vector<Index> fill(start.begin(), start.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (Index i = 0; i < 3; ++i) {
      const Index a = triangles[t][std::size_t(next(i))], b = triangles[t][std::size_t(previous(i))];
      const auto [low, high] = std::minmax(a, b);
      halves[std::size_t(fill[std::size_t(low)]++)] = {high, Index(t), std::int8_t(i), std::int8_t(a < b ? 0 : 1)};
    }

  Mesh mesh;
  mesh.edges.reserve(points.size() + triangles.size() + 16);
  mesh.sides.reserve(points.size() + triangles.size() + 16);
  mesh.edges_of.resize(triangles.size());
  std::vector<Index> first(points.size() + 1, 0);
  for (std::size_t v = 0; v < points.size(); ++v) {
    first[v] = Index(mesh.edges.size());
    const auto begin = halves.begin() + start[v], end = halves.begin() + start[v + 1];
    std::sort(begin, end, [](const Half& a, const Half& b) {
      return a.other != b.other ? a.other < b.other : a.triangle < b.triangle;
    });
    for (auto h = begin; h != end; ++h) {
      if (h == begin || h->other != (h - 1)->other) {
        mesh.edges.push_back({Index(v), h->other});
        mesh.sides.push_back({none, none});
      }
      Index& side = mesh.sides.back()[std::size_t(h->side)];
      if (side != none)
        throw std::invalid_argument(
            fmt::format("edge ({}, {}) has two triangles on one side: {} and {}", v, h->other, side, h->triangle));
      side = h->triangle;
      mesh.edges_of[std::size_t(h->triangle)][std::size_t(h->edge)] = Index(mesh.edges.size()) - 1;
    }
  }
  first.back() = Index(mesh.edges.size());

  mesh.points = std::move(points);
  mesh.triangles = std::move(triangles);
  mesh.region = std::move(region);
  mesh.label.assign(mesh.edges.size(), none);
  mesh.crack.assign(mesh.edges.size(), none);
  mark(mesh, first, marked);
  return mesh;
}

Index region_of(const Mesh& mesh, Index triangle) {
  return mesh.region.empty() ? none : mesh.region[std::size_t(triangle)];
}

bool is_interface(const Mesh& mesh, Index edge) {
  const auto [left, right] = mesh.sides[std::size_t(edge)];
  return left != none && right != none && region_of(mesh, left) != region_of(mesh, right);
}

double area(const Mesh& mesh, Index triangle) {
  const auto& v = mesh.triangles[std::size_t(triangle)];
  return twice_area(mesh.points[std::size_t(v[0])], mesh.points[std::size_t(v[1])], mesh.points[std::size_t(v[2])]) / 2;
}

double length(const Mesh& mesh, Index edge) {
  const auto [a, b] = mesh.edges[std::size_t(edge)];
  return (mesh.points[std::size_t(b)] - mesh.points[std::size_t(a)]).norm();
}

// Out of the body.
Vec2 outward_normal(const Mesh& mesh, Index e) {
  return mesh.sides[e][1] == none ? normal(mesh, e) : Vec2(-normal(mesh, e));
}

Vec2 tangent(const Mesh& mesh, Index edge) {
  const auto [a, b] = mesh.edges[std::size_t(edge)];
  return (mesh.points[std::size_t(b)] - mesh.points[std::size_t(a)]).normalized();
}

Vec2 normal(const Mesh& mesh, Index edge) {
  const Vec2 t = tangent(mesh, edge);
  return {t.y(), -t.x()};
}

Vec2 centroid(const Mesh& mesh, Index triangle) {
  const auto& v = mesh.triangles[std::size_t(triangle)];
  return (mesh.points[std::size_t(v[0])] + mesh.points[std::size_t(v[1])] + mesh.points[std::size_t(v[2])]) / 3;
}

/// Of the smallest angle its tangent: one arctangent for the whole mesh.
Quality quality(const Mesh& mesh) {
  if (mesh.triangles.empty()) return {};
  double shortest = infinity, longest = 0;
  for (const auto& [a, b] : mesh.edges) {
    const double squared = (mesh.points[std::size_t(b)] - mesh.points[std::size_t(a)]).squaredNorm();
    shortest = std::min(shortest, squared);
    longest = std::max(longest, squared);
  }
  double sum = 0, smallest_tangent = infinity;
  for (const auto& v : mesh.triangles) {
    const Vec2 &p = mesh.points[std::size_t(v[0])], &q = mesh.points[std::size_t(v[1])],
               &r = mesh.points[std::size_t(v[2])];
    const double twice = twice_area(p, q, r);
    const double a = (r - q).squaredNorm(), b = (p - r).squaredNorm(), c = (q - p).squaredNorm();
    sum += 2 * std::sqrt(3.0) * twice / (a + b + c);
    // The smallest angle is opposite the shortest side: tan = twice / ((sum of the other two squares - its own) / 2).
    const double least = std::min({a, b, c});
    smallest_tangent = std::min(smallest_tangent, 2 * twice / (a + b + c - 2 * least));
  }
  const double degrees = 180 / pi;
  return {std::sqrt(shortest), std::sqrt(longest), std::atan(smallest_tangent) * degrees,
          sum / double(mesh.triangles.size())};
}

Corners split_for_stress(const Mesh& mesh) {
  std::vector<bool> cut(mesh.edges.size());
  for (std::size_t e = 0; e < cut.size(); ++e) cut[e] = mesh.crack[e] != none || is_interface(mesh, Index(e));
  return split_at(mesh, cut);
}

Corners split_at_cracks(const Mesh& mesh) {
  std::vector<bool> cut(mesh.edges.size());
  for (std::size_t e = 0; e < cut.size(); ++e) cut[e] = mesh.crack[e] != none;
  return split_at(mesh, cut);
}

/// A fan of triangles around a vertex, not across cut edges, shares one corner; the first fan keeps the vertex's
/// number.
Corners split_at(const Mesh& mesh, const std::vector<bool>& cut) {
  Corners corners;
  corners.of.assign(mesh.triangles.size(), {none, none, none});
  corners.vertex.resize(mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v) corners.vertex[v] = Index(v);
  std::vector<bool> taken(mesh.points.size(), false);

  // The first fan met at a vertex keeps the vertex's number, further fans get new ones.
  const auto sweep = [&](Index t, Index corner, Index number, bool turn_left) {
    const Index vertex = mesh.triangles[std::size_t(t)][std::size_t(corner)];
    while (true) {
      const Index e = mesh.edges_of[std::size_t(t)][std::size_t(turn_left ? next(corner) : previous(corner))];
      if (cut[std::size_t(e)]) return;
      const auto& [left, right] = mesh.sides[std::size_t(e)];
      t = left == t ? right : left;
      if (t == none) return;
      const auto& v = mesh.triangles[std::size_t(t)];
      corner = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
      if (corners.of[std::size_t(t)][std::size_t(corner)] != none) return;
      corners.of[std::size_t(t)][std::size_t(corner)] = number;
    }
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (Index i = 0; i < 3; ++i) {
      if (corners.of[t][std::size_t(i)] != none) continue;
      const Index vertex = mesh.triangles[t][std::size_t(i)];
      Index number = vertex;
      if (taken[std::size_t(vertex)]) {
        number = Index(corners.vertex.size());
        corners.vertex.push_back(vertex);
      }
      taken[std::size_t(vertex)] = true;
      corners.of[t][std::size_t(i)] = number;
      sweep(Index(t), i, number, true);
      sweep(Index(t), i, number, false);
    }
  return corners;
}

/// A flood over triangles, in the order of their numbers: piece 0 holds triangle 0.
std::vector<Index> pieces(const Mesh& mesh, const std::vector<bool>& cut) {
  std::vector<Index> piece(mesh.triangles.size(), none);
  std::vector<Index> stack;
  Index count = 0;
  for (std::size_t seed = 0; seed < piece.size(); ++seed) {
    if (piece[seed] != none) continue;
    piece[seed] = count;
    stack.push_back(Index(seed));
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (const Index e : mesh.edges_of[std::size_t(t)]) {
        if (cut[std::size_t(e)]) continue;
        for (const Index other : mesh.sides[std::size_t(e)])
          if (other != none && piece[std::size_t(other)] == none) {
            piece[std::size_t(other)] = count;
            stack.push_back(other);
          }
      }
    }
    ++count;
  }
  return piece;
}

namespace {

/// The edges that mean something, in two where they have a middle.
std::vector<Marked> halve_marked(const Mesh& mesh, const std::vector<Index>& middle) {
  std::vector<Marked> marked;
  const auto add = [&](Index a, Index b, Index edge, Index label, Index crack) {
    const Index m = middle[std::size_t(edge)];
    if (m != none) marked.push_back({a, m, label, crack});
    marked.push_back({m != none ? m : a, b, label, crack});
  };
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none) add(mesh.edges[e][0], mesh.edges[e][1], Index(e), mesh.label[e], none);
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c)
    for (const CrackEdge& piece : mesh.cracks[c]) {
      auto [a, b] = mesh.edges[std::size_t(piece.edge)];
      if (!piece.forward) std::swap(a, b);
      add(a, b, piece.edge, none, Index(c));
    }
  return marked;
}

}  // namespace

Vec2 middle_of(const Mesh& mesh, Index edge) {
  if (!mesh.arc.empty() && mesh.arc[std::size_t(edge)] != none) {
    const Arc& arc = mesh.arcs[std::size_t(mesh.arc[std::size_t(edge)])];
    return at(arc, (arc.from + arc.to) / 2);
  }
  const auto [a, b] = mesh.edges[std::size_t(edge)];
  return (mesh.points[std::size_t(a)] + mesh.points[std::size_t(b)]) / 2;
}

/// Halved time after time, as refine does: places in one step would round otherwise.
std::vector<Vec2> divided_edge(const Mesh& mesh, Index edge, int divisions) {
  const auto [a, b] = mesh.edges[std::size_t(edge)];
  const Arc* arc = mesh.arc.empty() || mesh.arc[std::size_t(edge)] == none
                       ? nullptr
                       : &mesh.arcs[std::size_t(mesh.arc[std::size_t(edge)])];
  std::vector<Vec2> x{mesh.points[std::size_t(a)], mesh.points[std::size_t(b)]};
  std::vector<double> place;
  if (arc) place = {arc->from, arc->to};
  for (int time = 0; time < divisions; ++time) {
    std::vector<Vec2> finer{x.front()};
    std::vector<double> finer_place;
    if (arc) finer_place = {place.front()};
    for (std::size_t i = 1; i < x.size(); ++i) {
      if (arc) {
        const double middle = (place[i - 1] + place[i]) / 2;
        finer_place.insert(finer_place.end(), {middle, place[i]});
        finer.push_back(at(*arc, middle));
      } else {
        finer.push_back((x[i - 1] + x[i]) / 2);
      }
      finer.push_back(x[i]);
    }
    x = std::move(finer);
    place = std::move(finer_place);
  }
  return x;
}

namespace {

/// The arcs of `mesh` on the edges of `fine`, in two where an edge has a middle.
/// Arcs run from the smaller vertex of their edge: of the second half that is b, as middles have the larger numbers.
void halve_arcs(const Mesh& mesh, const std::vector<Index>& middle, Mesh& fine) {
  if (mesh.arc.empty()) return;
  fine.arc.assign(fine.edges.size(), none);
  const auto add = [&](Index a, Index b, const Arc& arc) {
    const auto found = std::lower_bound(fine.edges.begin(), fine.edges.end(), std::array<Index, 2>{a, b});
    fine.arc[std::size_t(found - fine.edges.begin())] = Index(fine.arcs.size());
    fine.arcs.push_back(arc);
  };
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.arc[e] == none) continue;
    const auto [a, b] = mesh.edges[e];
    Arc first = mesh.arcs[std::size_t(mesh.arc[e])];
    if (middle[e] == none) {
      add(a, b, first);
      continue;
    }
    Arc second = first;  // from b: a middle has a larger number than its ends
    std::swap(second.from, second.to);
    first.to = second.to = (first.from + first.to) / 2;
    add(a, middle[e], first);
    add(b, middle[e], second);
  }
}

/// Middles that have moved from chords to arcs may have turned a triangle over.
void check_folds(const Mesh& mesh, const std::vector<Vec2>& points,
                 const std::vector<std::array<Index, 3>>& triangles) {
  if (mesh.arc.empty()) return;
  for (const auto& [a, b, c] : triangles) {
    const Vec2 &p = points[std::size_t(a)], &q = points[std::size_t(b)], &r = points[std::size_t(c)];
    if (twice_area(p, q, r) > 0) continue;
    throw FoldedTriangle((p + q + r) / 3);
  }
}

}  // namespace

Mesh halved(const Mesh& mesh, const std::vector<Index>& middle, std::vector<Vec2> points,
            std::vector<std::array<Index, 3>> triangles, std::vector<Index> region) {
  check_folds(mesh, points, triangles);
  Mesh fine = connect(std::move(points), std::move(triangles), halve_marked(mesh, middle), std::move(region));
  fine.cracks.resize(mesh.cracks.size());
  halve_arcs(mesh, middle, fine);
  return fine;
}

/// Children of triangle t are 4 t to 4 t + 3, three at its corners and one in the middle; edge e has the middle
/// vertices + e.
Mesh refine(const Mesh& mesh) {
  const Index vertices = Index(mesh.points.size());
  std::vector<Vec2> points = mesh.points;
  points.reserve(mesh.points.size() + mesh.edges.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) points.push_back(middle_of(mesh, Index(e)));

  std::vector<std::array<Index, 3>> triangles;
  triangles.reserve(4 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const auto [p, q, r] = mesh.edges_of[t];  // opposite a, b, c
    const Index bc = vertices + p, ca = vertices + q, ab = vertices + r;
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }

  std::vector<Index> region;
  for (const Index r : mesh.region) region.insert(region.end(), 4, r);
  std::vector<Index> middle(mesh.edges.size());
  for (std::size_t e = 0; e < middle.size(); ++e) middle[e] = vertices + Index(e);
  return halved(mesh, middle, std::move(points), std::move(triangles), std::move(region));
}

}  // namespace kerf
