// Sides and cracks of a body from a file along the curves that its edges lie on. Of a mesh of second order the arcs of
// the edges are joined as long as they lie on one curve; of a geometry, which gmsh gave points along each curve of,
// circles become arcs, other curves chains of arcs fitted to the points within curve_tolerance of the extent
// (fit_arcs). Pieces turn by at most a third of a turn, so that a side has an unambiguous arc between its ends.
// Everything else is straight sides. A crack is drawn as one arc where it lies on one circle, and as a polyline
// otherwise: corners of the points along its curves within the tolerance.

#include "io/mesh/curves.hpp"

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

const RawCurve* curve_of(const OnCurves& on, Index edge) {
  const auto found = on.curves.find(on.entity[std::size_t(edge)]);
  return found == on.curves.end() ? nullptr : &found->second;
}

bool is_circle(const RawCurve* curve) {
  return curve && curve->kind == RawCurve::Kind::Circle;
}

bool is_other(const RawCurve* curve) {
  return curve && curve->kind == RawCurve::Kind::Other;
}

/// The angle by which points go around a center, less than half a turn from each to the next.
double turn(const std::vector<Vec2>& line, const Vec2& center) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec2 p = line[i] - center, q = line[i + 1] - center;
    sum += std::atan2(cross(p, q), p.dot(q));
  }
  return sum;
}

/// Along a circle, each at most a third of a turn.
void add_arcs(const std::vector<Vec2>& line, const RawCurve& circle, Index label, std::vector<Side>& sides) {
  const double whole = turn(line, circle.center);
  // Exactly a third of a turn is one piece, whatever its rounding.
  const int count = std::max(1, int(std::ceil(std::abs(whole) / (2 * pi / 3) - 1e-9)));
  const Vec2 from = line.front() - circle.center;
  const double start = std::atan2(from.y(), from.x());
  const auto point = [&](int k) -> Vec2 {
    if (k == 0) return line.front();
    if (k == count) return line.back();
    const double angle = start + whole * k / count;
    return circle.center + circle.radius * Vec2(std::cos(angle), std::sin(angle));
  };
  for (int k = 0; k < count; ++k) {
    Side side{point(k), label, {}};
    side.arc = arc_between(point(k), point(k + 1), circle.center);
    sides.push_back(side);
  }
}

/// The points of a curve between the ends of a line along all of it, in its direction.
std::vector<Vec2> samples(const std::vector<Vec2>& line, const RawCurve& curve) {
  std::vector<Vec2> points = curve.points;
  const double forward = (points.front() - line.front()).norm() + (points.back() - line.back()).norm();
  const double backward = (points.back() - line.front()).norm() + (points.front() - line.back()).norm();
  if (backward < forward) std::reverse(points.begin(), points.end());
  points.front() = line.front();
  points.back() = line.back();
  return points;
}

ArcFit fit(const OnCurves& on) {
  return {.tolerance = curve_tolerance * on.extent, .least_spacing = 1e-3 * on.extent};
}

void add_line(const std::vector<Vec2>& line, Index label, double tolerance, std::vector<Side>& sides) {
  const std::vector<std::size_t> kinks = corner_places(line, tolerance);
  for (std::size_t k = 0; k + 1 < kinks.size(); ++k) sides.push_back({line[kinks[k]], label, {}});
}

/// A loop that is one curve.
std::vector<Side> whole_curve(const RawCurve& curve, Index label, const OnCurves& on) {
  if (is_circle(&curve)) return circle("", curve.center, curve.radius, label).sides;
  ChainTrace trace{.points = curve.points, .closed = true};
  trace.points.pop_back();
  return sides(fit_arcs(trace, fit(on)).chain, label);
}

/// The arc of an edge from its end a.
Arc arc_from(const Mesh& mesh, Index edge, Index a) {
  Arc arc = mesh.arcs[std::size_t(mesh.arc[std::size_t(edge)])];
  if (mesh.edges[std::size_t(edge)][0] != a) std::swap(arc.from, arc.to);
  return arc;
}

/// Sides along the arcs of the edges, each at most a third of a turn, and straight ones between.
std::vector<Side> sides_along(const Mesh& mesh, const RimLoop& loop, const std::vector<Index>& label,
                              const OnCurves& on) {
  const std::size_t n = loop.size();
  const auto of = [&](std::size_t i) {
    const std::size_t e = std::size_t(loop[i % n].edge);
    return std::pair(label[e], on.bent[e]);
  };
  const auto point = [&](std::size_t i) { return mesh.points[std::size_t(loop[i % n].a)]; };
  std::size_t begin = 0;
  while (begin < n && of(begin) == of(begin + n - 1)) ++begin;
  std::vector<Side> out;
  for (std::size_t i = begin, end; i < begin + n; i = end) {
    end = i + 1;
    if (of(i).second == none) {
      std::vector<Vec2> line{point(i)};
      for (; end < begin + n && of(end) == of(i); ++end) line.push_back(point(end));
      line.push_back(point(end));
      add_line(line, of(i).first, 1e-10 * on.extent, out);
      continue;
    }
    Arc arc = arc_from(mesh, loop[i % n].edge, loop[i % n].a);
    for (; end < begin + n && of(end) == of(i); ++end) {
      const Arc next = arc_from(mesh, loop[end % n].edge, loop[end % n].a);
      if (std::abs(arc.to - arc.from) + std::abs(next.to - next.from) > 2 * pi / 3) break;
      arc.to += next.to - next.from;
    }
    const bool round = arc.axes == arc.axes(0, 0) * Mat2::Identity();
    Side side{point(i), of(i).first, {}};
    side.arc = round ? arc_between(point(i), point(end), arc.center) : arc;
    out.push_back(side);
  }
  return out;
}

/// A path along one circle, at most a whole turn.
std::optional<Crack> crack_on_circle(const Mesh& mesh, const std::vector<CrackEdge>& path, const OnCurves& on) {
  const Index curve = on.bent[std::size_t(path.front().edge)];
  double turn = 0;
  for (const CrackEdge& piece : path) {
    const std::size_t e = std::size_t(piece.edge);
    if (curve == none || on.bent[e] != curve) return std::nullopt;
    const Arc& arc = mesh.arcs[std::size_t(mesh.arc[e])];
    turn += piece.forward ? arc.to - arc.from : arc.from - arc.to;
  }
  const auto& [low, high] = mesh.edges[std::size_t(path.front().edge)];
  const Arc first = arc_from(mesh, path.front().edge, path.front().forward ? low : high);
  if (first.axes != first.axes(0, 0) * Mat2::Identity()) return std::nullopt;
  Crack crack = arc_crack("", first.center, first.axes(0, 0), first.from, first.from + turn);
  const std::vector<Vec2> points = points_of(mesh, path);
  crack.points = {points.front(), points.back()};
  return crack;
}

}  // namespace

std::vector<Side> drawn_sides(const Mesh& mesh, const RimLoop& loop, const std::vector<Index>& label,
                              const OnCurves& on) {
  if (!mesh.arc.empty()) return sides_along(mesh, loop, label, on);
  if (on.curves.empty()) return sides_of(mesh, loop, label, 1e-10 * on.extent);
  const std::size_t n = loop.size();
  const auto key = [&](std::size_t i) {
    const std::size_t e = std::size_t(loop[i % n].edge);
    return std::pair(label[e], on.entity[e]);
  };
  std::size_t begin = 0;
  while (begin < n && key(begin) == key(begin + n - 1)) ++begin;
  if (begin == n) {
    const RawCurve* curve = curve_of(on, loop.front().edge);
    if (is_circle(curve) || is_other(curve)) return whole_curve(*curve, key(0).first, on);
    return sides_of(mesh, loop, label, 1e-10 * on.extent);
  }
  std::vector<Side> out;
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i + 1;
    while (end < n && key(begin + end) == key(begin + i)) ++end;
    std::vector<Vec2> line;
    for (std::size_t k = i; k <= end; ++k) line.push_back(mesh.points[std::size_t(loop[(begin + k) % n].a)]);
    const RawCurve* curve = curve_of(on, loop[(begin + i) % n].edge);
    const Index own = key(begin + i).first;
    if (is_circle(curve)) {
      add_arcs(line, *curve, own, out);
    } else if (is_other(curve)) {
      for (Side& side : sides(fit_arcs({.points = samples(line, *curve)}, fit(on)).chain, own)) out.push_back(side);
    } else {
      add_line(line, own, 1e-10 * on.extent, out);
    }
    i = end;
  }
  return out;
}

Crack drawn_crack(const Mesh& mesh, const std::vector<CrackEdge>& path, const OnCurves& on) {
  const std::vector<Vec2> points = points_of(mesh, path);
  if (!mesh.arc.empty())
    if (auto crack = crack_on_circle(mesh, path, on)) return *std::move(crack);
  Crack crack;
  std::vector<Vec2> line;
  for (std::size_t i = 0; i < path.size();) {
    const std::int32_t entity = on.entity[std::size_t(path[i].edge)];
    std::size_t end = i + 1;
    while (end < path.size() && on.entity[std::size_t(path[end].edge)] == entity) ++end;
    std::vector<Vec2> part(points.begin() + Index(i), points.begin() + Index(end) + 1);
    const RawCurve* curve = curve_of(on, path[i].edge);
    if (is_circle(curve) && i == 0 && end == path.size()) {
      const Vec2 from = part.front() - curve->center;
      const double start = std::atan2(from.y(), from.x());
      return arc_crack("", curve->center, curve->radius, start, start + turn(part, curve->center));
    }
    if (is_circle(curve) || is_other(curve)) {
      const std::vector<Vec2> dense = samples(part, *curve);
      part.clear();
      for (const std::size_t k : corner_places(dense, curve_tolerance * on.extent)) part.push_back(dense[k]);
    }
    line.insert(line.end(), part.begin(), part.end() - 1);
    i = end;
  }
  line.push_back(points.back());
  for (const std::size_t k : corner_places(line, 1e-10 * on.extent)) crack.points.push_back(line[k]);
  return crack;
}

}  // namespace kerf
