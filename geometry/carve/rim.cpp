// Which side of the frame each boundary edge of its mesh lies on: a walk along each loop of the boundary, from the
// vertex nearest the first corner of the loop, a strand further at each corner. Corners are met within 1e-6 of the
// extent; between two arcs that go on smoothly, where the mesher moves points to keep the area (mesher/split.cpp),
// within a tenth of an edge. What does not follow is no mesh of the frame and throws.
// A whole circle has one strand and no corners: its walk starts at the nearest vertex and ends there. Every vertex of
// the boundary belongs to one loop, which leaves it by one edge with the body on its left.

#include "geometry/carve/rim.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

bool on_boundary(const Mesh& mesh, Index edge) {
  return mesh.sides[std::size_t(edge)][0] == none || mesh.sides[std::size_t(edge)][1] == none;
}

/// The mesher moves corners between arcs that go on smoothly, by less than this part of an edge, to keep the area.
constexpr double most_moved = 0.1;

Index nearest(const Mesh& mesh, const std::vector<Index>& vertices, const Vec2& x) {
  Index found = none;
  double least = infinity;
  for (const Index v : vertices)
    if (const double d = (mesh.points[std::size_t(v)] - x).squaredNorm(); d < least) found = v, least = d;
  return found;
}

[[noreturn]] void no_mesh_of(const Shape& frame, std::size_t loop) {
  throw std::invalid_argument(
      fmt::format("the background is no mesh of the frame: its boundary does not follow {}",
                  loop == 0 ? "the outline" : fmt::format("hole '{}'", frame.holes[loop - 1].name)));
}

}  // namespace

std::array<Index, 2> ends_of(const Mesh& mesh, Index boundary_edge) {
  const auto& [a, b] = mesh.edges[std::size_t(boundary_edge)];
  if (mesh.sides[std::size_t(boundary_edge)][0] != none) return {a, b};
  return {b, a};
}

bool has(const std::vector<Index>& labels, Index label) {
  return std::ranges::find(labels, label) != labels.end();
}

std::string text(const Vec2& x) {
  return fmt::format("({:.4g}, {:.4g})", x.x(), x.y());
}

/// A reversed loop of the frame has its strands in the opposite order, hence `side`.
Rim find_rim(const Shape& frame, const Mesh& mesh) {
  Rim rim;
  rim.drawing = draw(Shape{frame.outline, frame.holes, {}, frame.labels, {}});
  rim.strand.assign(mesh.edges.size(), none);
  rim.corner.assign(mesh.points.size(), false);
  rim.next_edge.assign(mesh.points.size(), none);
  std::vector<Index> boundary;  // vertices
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (on_boundary(mesh, Index(e))) {
      const Index from = ends_of(mesh, Index(e))[0];
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
    const auto reach = [&](std::size_t k, Index edge) {
      const auto is_arc = [&](std::size_t i) { return strands[first + i % count].arc.has_value(); };
      return is_arc(k) && is_arc(k + count - 1) ? std::max(near, most_moved * length(mesh, edge)) : near;
    };
    const Index start = nearest(mesh, boundary, corner(0));
    // The points of whole circles lie off them, a little.
    const bool whole = count == 1;
    if (start == none ||
        (!whole && (mesh.points[std::size_t(start)] - corner(0)).norm() > reach(0, rim.next_edge[std::size_t(start)])))
      no_mesh_of(frame, loop);
    std::size_t k = 0;
    Index v = start;
    do {
      const Index e = rim.next_edge[std::size_t(v)];
      if (e == none || rim.strand[std::size_t(e)] != none || k == count) no_mesh_of(frame, loop);
      rim.strand[std::size_t(e)] = Index(first + k);
      ++known;
      v = ends_of(mesh, e)[1];
      if (!whole && (mesh.points[std::size_t(v)] - corner(k + 1)).norm() <= reach(k + 1, e)) {
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

}  // namespace kerf
