// A body without regions that stay void. Both boundaries are cut where they meet; of the body the pieces outside the
// region stay, of the region those inside the body, run the other way round. Pieces that lie on each other stay once
// where the body and the region are on different sides of them, and not at all where they are on the same side. The
// pieces are then joined end to start: the loop that runs counter-clockwise is the outline.

#include "geometry/plane.hpp"
#include "optimize/constraints.hpp"
#include "optimize/constraints/sides.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double same_point = 1e-9;  // of the extent

/// Where along a side the curve that carries another one is met: exact but for ellipses met by arcs, which are halved
/// between samples.
void add_meetings(const DrawnSide& s, const DrawnSide& other, std::vector<double>& parts) {
  if (!other.arc) {
    const Vec2 along = (other.b - other.a).normalized();
    if (!s.arc) {
      const double a = cross(along, s.a - other.a), b = cross(along, s.b - other.a);
      if ((a < 0) != (b < 0)) parts.push_back(a / (a - b));
    } else {
      add_roots(cross(along, Vec2(s.arc->axes.col(0))), cross(along, Vec2(s.arc->axes.col(1))),
                cross(along, s.arc->center - other.a), s.arc->from, s.arc->to, parts);
    }
    return;
  }
  const Mat2 to_circle = other.arc->axes.inverse();
  const auto level = [&](const Vec2& x) { return (to_circle * (x - other.arc->center)).squaredNorm() - 1; };
  if (!s.arc) {
    const Vec2 d = to_circle * (s.b - s.a), e = to_circle * (s.a - other.arc->center);
    const double a = d.squaredNorm(), half = d.dot(e), c = e.squaredNorm() - 1, root = half * half - a * c;
    if (root > 0)
      for (const double sign : {1.0, -1.0}) parts.push_back((-half + sign * std::sqrt(root)) / a);
  } else if (is_round(*s.arc) && is_round(*other.arc)) {
    const Vec2 e = s.arc->center - other.arc->center;
    const double r = s.arc->axes.col(0).norm(), big = other.arc->axes.col(0).norm();
    add_roots(2 * e.dot(Vec2(s.arc->axes.col(0))), 2 * e.dot(Vec2(s.arc->axes.col(1))),
              e.squaredNorm() + r * r - big * big, s.arc->from, s.arc->to, parts);
  } else {
    constexpr int pieces = 256;
    for (int k = 0; k < pieces; ++k) {
      double low = double(k) / pieces, high = double(k + 1) / pieces;
      const bool begins = level(at(s, low)) < 0;
      if (begins == (level(at(s, high)) < 0)) continue;
      for (int half = 0; half < 60; ++half) {
        const double middle = 0.5 * (low + high);
        ((level(at(s, middle)) < 0) == begins ? low : high) = middle;
      }
      parts.push_back(0.5 * (low + high));
    }
  }
}

/// Sides cut where they meet others; the new corners are those of the others where these have any there.
std::vector<DrawnSide> cut(const std::vector<DrawnSide>& sides, const std::vector<DrawnSide>& others, double near) {
  const auto corner = [&](const Vec2& x) {
    for (const std::vector<DrawnSide>* all : {&sides, &others})
      for (const DrawnSide& s : *all)
        if ((s.a - x).norm() <= near) return s.a;
    return x;
  };
  std::vector<DrawnSide> out;
  for (const DrawnSide& s : sides) {
    std::vector<double> parts, own;
    for (const DrawnSide& other : others) {
      own.clear();
      add_meetings(s, other, own);
      for (const double part : own)
        if (part > 0 && part < 1 && (at(other, nearest(other, at(s, part))) - at(s, part)).norm() <= near)
          parts.push_back(part);
      if (const double part = nearest(s, other.a); (at(s, part) - other.a).norm() <= near) parts.push_back(part);
    }
    std::ranges::sort(parts);
    DrawnSide rest = s;
    rest.a = corner(s.a);
    double from = 0;
    const auto end_at = [&](double part, const Vec2& x) {
      DrawnSide piece = rest;
      piece.b = x;
      if (s.arc) {
        piece.arc->from = s.arc->from + from * (s.arc->to - s.arc->from);
        piece.arc->to = s.arc->from + part * (s.arc->to - s.arc->from);
      }
      piece.keep = s.keep && from == 0 && part == 1;
      out.push_back(piece);
      rest.a = x;
      from = part;
    };
    for (const double part : parts) {
      const Vec2 x = corner(at(s, part));
      if ((x - rest.a).norm() > near && (x - s.b).norm() > near) end_at(part, x);
    }
    end_at(1, corner(s.b));
  }
  return out;
}

DrawnSide reversed(const DrawnSide& side) {
  DrawnSide out = side;
  std::swap(out.a, out.b);
  if (out.arc) std::swap(out.arc->from, out.arc->to);
  return out;
}

/// Whether the curve of `region` on which the piece lies runs the same way.
bool runs_along(const DrawnSide& piece, const Region& region) {
  const Vec2 x = at(piece, 0.5);
  double least = infinity, same = 0;
  for (const DrawnSide& s : region.sides()) {
    const double part = nearest(s, x), away = (at(s, part) - x).norm();
    if (away < least) least = away, same = tangent(s, part).dot(tangent(piece, 0.5));
  }
  return same > 0;
}

/// Straight sides that were cut in two where nothing of the other boundary begins.
void join_halves(std::vector<DrawnSide>& loop, const std::vector<Vec2>& corners, double near) {
  for (std::size_t i = 0; i < loop.size() && loop.size() > 3;) {
    const std::size_t k = (i + 1) % loop.size();
    DrawnSide& s = loop[i];
    const DrawnSide& next = loop[k];
    const bool corner = std::ranges::any_of(corners, [&](const Vec2& x) { return (x - s.b).norm() <= near; });
    const bool one = !corner && !s.arc && !next.arc && s.label == next.label &&
                     cross(tangent(s, 1), tangent(next, 0)) == 0 && tangent(s, 1).dot(tangent(next, 0)) > 0;
    if (!one) {
      ++i;
      continue;
    }
    s.b = next.b;
    loop.erase(loop.begin() + std::ptrdiff_t(k));
  }
}

/// Pieces joined end to start to closed loops; nothing where an end has no piece that starts there.
std::optional<std::vector<std::vector<DrawnSide>>> joined(std::vector<DrawnSide> pieces, double near) {
  std::vector<std::vector<DrawnSide>> loops;
  while (!pieces.empty()) {
    std::vector<DrawnSide> loop{pieces.back()};
    pieces.pop_back();
    while ((loop.back().b - loop.front().a).norm() > near) {
      const auto next =
          std::ranges::find_if(pieces, [&](const DrawnSide& s) { return (s.a - loop.back().b).norm() <= near; });
      if (next == pieces.end()) return std::nullopt;
      loop.push_back(*next);
      pieces.erase(next);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

[[noreturn]] void refuse_keep_out(const Loop& region, const std::string& why) {
  throw Error(Fault::Geometry, fmt::format("keep_out \"{}\" {}", region.name, why));
}

/// The closed loops of the body's boundary without the region.
std::vector<std::vector<DrawnSide>> loops_without(const Shape& body, const Loop& keep_out, Index label, double near) {
  std::vector<DrawnSide> mine = sides_of(body), its;
  add_sides(keep_out, false, its);
  for (DrawnSide& s : its) s.label = label, s.keep = s.smooth = false;
  const Region whole(mine), region(its);
  std::vector<DrawnSide> pieces;
  std::vector<Vec2> corners;
  for (const DrawnSide& s : mine) corners.push_back(s.a);
  for (const DrawnSide& s : cut(mine, its, near)) {
    const double depth = region.depth(at(s, 0.5));
    if (depth < -near || (depth <= near && !runs_along(s, region))) pieces.push_back(s);
  }
  for (const DrawnSide& s : cut(its, mine, near)) {
    const Vec2 x = at(s, 0.5);
    if (whole.depth(x) > near) pieces.push_back(reversed(s)), corners.push_back(s.a), corners.push_back(s.b);
  }
  const auto loops = joined(std::move(pieces), near);
  if (!loops) refuse_keep_out(keep_out, "meets the boundary in a way that cannot be cut; draw it a little larger");
  std::vector<std::vector<DrawnSide>> out = *loops;
  for (std::vector<DrawnSide>& loop : out) join_halves(loop, corners, near);
  return out;
}

}  // namespace

Shape without(const Shape& body, const Loop& keep_out) {
  const double near = same_point * extent(body);
  Shape out = body;
  const std::string word = "keep_out:" + keep_out.name;
  auto known = std::ranges::find(out.labels, word);
  const Index label = Index(known - out.labels.begin());
  const auto loops = loops_without(body, keep_out, label, near);
  const std::vector<Loop> before = body.holes;
  out.holes.clear();
  int outlines = 0;
  bool touched = false;
  for (const std::vector<DrawnSide>& loop : loops) {
    if (std::ranges::any_of(loop, [&](const DrawnSide& s) { return s.label == label; })) touched = true;
    if (signed_area(loop) > 0) {
      ++outlines;
      out.outline = loop_of(body.outline.name, loop);
      continue;
    }
    std::string name = keep_out.name;
    for (const Loop& hole : before)
      if (!hole.sides.empty() && Region(hole).away(loop.front().a) <= near) name = hole.name;
    out.holes.push_back(loop_of(name, loop));
  }
  if (!touched && outlines == 1) return body;  // nothing of the body lies in it
  if (outlines == 0) refuse_keep_out(keep_out, "covers the whole body: nothing is left to design");
  if (outlines > 1) refuse_keep_out(keep_out, "cuts the body in pieces; draw it so that one piece is left");
  if (known == out.labels.end()) out.labels.push_back(word);
  const Region region(keep_out);
  for (const Crack& crack : body.cracks)
    for (const Vec2& x : crack.arc ? points_on(*crack.arc, 64) : crack.points)
      if (region.depth(x) > near) refuse_keep_out(keep_out, fmt::format("holds a part of crack \"{}\"", crack.name));
  return out;
}

}  // namespace kerf
