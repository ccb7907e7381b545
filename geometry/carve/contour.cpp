#include "geometry/carve/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf {

namespace {

/// Boundary edges leave their vertex with the body on their left.
std::array<Index, 2> ends(const Mesh& mesh, Index boundary_edge) {
  const auto& [a, b] = mesh.edges[std::size_t(boundary_edge)];
  if (mesh.sides[std::size_t(boundary_edge)][0] != none) return {a, b};
  return {b, a};
}

bool on_boundary(const Mesh& mesh, Index edge) {
  return mesh.sides[std::size_t(edge)][0] == none || mesh.sides[std::size_t(edge)][1] == none;
}

[[noreturn]] void no_mesh_of(const Shape& frame, std::size_t loop) {
  throw std::invalid_argument(
      fmt::format("the background is no mesh of the frame: its boundary does not follow {}",
                  loop == 0 ? "the outline" : fmt::format("hole '{}'", frame.holes[loop - 1].name)));
}

}  // namespace

Vec2 onto(const Arc& arc, const Vec2& x) {
  return at(arc, parameter(arc, x));
}

Rim find_rim(const Shape& frame, const Mesh& mesh) {
  Rim rim;
  rim.drawing = draw(Shape{frame.outline, frame.holes, {}, frame.labels, {}});
  rim.strand.assign(mesh.edges.size(), none);
  rim.corner.assign(mesh.points.size(), false);
  rim.next_edge.assign(mesh.points.size(), none);
  std::vector<Index> boundary;  // vertices
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (on_boundary(mesh, Index(e))) {
      const Index from = ends(mesh, Index(e))[0];
      if (rim.next_edge[std::size_t(from)] != none)
        throw std::invalid_argument("the background touches itself at a vertex of its boundary");
      rim.next_edge[std::size_t(from)] = Index(e);
      boundary.push_back(from);
    }

  const std::vector<Strand>& strands = rim.drawing.strands;
  const double near = join_tolerance * rim.drawing.extent;
  std::size_t known = 0;
  for (std::size_t first = 0; first < strands.size();) {
    const std::size_t loop = std::size_t(strands[first].loop);
    const Loop& drawn = loop == 0 ? frame.outline : frame.holes[loop - 1];
    const std::size_t count = drawn.sides.size();
    rim.reversed.push_back((signed_area(drawn) > 0) != (loop == 0));
    for (std::size_t k = 0; k < count; ++k) rim.side.push_back(Index(rim.reversed.back() ? count - 1 - k : k));
    const auto corner = [&](std::size_t k) {
      return rim.drawing.corners[std::size_t(strands[first + k % count].from)];
    };
    Index start = none;
    double least = std::numeric_limits<double>::infinity();
    for (const Index v : boundary) {
      const double d = (mesh.points[std::size_t(v)] - corner(0)).squaredNorm();
      if (d < least) start = v, least = d;
    }
    // The points of whole circles lie off them, a little.
    const bool whole = count == 1;
    if (start == none || (!whole && std::sqrt(least) > near)) no_mesh_of(frame, loop);
    std::size_t k = 0;
    Index v = start;
    do {
      const Index e = rim.next_edge[std::size_t(v)];
      if (e == none || rim.strand[std::size_t(e)] != none || k == count) no_mesh_of(frame, loop);
      rim.strand[std::size_t(e)] = Index(first + k);
      ++known;
      v = ends(mesh, e)[1];
      if (!whole && (mesh.points[std::size_t(v)] - corner(k + 1)).norm() <= near) {
        rim.corner[std::size_t(v)] = true;
        ++k;
      }
    } while (v != start);
    if (!whole && k != count) no_mesh_of(frame, loop);
    first += count;
  }
  if (known != boundary.size())
    throw std::invalid_argument("the background is no mesh of the frame: it has more boundary");
  return rim;
}

std::vector<Contour> contours(const Mesh& mesh, const Signs& signs, const Rim& rim) {
  // Nodes: crossed edges, then vertices on the boundary.
  const std::size_t edges = mesh.edges.size();
  std::vector<Index> next(edges + mesh.points.size(), none), strand(next.size(), none), starts;
  const auto link = [&](std::size_t from, std::size_t to, Index along) {
    next[from] = Index(to);
    strand[from] = along;
    starts.push_back(Index(from));
  };
  const auto inside = [&](Index v) { return bool(signs.inside[std::size_t(v)]); };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const int count = inside(v[0]) + inside(v[1]) + inside(v[2]);
    if (count == 0 || count == 3) continue;
    Index out = none, in = none;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool here = inside(v[(i + 1) % 3]), there = inside(v[(i + 2) % 3]);
      if (here != there) (here ? out : in) = mesh.edges_of[t][i];
    }
    link(std::size_t(out), std::size_t(in), none);
  }
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Index e = rim.next_edge[v];
    if (e == none) continue;
    const Index a = Index(v), b = ends(mesh, e)[1], along = rim.strand[std::size_t(e)];
    if (!inside(a) && !inside(b)) continue;
    link(inside(a) ? edges + v : std::size_t(e), inside(b) ? edges + std::size_t(b) : std::size_t(e), along);
  }
  std::vector<Contour> loops;
  for (const Index start : starts) {
    if (next[std::size_t(start)] == none) continue;
    Contour loop;
    for (Index at = start; next[std::size_t(at)] != none;) {
      const bool edge = std::size_t(at) < edges;
      loop.nodes.push_back({edge ? at : none, edge ? none : Index(std::size_t(at) - edges)});
      loop.strand.push_back(strand[std::size_t(at)]);
      at = std::exchange(next[std::size_t(at)], none);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

Vec2 place(const Shape& frame, const Mesh& mesh, const Signs& signs, const Rim& rim, Index edge) {
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  const Vec2 &p = mesh.points[std::size_t(a)], &q = mesh.points[std::size_t(b)];
  const Vec2 x = p + crossing(mesh, signs, edge) * (q - p);
  if (const Index s = rim.strand[std::size_t(edge)]; s != none) {
    const Strand& strand = rim.drawing.strands[std::size_t(s)];
    return strand.arc ? onto(*strand.arc, x) : x;
  }
  if (const Index c = mesh.crack[std::size_t(edge)]; c != none && frame.cracks[std::size_t(c)].arc)
    return onto(*frame.cracks[std::size_t(c)].arc, x);
  return x;
}

}  // namespace kerf
