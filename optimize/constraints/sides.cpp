// Exact distances to a boundary of lines and arcs. The nearest side tells how far a point is; the sign comes from the
// side of the tangent that it lies on and, where a corner is nearest, from the corner: a convex one is nearest only to
// points outside, a reentrant one only to points inside.

#include "optimize/constraints/sides.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

double parameter_at(const Arc& arc, double part) {
  return arc.from + part * (arc.to - arc.from);
}

/// The nearest point of a part of an ellipse: samples, then halves around the best one.
double nearest_on_ellipse(const DrawnSide& side, const Vec2& x) {
  const auto away = [&](double part) { return (at(side, part) - x).squaredNorm(); };
  const int n = 8 + int(std::ceil(32 * std::abs(side.arc->to - side.arc->from) / (2 * pi)));
  int best = 0;
  for (int k = 1; k <= n; ++k)
    if (away(double(k) / n) < away(double(best) / n)) best = k;
  // Between neighbors of the best sample the derivative of |x(t) - x|^2 changes its sign once. A whole ellipse has no
  // ends.
  const bool whole = std::abs(std::abs(side.arc->to - side.arc->from) - 2 * pi) < 1e-9;
  double low = (best - 1.0) / n, high = (best + 1.0) / n;
  if (!whole) low = std::max(0.0, low), high = std::min(1.0, high);
  const auto rises = [&](double part) {
    return velocity(*side.arc, parameter_at(*side.arc, part)).dot(at(side, part) - x) *
               (side.arc->to > side.arc->from ? 1 : -1) >
           0;
  };
  if (!whole && best == 0 && rises(0)) return 0;
  if (!whole && best == n && !rises(1)) return 1;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (rises(middle) ? high : low) = middle;
  }
  const double part = 0.5 * (low + high);
  return whole ? part - std::floor(part) : part;
}

}  // namespace

bool is_round(const Arc& arc) {
  const double r = arc.axes.col(0).norm();
  return (arc.axes.transpose() * arc.axes - r * r * Mat2::Identity()).norm() <= 1e-12 * r * r;
}

void add_roots(double A, double B, double C, double from, double to, std::vector<double>& parts) {
  const double R = std::hypot(A, B), turn = to - from;
  if (!(R > std::abs(C))) return;
  for (const double sign : {1.0, -1.0}) {
    const double t = std::atan2(B, A) + sign * std::acos(-C / R);
    for (int k = -3; k <= 3; ++k)
      if (const double part = (t + 2 * pi * k - from) / turn; part > 0 && part < 1) parts.push_back(part);
  }
}

Loop loop_of(const std::string& name, const std::vector<DrawnSide>& sides) {
  Loop loop{name, {}};
  for (const DrawnSide& s : sides) loop.sides.push_back({s.a, s.label, s.arc, s.keep, s.smooth});
  return loop;
}

double signed_area(const std::vector<DrawnSide>& loop) {
  constexpr int pieces = 16;
  double twice = 0;
  for (const DrawnSide& s : loop) {
    const int n = s.arc ? pieces : 1;
    for (int k = 0; k < n; ++k) twice += cross(at(s, double(k) / n), at(s, double(k + 1) / n));
  }
  return 0.5 * twice;
}

void add_sides(const Loop& loop, bool hole, std::vector<DrawnSide>& out) {
  std::vector<DrawnSide> mine;
  const std::size_t n = loop.sides.size();
  for (std::size_t i = 0; i < n; ++i)
    mine.push_back({loop.sides[i].start, loop.sides[(i + 1) % n].start, loop.sides[i].arc, loop.sides[i].label,
                    loop.sides[i].keep, loop.sides[i].smooth});
  if ((signed_area(mine) < 0) != hole) {
    std::ranges::reverse(mine);
    for (DrawnSide& s : mine) {
      std::swap(s.a, s.b);
      if (s.arc) std::swap(s.arc->from, s.arc->to);
    }
  }
  out.insert(out.end(), mine.begin(), mine.end());
}

std::vector<DrawnSide> sides_of(const Shape& body) {
  std::vector<DrawnSide> all;
  add_sides(body.outline, false, all);
  for (const Loop& hole : body.holes) add_sides(hole, true, all);
  return all;
}

Vec2 at(const DrawnSide& side, double part) {
  return side.arc ? at(*side.arc, parameter_at(*side.arc, part)) : Vec2((1 - part) * side.a + part * side.b);
}

Vec2 tangent(const DrawnSide& side, double part) {
  if (!side.arc) return (side.b - side.a).normalized();
  const double sign = side.arc->to > side.arc->from ? 1 : -1;
  return sign * velocity(*side.arc, parameter_at(*side.arc, part)).normalized();
}

double length(const DrawnSide& side) {
  return side.arc ? length(*side.arc) : (side.b - side.a).norm();
}

double nearest(const DrawnSide& side, const Vec2& x) {
  if (!side.arc) return foot(x, side.a, side.b);
  if (!is_round(*side.arc)) return nearest_on_ellipse(side, x);
  // beyond_middle is signed by growing t of the circle, for axes of either orientation.
  const double turn = side.arc->to - side.arc->from, beyond = beyond_middle(*side.arc, x);
  const double part = 0.5 + beyond / turn;
  if (part >= 0 && part <= 1) return part;
  return (x - at(side, 0)).squaredNorm() <= (x - at(side, 1)).squaredNorm() ? 0 : 1;
}

Region::Region(const Loop& loop)
    : Region([&] {
        std::vector<DrawnSide> all;
        add_sides(loop, false, all);
        return all;
      }()) {}

Region::Region(std::vector<DrawnSide> sides) : sides_(std::move(sides)) {
  const std::size_t n = sides_.size();
  before_.resize(n);
  after_.resize(n);
  // A loop ends where the next side does not begin at the end of the one before; sides of a loop lie one after another.
  for (std::size_t first = 0; first < n;) {
    std::size_t last = first;
    while (last + 1 < n && sides_[last + 1].a == sides_[last].b && sides_[last].b != sides_[first].a) ++last;
    for (std::size_t i = first; i <= last; ++i) {
      before_[i] = i == first ? last : i - 1;
      after_[i] = i == last ? first : i + 1;
    }
    first = last + 1;
  }
  for (const DrawnSide& s : sides_) {
    const Vec2 middle = at(s, 0.5);
    double radius = 0;
    for (int k = 0; k <= 8; ++k) radius = std::max(radius, (at(s, k / 8.0) - middle).norm());
    // Between the samples an arc strays by less than an eighth of its length.
    around_.push_back({middle, s.arc ? radius + length(s) / 8 : radius});
  }
}

Region::Foot Region::foot_of(const Vec2& x) const {
  Foot best{0, 0, infinity};
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double least = (x - around_[i].center).norm() - around_[i].radius;
    if (least > 0 && least * least > best.squared) continue;
    const double part = nearest(sides_[i], x), squared = (at(sides_[i], part) - x).squaredNorm();
    if (squared < best.squared) best = {i, part, squared};
  }
  return best;
}

double Region::away(const Vec2& x) const {
  return std::sqrt(foot_of(x).squared);
}

double Region::depth(const Vec2& x) const {
  const Foot f = foot_of(x);
  const DrawnSide& s = sides_[f.side];
  const double away = std::sqrt(f.squared);
  const Vec2 way = x - at(s, f.part);
  const bool begins = f.part <= 0, ends = f.part >= 1;
  if (!begins && !ends) return cross(tangent(s, f.part), way) > 0 ? away : -away;
  const Vec2 in = begins ? tangent(sides_[before_[f.side]], 1) : tangent(s, 1),
             out = begins ? tangent(s, 0) : tangent(sides_[after_[f.side]], 0);
  constexpr double straight = 1e-6;
  if (const double bend = cross(in, out); std::abs(bend) > straight) return bend < 0 ? away : -away;
  return cross(Vec2(in + out), way) > 0 ? away : -away;
}

}  // namespace kerf
