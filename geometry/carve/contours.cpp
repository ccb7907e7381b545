// Closed contours of what is inside: per triangle with two signs a link from the edge by which its boundary leaves to
// the one by which it enters, along the frame a link per edge that is partly inside; each node has one successor.

#include "geometry/carve/contours.hpp"

#include <utility>

namespace kerf {

/// Links are taken once each, so that every loop is found once; a triangle has one link at most.
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
    const Index a = Index(v), b = ends_of(mesh, e)[1], along = rim.strand[std::size_t(e)];
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

}  // namespace kerf
