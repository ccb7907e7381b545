// A body made its own mirror image. Every loop is cut at the line; each run of sides on the side that is kept begins
// and ends on it, and with its image, run the other way round, makes a closed loop: the one that runs counter-clockwise
// is the outline. Images of sides of the frame take its label, and its corners exactly.

#include "optimize/constraints/mirrored.hpp"

#include "geometry/plane.hpp"
#include "optimize/constraints/sides.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double same_place = 1e-9;  // of the extent

class Halves {
 public:
  Halves(const Shape& frame, const Mirror& mirror, double side)
      : frame_(frame),
        frame_sides_(sides_of(frame)),
        mirror_(mirror),
        along_(mirror.direction.normalized()),
        side_(side),
        near_(same_place * extent(frame)) {}

  /// The closed loops that a loop and its image make.
  std::vector<std::vector<DrawnSide>> doubled(const std::vector<DrawnSide>& loop) const {
    std::vector<DrawnSide> cut;
    for (const DrawnSide& s : loop) add_cut(s, cut);
    const auto kept = [&](const DrawnSide& s) { return height(at(s, 0.5)) > near_; };
    const std::size_t n = cut.size();
    std::vector<std::vector<DrawnSide>> all;
    if (std::ranges::all_of(cut, kept)) return {cut, joined(image(cut))};
    std::size_t first = 0;
    while (first < n && (!kept(cut[first]) || kept(cut[(first + n - 1) % n]))) ++first;
    if (first == n) return {};
    for (std::size_t i = first; i < first + n;) {
      std::vector<DrawnSide> run;
      for (; i < first + n && kept(cut[i % n]); ++i) run.push_back(cut[i % n]);
      if (run.empty()) {
        ++i;
        continue;
      }
      std::vector<DrawnSide> back = image(run);
      back.front().a = run.back().b;
      back.back().b = run.front().a;
      run.insert(run.end(), back.begin(), back.end());
      all.push_back(joined(std::move(run)));
    }
    return all;
  }

  double height(const Vec2& x) const {
    return side_ * cross(along_, x - mirror_.point);
  }
  bool is_drawn(const DrawnSide& s) const {
    return s.label == none || std::size_t(s.label) >= frame_.labels.size();
  }
  double near() const {
    return near_;
  }

 private:
  /// What is near a corner of the frame is there.
  Vec2 at_corner(const Vec2& x) const {
    for (const DrawnSide& s : frame_sides_)
      if ((s.a - x).norm() <= near_) return s.a;
    return x;
  }

  Vec2 snapped(const Vec2& x) const {
    if (std::abs(height(x)) > near_) return x;
    return at_corner(mirror_.point + along_ * along_.dot(x - mirror_.point));
  }

  /// A side in pieces that lie on one side of the line each.
  void add_cut(const DrawnSide& s, std::vector<DrawnSide>& out) const {
    std::vector<double> parts;
    if (s.arc) {
      // side . (x(t) - p) = A cos t + B sin t + C
      add_roots(side_ * cross(along_, Vec2(s.arc->axes.col(0))), side_ * cross(along_, Vec2(s.arc->axes.col(1))),
                height(s.arc->center), s.arc->from, s.arc->to, parts);
    } else if (const double a = height(s.a), b = height(s.b); (a < 0) != (b < 0)) {
      parts.push_back(a / (a - b));
    }
    std::ranges::sort(parts);
    double from = 0;
    DrawnSide rest = s;
    rest.a = snapped(s.a);
    rest.b = snapped(s.b);
    for (const double part : parts) {
      const Vec2 x = at(s, part);
      // The ends of the side lie on the line already.
      if ((x - s.a).norm() <= near_ || (x - s.b).norm() <= near_) continue;
      DrawnSide piece = rest;
      piece.b = mirror_.point + along_ * along_.dot(x - mirror_.point);
      if (s.arc) {
        piece.arc->from = s.arc->from + from * (s.arc->to - s.arc->from);
        piece.arc->to = s.arc->from + part * (s.arc->to - s.arc->from);
      }
      rest.a = piece.b;
      from = part;
      out.push_back(piece);
    }
    if (s.arc) rest.arc->from = s.arc->from + from * (s.arc->to - s.arc->from);
    if (from > 0) rest.keep = false;
    out.push_back(rest);
  }

  std::vector<DrawnSide> image(const std::vector<DrawnSide>& run) const {
    std::vector<DrawnSide> all;
    for (auto s = run.rbegin(); s != run.rend(); ++s) {
      const DrawnSide there = image(*s);
      if (is_drawn(*s))
        all.push_back(there);
      else
        add_on_frame(there, all);
    }
    return all;
  }

  DrawnSide image(const DrawnSide& s) const {
    DrawnSide out = s;
    out.a = at_corner(image_of(mirror_, s.b));
    out.b = at_corner(image_of(mirror_, s.a));
    if (s.arc) {
      const Mat2 reflection = 2 * along_ * along_.transpose() - Mat2::Identity();
      out.arc->center = image_of(mirror_, s.arc->center);
      out.arc->axes = reflection * s.arc->axes;
      out.arc->from = s.arc->to;
      out.arc->to = s.arc->from;
    }
    return out;
  }

  /// A side that lies on the frame as the frame has it there: its corners, its labels, which are no images, its arcs.
  void add_on_frame(const DrawnSide& s, std::vector<DrawnSide>& out) const {
    std::vector<std::pair<double, Vec2>> cuts;
    for (const DrawnSide& f : frame_sides_) {
      const double part = nearest(s, f.a);
      if ((at(s, part) - f.a).norm() <= near_ && (f.a - s.a).norm() > near_ && (f.a - s.b).norm() > near_)
        cuts.emplace_back(part, f.a);
    }
    std::ranges::sort(cuts, {}, &std::pair<double, Vec2>::first);
    cuts.emplace_back(1, s.b);
    double from = 0;
    Vec2 start = s.a;
    for (const auto& [part, end] : cuts) {
      out.push_back(of_frame(start, at(s, 0.5 * (from + part)), end));
      from = part;
      start = end;
    }
  }

  /// From a to b by way of the middle along one side of the frame. No label: there is none.
  DrawnSide of_frame(const Vec2& a, const Vec2& middle, const Vec2& b) const {
    DrawnSide out{.a = a, .b = b};
    for (const DrawnSide& f : frame_sides_) {
      if ((at(f, nearest(f, middle)) - middle).norm() > 1e3 * near_) continue;
      out.label = f.label;
      out.smooth = f.smooth;
      out.keep = f.keep && a == f.a && b == f.b;
      if (f.arc) {
        const double first = parameter(*f.arc, a), t = parameter(*f.arc, middle), last = parameter(*f.arc, b);
        out.arc = f.arc;
        out.arc->from = t + std::remainder(first - t, 2 * pi);
        out.arc->to = t + std::remainder(last - t, 2 * pi);
      }
      break;
    }
    return out;
  }

  bool is_corner(const Vec2& x) const {
    return std::ranges::any_of(frame_sides_, [&](const DrawnSide& s) { return (s.a - x).norm() <= near_; });
  }

  /// Sides of the frame that the line, or an image of one of its corners, had cut in two.
  std::vector<DrawnSide> joined(std::vector<DrawnSide> loop) const {
    for (std::size_t i = 0; i < loop.size() && loop.size() > 3;) {
      DrawnSide& s = loop[i];
      const std::size_t k = (i + 1) % loop.size();
      const DrawnSide& next = loop[k];
      const bool cut = !is_drawn(s) && s.label == next.label && s.arc.has_value() == next.arc.has_value() &&
                       !is_corner(s.b) && std::abs(cross(tangent(s, 1), tangent(next, 0))) < 1e-9 &&
                       tangent(s, 1).dot(tangent(next, 0)) > 0;
      if (!cut) {
        ++i;
        continue;
      }
      if (s.arc) s.arc->to += next.arc->to - next.arc->from;
      s.b = next.b;
      loop.erase(loop.begin() + std::ptrdiff_t(k));
    }
    return loop;
  }

  const Shape& frame_;
  std::vector<DrawnSide> frame_sides_;
  Mirror mirror_;
  Vec2 along_;
  double side_, near_;
};

/// What acts on a point of the frame: the traction, and which components are held.
struct Acting {
  Vec2 traction = Vec2::Zero();
  int held = 0;
};
Acting acting_on(const Scene& scene, const DrawnSide& side, double part) {
  const Vec2 x = at(side, part), t = tangent(side, part), outwards(t.y(), -t.x());
  Acting a;
  for (const Traction& load : scene.tractions)
    if (load.label == side.label && load.value) a.traction += load.value(x, outwards);
  for (const Support& s : scene.supports)
    if (s.label == side.label) a.held += int(s.first) + int(s.second);
  return a;
}

}  // namespace

bool are_mirrored(const Shape& frame, const std::vector<Scene>& scenes, const Mirror& mirror) {
  constexpr double digits = 1e-6;
  const std::vector<DrawnSide> sides = sides_of(frame);
  for (const Scene& scene : scenes) {
    double most = 0, same = 0, opposite = 0;
    for (const DrawnSide& side : sides)
      for (const double part : {0.2, 0.5, 0.8}) {
        const Vec2 y = image_of(mirror, at(side, part));
        const DrawnSide* other = nullptr;
        double there = 0, least = infinity;
        for (const DrawnSide& s : sides) {
          const double near = nearest(s, y), away = (at(s, near) - y).squaredNorm();
          if (away < least) least = away, other = &s, there = near;
        }
        const Acting here = acting_on(scene, side, part), image = acting_on(scene, *other, there);
        if (here.held != image.held) return false;
        const Vec2 seen = image_of(mirror, Vec2(mirror.point + here.traction)) - mirror.point;
        most = std::max(most, here.traction.norm());
        same = std::max(same, (seen - image.traction).norm());
        opposite = std::max(opposite, (seen + image.traction).norm());
      }
    if (std::min(same, opposite) > digits * most) return false;
  }
  return true;
}

std::optional<Shape> symmetric(const Shape& body, const Shape& frame, const Mirror& mirror, double side) {
  const Halves halves(frame, mirror, side);
  Shape out = body;
  out.holes.clear();
  out.outline.sides.clear();
  int bodies = 0;
  const auto add = [&](const Loop& loop, bool hole) {
    std::vector<DrawnSide> sides;
    add_sides(loop, hole, sides);
    if (hole && std::ranges::none_of(sides, [&](const DrawnSide& s) { return halves.is_drawn(s); })) {
      double most = -infinity, least = infinity;
      for (const DrawnSide& s : sides)
        for (int k = 0; k < 8; ++k) {
          const double here = halves.height(at(s, k / 8.0));
          most = std::max(most, here);
          least = std::min(least, here);
        }
      if (most <= halves.near()) return;
      out.holes.push_back(loop);
      if (least < -halves.near()) return;  // it lies on the line: its own image
      const Vec2 there = image_of(mirror, at(sides.front(), 0.25));
      for (const Loop& other : frame.holes)
        if (Region(other).away(there) <= 1e3 * halves.near()) out.holes.push_back(other);
      return;
    }
    for (const std::vector<DrawnSide>& closed : halves.doubled(sides)) {
      if (closed.empty()) continue;
      if (signed_area(closed) < 0)
        out.holes.push_back(loop_of(hole ? loop.name : "design", closed));
      else if (++bodies == 1)
        out.outline = loop_of(body.outline.name, closed);
    }
  };
  add(body.outline, false);
  for (const Loop& hole : body.holes) add(hole, true);
  const bool whole = std::ranges::none_of(out.outline.sides, [](const Side& s) { return s.label == none; });
  if (bodies != 1 || !whole || find_problem(out)) return {};
  return out;
}

}  // namespace kerf
