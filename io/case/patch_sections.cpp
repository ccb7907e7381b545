// Forces and supports at points: [[load]], and [[boundary]] with `at`. A short edge is drawn on the outline or a hole,
// half of its width along the boundary to either side of the point nearest to `at`, and gets a label of its own; what
// acts on the side that it is a piece of acts on it, too. It may go on over vertices where the boundary hardly turns,
// not over corners, ends of labels and other such edges. At a corner with a plane of symmetry, which continues the
// boundary as its mirror image, half of the edge is there. A body that was written with its edges (a design, a grown
// body) has them already. Here too: short sides beside the tips of cracks in planes of symmetry, which ask for a fine
// mesh there.

#include "geometry/plane.hpp"
#include "io/case/formula.hpp"
#include "io/case/sections.hpp"
#include "io/words.hpp"
#include "solver/half_cracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double default_width = 1e-3;  // of the extent
constexpr double hardly = 0.05;         // a turn that is no corner, as in the stress

/// A straight side or an arc from its start (0) to its end (1).
struct SidePart {
  Vec2 a, b;
  std::optional<Arc> arc;

  SidePart(const Loop& loop, std::size_t i)
      : a(loop.sides[i].start), b(loop.sides[(i + 1) % loop.sides.size()].start), arc(loop.sides[i].arc) {}
  double turned(double t) const {
    return arc->from + t * (arc->to - arc->from);
  }
  Vec2 point(double t) const {
    return arc ? kerf::at(*arc, turned(t)) : Vec2(a + t * (b - a));
  }
  Vec2 slope(double t) const {
    return arc ? Vec2((arc->to - arc->from) * velocity(*arc, turned(t))) : Vec2(b - a);
  }
  /// From 0 to t: exact on lines and circles, by Simpson's rule on ellipses.
  double length(double t) const {
    constexpr int steps = 64;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double h = t / steps, from = i * h;
      sum += h / 6 * (slope(from).norm() + 4 * slope(from + h / 2).norm() + slope(from + h).norm());
    }
    return sum;
  }
  double place(double s) const {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) (length((low + high) / 2) < s ? low : high) = (low + high) / 2;
    return (low + high) / 2;
  }
  /// Of the point nearest to x.
  double nearest(const Vec2& x) const {
    if (!arc) return foot(x, a, b);
    constexpr int samples = 128;
    double best = 0;
    for (int i = 1; i <= samples; ++i)
      if (const double t = i / double(samples); (point(t) - x).norm() < (point(best) - x).norm()) best = t;
    double low = std::max(0.0, best - 1.0 / samples), high = std::min(1.0, best + 1.0 / samples);
    for (int i = 0; i < 80; ++i) {
      const double p = low + (high - low) / 3, q = high - (high - low) / 3;
      ((point(p) - x).norm() < (point(q) - x).norm() ? high : low) =
          (point(p) - x).norm() < (point(q) - x).norm() ? q : p;
    }
    return (low + high) / 2;
  }
};

/// A place on the boundary.
struct OnRim {
  Loop* loop = nullptr;
  std::size_t side = 0;
  double t = 0, distance = infinity;
};

OnRim nearest_on_rim(Shape& shape, const Vec2& x) {
  OnRim best;
  const auto look = [&](Loop& loop) {
    for (std::size_t i = 0; i < loop.sides.size(); ++i) {
      const SidePart side(loop, i);
      const double t = side.nearest(x), d = (side.point(t) - x).norm();
      if (d < best.distance) best = {&loop, i, t, d};
    }
  };
  look(shape.outline);
  for (Loop& hole : shape.holes) look(hole);
  return best;
}

/// What is to be drawn, and whom to blame.
class Drawer {
 public:
  Drawer(Case& c, std::vector<Index> planes) : c_(c), planes_(std::move(planes)) {}

  PointPatch draw(const Value& table, const std::string& name) {
    const Value at = need(table, "at");
    PointPatch patch{.at = point(at)};
    if (c_.mesh)
      fail(at.node->position,
           fmt::format("{}: the mesh of domain.file is taken as it is, and no edge can be drawn in it; name a curve "
                       "there, and give it a traction or a displacement in [[boundary]]",
                       at.name));
    const double size = extent(c_.shape);
    patch.width = default_width * size;
    const auto width = find(table, "width");
    if (width) patch.width = in_range(*width), patch.given = true;
    blamed_ = width ? *width : at;
    constexpr double narrowest = 1e-7;
    if (patch.width < narrowest * size)
      refuse(fmt::format("an edge {:.3g} wide is lost in the rounding of a body of {:.3g}; make it wider", patch.width,
                         size));
    const OnRim on = nearest_on_rim(c_.shape, patch.at);
    if (!(on.distance <= patch.width / 2)) {
      const Vec2 nearest = SidePart(*on.loop, on.side).point(on.t);
      fail(at.node->position,
           fmt::format("{}: ({:.6g}, {:.6g}) lies {:.3g} from the boundary, farther than half the width; the nearest "
                       "point of it is ({:.9g}, {:.9g})",
                       at.name, patch.at.x(), patch.at.y(), on.distance, nearest.x(), nearest.y()));
    }
    const auto known = std::ranges::find(c_.shape.labels, name);
    if (known != c_.shape.labels.end())
      return drawn_already(at, name, static_cast<Index>(known - c_.shape.labels.begin()), on, patch);
    cut(on, name, size, patch);
    return patch;
  }

 private:
  Case& c_;
  const std::vector<Index> planes_;
  std::optional<Value> blamed_;

  bool in_plane(Index label) const {
    return std::ranges::find(planes_, label) != planes_.end();
  }
  [[noreturn]] void refuse(const std::string& what) const {
    fail(blamed_->node->position, blamed_->name + ": " + what);
  }

  /// A body that was written with its edges. The label beside is that of a neighbor.
  PointPatch drawn_already(const Value& at, const std::string& name, Index label, const OnRim& on,
                           PointPatch patch) const {
    const auto& sides = on.loop->sides;
    const auto refuse_taken = [&] {
      fail(at.node->position,
           fmt::format("{}: there is a label {} already; give this one another name", at.name, quote(name)));
    };
    if (sides[on.side].label != label || std::ranges::find(c_.patches, label, &PointPatch::label) != c_.patches.end())
      refuse_taken();
    patch.label = label;
    double length = 0;
    for (std::size_t i = 0; i < sides.size(); ++i)
      if (sides[i].label == label) length += SidePart(*on.loop, i).length(1);
    patch.at_plane = length < 0.75 * patch.width;
    if (std::abs(length - (patch.at_plane ? 0.5 : 1) * patch.width) > 1e-6 * patch.width) refuse_taken();
    for (std::size_t k = 1; k < sides.size(); ++k) {
      const Index other = sides[(on.side + k) % sides.size()].label;
      if (other == label || in_plane(other)) continue;
      patch.beside = other;
      break;
    }
    return patch;
  }

  /// How far the boundary goes on without a corner from vertex `i` of the loop; the turn there.
  double turn_at(const Loop& loop, std::size_t vertex) const {
    const std::size_t before = (vertex + loop.sides.size() - 1) % loop.sides.size();
    const Vec2 in = SidePart(loop, before).slope(1), out = SidePart(loop, vertex).slope(0);
    return std::atan2(cross(in, out), in.dot(out));
  }
  bool is_plane_corner(const Loop& loop, std::size_t vertex, bool plane_behind) const {
    const std::size_t n = loop.sides.size(), before = (vertex + n - 1) % n;
    const bool plane = in_plane(loop.sides[plane_behind ? vertex : before].label),
               other = in_plane(loop.sides[plane_behind ? before : vertex].label);
    return plane && !other && std::abs(std::abs(turn_at(loop, vertex)) - pi / 2) < hardly;
  }

  /// One end of the edge: `half` of the width from `on`, forwards or back. Checks what lies between.
  struct End {
    std::size_t side;
    double s;  // length from the start of the side
  };
  End walk(const OnRim& on, double half, bool forwards, Index beside) const {
    const Loop& loop = *on.loop;
    const std::size_t n = loop.sides.size();
    std::size_t i = on.side;
    double s = SidePart(loop, i).length(on.t), left = half;
    for (std::size_t steps = 0; steps <= n; ++steps) {
      const double whole = SidePart(loop, i).length(1), room = forwards ? whole - s : s;
      check(loop, i, beside);
      if (left <= room * (1 + 1e-12)) return {i, forwards ? std::min(s + left, whole) : std::max(s - left, 0.0)};
      const std::size_t vertex = forwards ? (i + 1) % n : i;
      if (std::abs(turn_at(loop, vertex)) > hardly) {
        const Vec2 middle = SidePart(loop, on.side).point(on.t), corner = loop.sides[vertex].start;
        const double to_corner = half - left + room;
        if (to_corner < 1e-6 * half)
          refuse(fmt::format("({:.6g}, {:.6g}) is a corner; move it by {:.3g}, half the width, along one of its sides",
                             corner.x(), corner.y(), half));
        refuse(fmt::format(
            "an edge {:.6g} wide around ({:.6g}, {:.6g}) passes the corner at ({:.6g}, {:.6g}), {:.3g} away; "
            "make it no wider than {:.3g}, or move it by {:.3g} along the side",
            2 * half, middle.x(), middle.y(), corner.x(), corner.y(), to_corner, 2 * to_corner, left - room));
      }
      left -= room;
      i = forwards ? vertex : (vertex + n - 1) % n;
      s = forwards ? 0 : SidePart(loop, i).length(1);
    }
    refuse("the edge is longer than the boundary that it lies on");
  }

  void check(const Loop& loop, std::size_t i, Index beside) const {
    const Index label = loop.sides[i].label;
    const Vec2 middle = SidePart(loop, i).point(0.5);
    for (const PointPatch& other : c_.patches)
      if (other.label == label)
        refuse(fmt::format(
            "it overlaps with {} around ({:.6g}, {:.6g}), which is {:.3g} wide; make one of them narrower, "
            "or move it",
            quote(c_.shape.labels[static_cast<std::size_t>(label)]), other.at.x(), other.at.y(), other.width));
    if (in_plane(label))
      refuse(fmt::format("it lies on {} near ({:.6g}, {:.6g}), a plane of symmetry, which is inside of the whole body",
                         quote(c_.shape.labels[static_cast<std::size_t>(label)]), middle.x(), middle.y()));
    if (label != beside)
      refuse(
          fmt::format("it lies on {} and on {}, with the border at an end of the side around ({:.6g}, {:.6g}); make it "
                      "narrower, or move it",
                      quote(c_.shape.labels[static_cast<std::size_t>(beside)]),
                      quote(c_.shape.labels[static_cast<std::size_t>(label)]), middle.x(), middle.y()));
  }

  void cut(OnRim on, const std::string& name, double size, PointPatch& patch) {
    Loop& loop = *on.loop;
    const std::size_t n = loop.sides.size();
    // At a corner with a plane: the side beyond it.
    for (const std::size_t vertex : {on.side, (on.side + 1) % n})
      if ((loop.sides[vertex].start - patch.at).norm() <= 1e-6 * size)
        for (const bool plane_behind : {true, false})
          if (n > 1 && is_plane_corner(loop, vertex, plane_behind)) {
            patch.at_plane = true;
            on.side = plane_behind ? (vertex + n - 1) % n : vertex;
            on.t = plane_behind ? 1 : 0;
          }
    patch.beside = loop.sides[on.side].label;
    patch.label = static_cast<Index>(c_.shape.labels.size());
    const double half = patch.width / 2;
    const End here{on.side, SidePart(loop, on.side).length(on.t)};
    const End from = patch.at_plane && on.t == 0 ? here : walk(on, half, false, patch.beside),
              to = patch.at_plane && on.t == 1 ? here : walk(on, half, true, patch.beside);
    split(loop, from, to, patch.label);
    c_.shape.labels.push_back(name);
  }

  /// The sides between the two ends get the label.
  static void split(Loop& loop, const End& from, const End& to, Index label) {
    const std::size_t n = loop.sides.size();
    std::vector<Side> sides;
    const auto add = [&](std::size_t i, double t0, double t1, Index name) {
      if (!(t1 > t0)) return;
      Side piece = loop.sides[i];
      piece.start = t0 == 0 ? piece.start : SidePart(loop, i).point(t0);
      if (piece.arc) {
        const SidePart all(loop, i);
        piece.arc->from = all.turned(t0);
        piece.arc->to = all.turned(t1);
      }
      piece.label = name;
      sides.push_back(std::move(piece));
    };
    const bool wraps = from.side == to.side && from.s > to.s;
    const auto between = [&](std::size_t i) {  // wholly
      return from.side <= to.side && !wraps ? from.side < i && i < to.side : i > from.side || i < to.side;
    };
    for (std::size_t i = 0; i < n; ++i) {
      const SidePart side(loop, i);
      const auto at = [&](const End& end) {
        const double whole = side.length(1), near = 1e-9 * whole;
        return end.s <= near ? 0.0 : end.s >= whole - near ? 1.0 : side.place(end.s);
      };
      const Index own = loop.sides[i].label;
      if (i == from.side && i == to.side && !wraps) {
        add(i, 0, at(from), own), add(i, at(from), at(to), label), add(i, at(to), 1, own);
      } else if (i == from.side && i == to.side) {
        add(i, 0, at(to), label), add(i, at(to), at(from), own), add(i, at(from), 1, label);
      } else if (i == from.side) {
        add(i, 0, at(from), own), add(i, at(from), 1, label);
      } else if (i == to.side) {
        add(i, 0, at(to), label), add(i, at(to), 1, own);
      } else {
        add(i, 0, 1, between(i) ? label : own);
      }
    }
    // A hole is known by the label of its first side.
    const auto first = std::ranges::find_if(sides, [&](const Side& s) { return s.label != label; });
    std::rotate(sides.begin(), first == sides.end() ? sides.begin() : first, sides.end());
    loop.sides = std::move(sides);
  }
};

}  // namespace

std::vector<Value> tables_of_patches(const Value& document) {
  std::vector<Value> tables = find_tables(document, "load");
  for (const Value& table : find_tables(document, "boundary"))
    if (find(table, "at")) tables.push_back(table);
  return tables;
}

void read_patches(const Value& document, Case& c) {
  const std::vector<Value> tables = tables_of_patches(document);
  if (tables.empty()) return;
  std::vector<Index> planes;
  for (const Value& table : find_tables(document, "boundary"))
    if (const auto symmetry = find(table, "symmetry"), on = find(table, "on"); symmetry && on && boolean(*symmetry)) {
      const std::vector<Value> names = on->node->kind == Node::Kind::Array ? items(*on) : std::vector<Value>{*on};
      for (const Value& name : names)
        if (const auto found = std::ranges::find(c.shape.labels, text(name)); found != c.shape.labels.end())
          planes.push_back(static_cast<Index>(found - c.shape.labels.begin()));
    }
  Drawer drawer(c, std::move(planes));
  std::size_t loads = 0, supports = 0;
  for (const Value& table : tables) {
    const bool load = table.path == "load[]";
    if (!load) one_of(table);
    allow_only(table, load ? "" : "at");
    const auto given = find(table, "name");
    const std::string name = given  ? safe_name(*given)
                             : load ? fmt::format("load-{}", ++loads)
                                    : fmt::format("support-{}", ++supports);
    c.patches.push_back(drawer.draw(table, name));
  }
}

void draw_half_tips(Case& c) {
  if (c.planes.empty()) return;
  if (c.mesh) {
    for (const HalfCrack& crack : half_cracks(*c.mesh, c.scene, c.planes))
      for (const bool start : {true, false})
        if (crack.tips[start ? 0 : 1]) c.half_tips.push_back(tip_of(*c.mesh, crack, start));
    return;
  }
  Sizing sizing = c.sizing;
  const double size = target_size(sizing, c.shape),
               short_side = sizing.crack_tip_size > 0 ? sizing.crack_tip_size : size / 100;
  const auto in_plane = [&](const Side& s) { return std::ranges::find(c.planes, s.label) != c.planes.end(); };
  const auto is_free = [&](const Side& s) {
    return std::ranges::find(c.scene.supports, s.label, &Support::label) == c.scene.supports.end();
  };
  const auto refine = [&](Loop& loop) {
    const std::size_t n = loop.sides.size();
    std::vector<bool> tip(n, false);  // vertices
    for (std::size_t v = 0; v < n; ++v) {
      const Side &before = loop.sides[(v + n - 1) % n], &behind = loop.sides[v];
      if (before.arc || behind.arc) continue;
      if (!(in_plane(before) && is_free(behind)) && !(is_free(before) && in_plane(behind))) continue;
      const Vec2 in = behind.start - before.start, out = loop.sides[(v + 1) % n].start - behind.start;
      tip[v] = std::abs(cross(in, out)) <= 1e-6 * in.dot(out);
      if (tip[v]) c.half_tips.push_back(behind.start);
    }
    std::vector<Side> sides;
    for (std::size_t v = 0; v < n; ++v) {
      const Vec2 a = loop.sides[v].start, b = loop.sides[(v + 1) % n].start;
      sides.push_back(loop.sides[v]);
      const double l = (b - a).norm();
      if (loop.sides[v].arc || l <= 3 * short_side) continue;
      for (const auto& [wanted, share] :
           {std::pair(bool(tip[v]), short_side / l), std::pair(bool(tip[(v + 1) % n]), 1 - short_side / l)})
        if (wanted) {
          Side more = loop.sides[v];
          more.start = a + share * (b - a);
          sides.push_back(std::move(more));
        }
    }
    loop.sides = std::move(sides);
  };
  refine(c.shape.outline);
  for (Loop& hole : c.shape.holes) refine(hole);
}

}  // namespace kerf
