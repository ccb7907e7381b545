// Cracks of the frame, cut to what lies inside.
// A crack is a path of vertices of the background; where the signs of two neighbours differ the edge between is cut at
// its crossing. Parts shorter than `least` are dropped, with a note; the rest keeps the kinks between its ends, arcs
// their circle.
// Places on an arc are lengths along its circle, on a polyline lengths along its edges. An end that was cut names the
// edge of the background, so that the zero line is made to meet it (carve.cpp); an end of the crack itself names none.

#include "geometry/carve/contours.hpp"

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

/// A place on the path: a cut edge of the mesh, or none at the crack's own ends.
struct Mark {
  ContourNode node;
  double s = 0;
  Vec2 x;
};

/// The crack between two places.
Crack between(const Crack& crack, const Mark& from, const Mark& to, double near) {
  if (crack.arc) {
    const double radius = largest_radius(*crack.arc), sign = crack.arc->to < crack.arc->from ? -1 : 1;
    Arc arc = *crack.arc;
    arc.from = crack.arc->from + sign * from.s / radius;
    arc.to = crack.arc->from + sign * to.s / radius;
    return {"", {from.x, to.x}, arc};
  }
  Crack part{"", {from.x}, {}};
  double s = 0;
  for (std::size_t i = 0; i < crack.points.size(); ++i) {
    if (i > 0) s += (crack.points[i] - crack.points[i - 1]).norm();
    if (s > from.s + near && s < to.s - near) part.points.push_back(crack.points[i]);
  }
  part.points.push_back(to.x);
  return part;
}

/// One crack of the frame, to be cut.
struct Cutter {
  const Block& block;
  const Signs& signs;
  const double least;
  std::vector<std::string>& notes;
  const Index number;
  const Crack& crack = block.frame.cracks[std::size_t(number)];
  const Path path = path_of(crack, block.mesh, block.mesh.cracks[std::size_t(number)]);
  const double whole = path_length(crack);
  bool stub = false;

  /// Where edge i of the path is crossed.
  Mark cut(std::size_t i) const {
    Mark mark{{path.edges[i]}, 0, place(block, signs, path.edges[i])};
    const bool forward = block.mesh.edges[std::size_t(path.edges[i])][0] == path.vertices[i];
    const double t = crossing(block.mesh, signs, path.edges[i]);
    mark.s = crack.arc ? turned(*crack.arc, mark.x) * largest_radius(*crack.arc)
                       : path.s[i] + (forward ? t : 1 - t) * (path.s[i + 1] - path.s[i]);
    return mark;
  }

  void note_passed_ends(const Mark& from, const Mark& to) const {
    for (const auto& [edge, gone, tip] : {std::tuple(from.node.edge, from.s, crack.points.front()),
                                          std::tuple(to.node.edge, whole - to.s, crack.points.back())})
      if (edge != none && gone < least / 2)
        notes.push_back(
            fmt::format("the zero line passes the end of crack '{}' at ({:.4g}, {:.4g}) within {:.3g}: "
                        "the crack ends on it",
                        crack.name, tip.x(), tip.y(), least / 2));
  }

  /// What lies inside, in parts; stubs are left out.
  std::vector<CrackPart> parts() {
    const auto inside = [&](std::size_t i) { return bool(signs.inside[std::size_t(path.vertices[i])]); };
    const std::size_t last = path.vertices.size() - 1;
    std::vector<CrackPart> parts;
    for (std::size_t i = 0; i <= last;) {
      if (!inside(i)) {
        ++i;
        continue;
      }
      Mark from{{}, 0, crack.points.front()}, to{{}, whole, crack.points.back()};
      if (i > 0) from = cut(i - 1);
      while (i <= last && inside(i)) ++i;
      if (i <= last) to = cut(i - 1);
      if (from.node.edge == none && to.node.edge == none) {
        parts.push_back({number, {}, {}, crack});
      } else if (to.s - from.s < least) {
        notes.push_back(fmt::format("dropped a stub of crack '{}', {:.3g} long, at ({:.4g}, {:.4g})", crack.name,
                                    to.s - from.s, from.x.x(), from.x.y()));
        stub = true;
      } else {
        note_passed_ends(from, to);
        parts.push_back({number, from.node, to.node, between(crack, from, to, least / 64)});
      }
    }
    return parts;
  }

  void note_rest(const std::vector<CrackPart>& parts) const {
    if (parts.empty()) {
      notes.push_back(fmt::format("crack '{}' lies in the void{}", crack.name, stub ? ", but for stubs" : ""));
    } else if (parts.size() > 1 || parts[0].from.edge != none || parts[0].to.edge != none) {
      double rest = 0;
      for (const CrackPart& part : parts) rest += path_length(part.shape);
      notes.push_back(fmt::format("crack '{}' is cut to {:.4g} of its length of {:.4g}{}", crack.name, rest, whole,
                                  parts.size() > 1 ? fmt::format(", in {} parts", parts.size()) : ""));
    }
  }
};

}  // namespace

std::vector<CrackPart> cut_cracks(const Block& block, const Signs& signs, double least,
                                  std::vector<std::string>& notes) {
  if (block.mesh.cracks.size() != block.frame.cracks.size())
    throw std::invalid_argument(fmt::format("a background with {} cracks for a frame with {}", block.mesh.cracks.size(),
                                            block.frame.cracks.size()));
  std::vector<CrackPart> all;
  for (std::size_t c = 0; c < block.frame.cracks.size(); ++c) {
    Cutter cutter{block, signs, least, notes, Index(c)};
    const std::vector<CrackPart> parts = cutter.parts();
    cutter.note_rest(parts);
    all.insert(all.end(), parts.begin(), parts.end());
  }
  return all;
}

}  // namespace kerf
