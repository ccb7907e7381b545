// Cracks of the frame, cut to what lies inside.

#include "geometry/carve/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kerf {

namespace {

/// A crack as the background has it: vertices along the path, and how far along the path they lie.
struct Path {
  std::vector<Index> vertices, edges;
  std::vector<double> s;
};

/// Turning angle from the start of the arc to the point's direction, along the arc.
double turned(const Arc& arc, const Vec2& x) {
  const double turn = arc.to - arc.from;
  // Near the start a hair before it, not a whole turn after it.
  const double ahead = beyond_middle(arc, x) + turn / 2;
  return turn < 0 ? -ahead : ahead;
}

Path path_of(const Crack& crack, const Mesh& mesh, const std::vector<CrackEdge>& edges) {
  Path path;
  for (const CrackEdge& e : edges) {
    const auto& [a, b] = mesh.edges[std::size_t(e.edge)];
    if (path.vertices.empty()) path.vertices.push_back(e.forward ? a : b);
    path.vertices.push_back(e.forward ? b : a);
    path.edges.push_back(e.edge);
  }
  double sum = 0;
  for (std::size_t i = 0; i < path.vertices.size(); ++i) {
    const Vec2& x = mesh.points[std::size_t(path.vertices[i])];
    if (crack.arc) {
      path.s.push_back(turned(*crack.arc, x) * largest_radius(*crack.arc));
    } else {
      if (i > 0) sum += (x - mesh.points[std::size_t(path.vertices[i - 1])]).norm();
      path.s.push_back(sum);
    }
  }
  return path;
}

/// The crack between two distances along it, ends given.
Crack between(const Crack& crack, double from, double to, const Vec2& start, const Vec2& end, double near) {
  if (crack.arc) {
    const double radius = largest_radius(*crack.arc), sign = crack.arc->to < crack.arc->from ? -1 : 1;
    Arc arc = *crack.arc;
    arc.from = crack.arc->from + sign * from / radius;
    arc.to = crack.arc->from + sign * to / radius;
    return {"", {start, end}, arc};
  }
  Crack part{"", {start}, {}};
  double s = 0;
  for (std::size_t i = 0; i < crack.points.size(); ++i) {
    if (i > 0) s += (crack.points[i] - crack.points[i - 1]).norm();
    if (s > from + near && s < to - near) part.points.push_back(crack.points[i]);
  }
  part.points.push_back(end);
  return part;
}

}  // namespace

std::vector<CrackPart> cut_cracks(const Shape& frame, const Mesh& mesh, const Signs& signs, const Rim& rim,
                                  double least, std::vector<std::string>& notes) {
  if (mesh.cracks.size() != frame.cracks.size())
    throw std::invalid_argument(
        fmt::format("a background with {} cracks for a frame with {}", mesh.cracks.size(), frame.cracks.size()));
  std::vector<CrackPart> parts;
  for (std::size_t c = 0; c < frame.cracks.size(); ++c) {
    const Crack& crack = frame.cracks[c];
    const Path path = path_of(crack, mesh, mesh.cracks[c]);
    const auto inside = [&](std::size_t i) { return bool(signs.inside[std::size_t(path.vertices[i])]); };
    const std::size_t last = path.vertices.size() - 1, known = parts.size();
    const double whole = path_length(crack);
    // Where edge i of the path is crossed.
    const auto cut = [&](std::size_t i, ContourNode& node, double& s, Vec2& x) {
      node.edge = path.edges[i];
      x = place(frame, mesh, signs, rim, node.edge);
      const bool forward = mesh.edges[std::size_t(node.edge)][0] == path.vertices[i];
      const double t = crossing(mesh, signs, node.edge);
      s = crack.arc ? turned(*crack.arc, x) * largest_radius(*crack.arc)
                    : path.s[i] + (forward ? t : 1 - t) * (path.s[i + 1] - path.s[i]);
    };
    bool stub = false;
    for (std::size_t i = 0; i <= last;) {
      if (!inside(i)) {
        ++i;
        continue;
      }
      CrackPart part{Index(c), {}, {}, {}};
      double from = 0, to = whole;
      Vec2 start = crack.points.front(), end = crack.points.back();
      if (i > 0) cut(i - 1, part.from, from, start);
      while (i <= last && inside(i)) ++i;
      if (i <= last) cut(i - 1, part.to, to, end);
      if (part.from.edge == none && part.to.edge == none) {
        part.shape = crack;
      } else if (to - from < least) {
        notes.push_back(fmt::format("dropped a stub of crack '{}', {:.3g} long, at ({:.4g}, {:.4g})", crack.name,
                                    to - from, start.x(), start.y()));
        stub = true;
        continue;
      } else {
        for (const auto& [edge, gone, tip] : {std::tuple(part.from.edge, from, crack.points.front()),
                                              std::tuple(part.to.edge, whole - to, crack.points.back())})
          if (edge != none && gone < least / 2)
            notes.push_back(
                fmt::format("the zero line passes the end of crack '{}' at ({:.4g}, {:.4g}) within {:.3g}: "
                            "the crack ends on it",
                            crack.name, tip.x(), tip.y(), least / 2));
        part.shape = between(crack, from, to, start, end, least / 64);
      }
      parts.push_back(std::move(part));
    }
    const std::size_t count = parts.size() - known;
    if (count == 0) {
      notes.push_back(fmt::format("crack '{}' lies in the void{}", crack.name, stub ? ", but for stubs" : ""));
    } else if (count > 1 || parts[known].from.edge != none || parts[known].to.edge != none) {
      double rest = 0;
      for (std::size_t k = known; k < parts.size(); ++k) rest += path_length(parts[k].shape);
      notes.push_back(fmt::format("crack '{}' is cut to {:.4g} of its length of {:.4g}{}", crack.name, rest, whole,
                                  count > 1 ? fmt::format(", in {} parts", count) : ""));
    }
  }
  return parts;
}

}  // namespace kerf
