// A labeled part of the boundary as smooth curves with arc length, for hats and sensors along it [theory: I.1]. Each
// loop is flattened to 1e-5 of the body and walked once from the first piece of the label that begins a curve. Curves
// end where the label ends or the boundary turns by more than 20 degrees; ends where two curves of the label meet share
// the number of a joint, so that functions along the label are continuous there. A loop that is smooth and labeled all
// around is one closed curve with one joint. docs/theory/inverse.md.

#include "optimize/inverse/boundary_line.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Piece v of the polygon runs from its point v to the next; it begins a curve where the piece before has another label
// or turns into it at a corner.
void add_loop(const Loop& loop, double size, Index label, BoundaryLine& line) {
  const Polygon p = flatten(loop, 1e-5 * size, size / 50);
  const std::size_t n = p.points.size();
  const auto next = [n](std::size_t i) { return i + 1 < n ? i + 1 : 0; };
  const auto is_corner = [&](std::size_t v) {  // between piece v - 1 and piece v
    const std::size_t before = v > 0 ? v - 1 : n - 1;
    const Vec2 in = p.points[v] - p.points[before], out = p.points[next(v)] - p.points[v];
    return std::abs(std::atan2(cross(in, out), in.dot(out))) > pi / 9;
  };
  std::vector<bool> starts(n, false);  // piece v is the first of a curve
  std::size_t first = n;
  for (std::size_t v = 0; v < n; ++v) {
    if (p.label[v] != label) continue;
    starts[v] = p.label[v > 0 ? v - 1 : n - 1] != label || is_corner(v);
    if (starts[v] && first == n) first = v;
  }
  if (first == n) first = static_cast<std::size_t>(std::find(p.label.begin(), p.label.end(), label) - p.label.begin());
  if (first == n) return;
  const Index smooth_loop = !starts[first] ? line.joints++ : none;  // one closed curve
  starts[first] = true;
  Index here = none;  // the joint at the start of the next curve
  std::size_t v = first;
  std::vector<std::size_t> mine;
  // Once around from the first beginning, so that no curve is cut in two.
  do {
    if (p.label[v] == label) {
      if (starts[v]) {
        BoundaryCurve c;
        c.points = {p.points[v]};
        c.arc = {0};
        const std::size_t before = v > 0 ? v - 1 : n - 1;
        c.beside[0] = p.label[before];
        if (smooth_loop != none)
          here = smooth_loop;
        else if (p.label[before] != label || v == first)
          here = line.joints++;
        c.joint[0] = here;
        mine.push_back(line.curves.size());
        line.curves.push_back(std::move(c));
      }
      BoundaryCurve& c = line.curves.back();
      const double piece = (p.points[next(v)] - p.points[v]).norm();
      c.points.push_back(p.points[next(v)]);
      c.arc.push_back(c.arc.back() + piece);
      line.length += piece;
      const std::size_t after = next(v);
      if (p.label[after] != label || starts[after]) {
        c.beside[1] = p.label[after];
        // The last curve of a loop that is labeled all around ends at the joint where the first one begins.
        const bool closes = after == first && p.label[after] == label;
        here = closes ? line.curves[mine.front()].joint[0] : line.joints++;
        c.joint[1] = here;
      }
    }
    v = next(v);
  } while (v != first);
}

}  // namespace

BoundaryLine boundary_line(const Shape& shape, Index label) {
  BoundaryLine line;
  const double size = extent(shape);
  add_loop(shape.outline, size, label, line);
  for (const Loop& hole : shape.holes) add_loop(hole, size, label, line);
  return line;
}

Place nearest_place(const BoundaryLine& line, const Vec2& x) {
  Place best;
  best.distance = infinity;
  for (std::size_t c = 0; c < line.curves.size(); ++c) {
    const BoundaryCurve& curve = line.curves[c];
    for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
      const Vec2 along = curve.points[i + 1] - curve.points[i];
      const double t = foot(x, curve.points[i], curve.points[i + 1]);
      const double distance = (x - curve.points[i] - t * along).norm();
      if (distance < best.distance)
        best = {static_cast<Index>(c), curve.arc[i] + t * (curve.arc[i + 1] - curve.arc[i]), distance};
    }
  }
  return best;
}

Vec2 point_at(const BoundaryCurve& curve, double arc) {
  const auto after = std::upper_bound(curve.arc.begin() + 1, curve.arc.end() - 1, arc);
  const auto i = static_cast<std::size_t>(after - curve.arc.begin()) - 1;
  const double piece = curve.arc[i + 1] - curve.arc[i];
  const double t = piece > 0 ? std::clamp((arc - curve.arc[i]) / piece, 0.0, 1.0) : 0.0;
  return curve.points[i] + t * (curve.points[i + 1] - curve.points[i]);
}

}  // namespace kerf
