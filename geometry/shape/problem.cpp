// What makes a shape unusable, cheapest checks first.
// Numbers and counts first, then lengths and arcs, then the drawing: crossings and touches (crossings.cpp), interfaces,
// sides to be kept, cracks that come back to themselves, wedges below a degree, and places (a hole outside, a crack in
// a hole), which are only asked once it is known that nothing crosses. Tolerances are parts of the extent: 1e-9 apart
// (touch_tolerance), 1e-6 joined (join_tolerance). Messages name the loop, side or crack and a place.

#include "geometry/interfaces.hpp"
#include "geometry/shape/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Problem = std::optional<std::string>;

std::string text(const Vec2& x) {
  return fmt::format("({:.6g}, {:.6g})", x.x(), x.y());
}

/// Loops are numbered: the outline, holes, regions.
std::size_t loop_count(const Shape& shape) {
  return 1 + shape.holes.size() + shape.regions.size();
}
const Loop& loop(const Shape& shape, std::size_t number) {
  if (number == 0) return shape.outline;
  return number <= shape.holes.size() ? shape.holes[number - 1] : shape.regions[number - 1 - shape.holes.size()];
}
std::string name(const Shape& shape, std::size_t number) {
  if (number == 0) return "the outline";
  return fmt::format("{} '{}'", number <= shape.holes.size() ? "hole" : "region", loop(shape, number).name);
}

/// Numbers that are no numbers, or so large that their squares are not.
bool usable(const Vec2& x) {
  return x.allFinite() && x.cwiseAbs().maxCoeff() < 1e100;
}

bool usable(const Arc& arc) {
  return usable(arc.center) && usable(arc.axes.col(0)) && usable(arc.axes.col(1)) && std::isfinite(arc.from) &&
         std::isfinite(arc.to);
}

/// 1e100: squares and products of two coordinates stay finite.
Problem numbers(const Shape& shape) {
  for (std::size_t l = 0; l < loop_count(shape); ++l) {
    const std::vector<Side>& sides = loop(shape, l).sides;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Side& side = sides[i];
      if (!usable(side.start) || (side.arc && !usable(*side.arc)))
        return fmt::format("side {} of {} has a coordinate that is no finite number below 1e100", i + 1,
                           name(shape, l));
      if (side.label < none || side.label >= Index(shape.labels.size()))
        return fmt::format("side {} of {} has label number {}, but the shape has {} labels", i + 1, name(shape, l),
                           side.label, shape.labels.size());
    }
  }
  for (const Crack& crack : shape.cracks) {
    if (crack.arc && !usable(*crack.arc))
      return fmt::format("the arc of crack '{}' has a number that is no finite number below 1e100", crack.name);
    for (std::size_t i = 0; i < crack.points.size(); ++i)
      if (!usable(crack.points[i]))
        return fmt::format("point {} of crack '{}' has a coordinate that is no finite number below 1e100", i + 1,
                           crack.name);
  }
  return {};
}

Problem counts(const Shape& shape) {
  for (std::size_t l = 0; l < loop_count(shape); ++l) {
    const std::vector<Side>& sides = loop(shape, l).sides;
    const bool curved = std::any_of(sides.begin(), sides.end(), [](const Side& s) { return s.arc.has_value(); });
    if (sides.empty()) return fmt::format("{} has no sides", name(shape, l));
    if (sides.size() == 1 && curved && !closed(sides.front()))
      return fmt::format("{} is one arc that does not close; it must turn by 2 pi", name(shape, l));
    if (sides.size() < (curved ? 1u : 3u))
      return fmt::format("{} has {} sides; a closed polygon needs at least three", name(shape, l), sides.size());
  }
  for (const Crack& crack : shape.cracks)
    if (crack.points.size() < 2)
      return fmt::format("crack '{}' has {} point{}; its path needs at least two", crack.name, crack.points.size(),
                         crack.points.size() == 1 ? "" : "s");
  for (const Crack& crack : shape.cracks)
    if (crack.arc && crack.points.size() != 2)
      return fmt::format("crack '{}' is an arc with {} points; it needs its start and its end", crack.name,
                         crack.points.size());
  return {};
}

Problem arc_problem(const Arc& arc, const Vec2& start, const Vec2& end, double size) {
  // The small axis as determinant over norm: zero as well when the axes are parallel.
  const double least = arc.axes.norm() > 0 ? std::abs(determinant(arc)) / arc.axes.norm() : 0;
  if (!(least > touch_tolerance * size)) return "has an arc without a radius; its axes must not be zero or parallel";
  const double turn = std::abs(arc.to - arc.from);
  if (!(turn * least > touch_tolerance * size)) return "has zero length";
  if (turn > 2 * pi + 1e-9) return "has an arc that turns by more than 2 pi";
  if (!((at(arc, arc.from) - start).norm() <= join_tolerance * size))
    return fmt::format("has an arc that starts at {} instead of {}", text(at(arc, arc.from)), text(start));
  if (!((at(arc, arc.to) - end).norm() <= join_tolerance * size))
    return fmt::format("has an arc that ends at {} instead of {}", text(at(arc, arc.to)), text(end));
  return {};
}

/// `along` the sides of a region it may be one of an ellipse, and close.
Problem crack_arc_problem(const Crack& crack, double size, bool along) {
  const Arc& arc = *crack.arc;
  const double radius = arc.axes.col(0).norm();
  if (!(radius > touch_tolerance * size)) return "has an arc without a radius; it must be positive";
  if (!(radius < 1e5 * size)) return fmt::format("has an arc of radius {:.3g}, too flat; draw it straight", radius);
  if (!along &&
      !((arc.axes.transpose() * arc.axes - radius * radius * Mat2::Identity()).norm() <= 1e-9 * radius * radius))
    return "is an arc of no circle";
  if (along ? !(std::abs(arc.to - arc.from) < 2 * pi + 1e-9) : !(std::abs(arc.to - arc.from) < 2 * pi))
    return "turns by a full circle or more; a closed cut is a hole";
  if (!((at(arc, arc.from) - crack.points.front()).norm() + (at(arc, arc.to) - crack.points.back()).norm() <=
        (along ? join_tolerance : touch_tolerance) * size))
    return fmt::format("has an arc from {} to {}, but other end points", text(at(arc, arc.from)),
                       text(at(arc, arc.to)));
  return {};
}

Problem lengths(const Shape& shape, double size) {
  for (std::size_t l = 0; l < loop_count(shape); ++l) {
    const std::vector<Side>& sides = loop(shape, l).sides;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Vec2 &start = sides[i].start, &end = sides[(i + 1) % sides.size()].start;
      if (sides[i].arc) {
        if (const Problem problem = arc_problem(*sides[i].arc, start, end, size))
          return fmt::format("side {} of {} {}", i + 1, name(shape, l), *problem);
        if (sides[i].keep)
          return fmt::format("side {} of {} is to be one edge of the mesh, but is curved", i + 1, name(shape, l));
      } else if (!((end - start).norm() > touch_tolerance * size)) {
        return fmt::format("side {} of {} has zero length at {}; remove the repeated point", i + 1, name(shape, l),
                           text(start));
      }
    }
  }
  return {};
}

/// `along`: per crack, whether it is an interface.
Problem lengths_of_cracks(const Shape& shape, double size, const std::vector<bool>& along) {
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    const Crack& crack = shape.cracks[c];
    if (crack.arc)
      if (const Problem problem = crack_arc_problem(crack, size, along[c]))
        return fmt::format("crack '{}' {}", crack.name, *problem);
    for (std::size_t i = 0; !crack.arc && i + 1 < crack.points.size(); ++i) {
      const double edge = (crack.points[i + 1] - crack.points[i]).norm();
      if (!(edge > touch_tolerance * size))
        return fmt::format("edge {} of crack '{}' has zero length at {}; remove the repeated point", i + 1, crack.name,
                           text(crack.points[i]));
    }
    const double length = path_length(crack);
    if (!(length > 4 * join_tolerance * size))
      return fmt::format("crack '{}' is too short: {:.3g} in a body of extent {:.3g}", crack.name, length, size);
    if (!along[c] && (crack.points.front() - crack.points.back()).norm() <= join_tolerance * size)
      return fmt::format("crack '{}' touches itself at {}: it starts and ends there; a closed cut is a hole",
                         crack.name, text(crack.points.front()));
  }
  return {};
}

/// The pieces of a loop.
class Fence {
 public:
  std::vector<Vec2> points;  // where they begin
  AxisBox box;               // says most of what there is to say: arcs bulge from it by less than their chords are long

  void add(const Vec2& a, const Vec2& b, bool curved) {
    points.push_back(a);
    sides_.push_back({a, b});
    box.add(box_around(a, b).grown(curved ? (b - a).norm() : 0));
  }

  /// Whether most of the points, or of some twenty of them, lie inside. All do or none, but close to an arc its chords
  /// may say otherwise.
  bool contains(const std::vector<Vec2>& x) const {
    const std::size_t step = std::max<std::size_t>(1, x.size() / 20);
    std::ptrdiff_t within = 0;
    for (std::size_t i = 0; i < x.size(); i += step) within += inside(x[i]) ? 1 : -1;
    return within > 0;
  }

  /// The same, when a look at the first one is enough to see that they do not.
  bool encloses(const std::vector<Vec2>& x) const {
    return box.has(x.front()) && contains(x);
  }

 private:
  bool inside(const Vec2& x) const {
    constexpr std::size_t few = 32;
    if (sides_.size() <= few) return kerf::inside(sides_, x);
    if (!tree_) {
      std::vector<AxisBox> boxes;
      for (const auto& [a, b] : sides_) boxes.push_back(box_around(a, b));
      tree_ = BoxTree(boxes);
    }
    const double rounding = 1e-9 * (box.high - box.low).norm();
    bool odd = false;
    tree_->each(
        [&](const AxisBox& b) { return b.low.y() <= x.y() && x.y() <= b.high.y() && x.x() <= b.high.x() + rounding; },
        [&](Index k) {
          const auto& [a, b] = sides_[std::size_t(k)];
          if (crosses_ray(x, a, b)) odd = !odd;
        });
    return odd;
  }

  std::vector<std::array<Vec2, 2>> sides_;
  mutable std::optional<BoxTree> tree_;  // made when first asked for
};

/// The holes whose boxes contain one of the points, rising; `boxes` of the holes alone.
std::vector<std::size_t> holes_around(const BoxTree& boxes, std::span<const Vec2> x) {
  std::vector<std::size_t> found;
  for (const Vec2& point : x)
    boxes.each([&](const AxisBox& box) { return box.has(point); },
               [&](Index h) { found.push_back(std::size_t(h) + 1); });
  std::ranges::sort(found);
  found.erase(std::ranges::unique(found).begin(), found.end());
  return found;
}

/// Of a shape with interfaces: sides of regions that leave the body, whose loops they meet at corners. `loops`: the
/// outline and holes first.
Problem beyond_loops(const Shape& shape, const Drawing& drawing, const std::vector<Fence>& loops,
                     const BoxTree& holes) {
  for (const Strand& strand : drawing.strands) {
    if (!strand.beyond) continue;
    std::vector<Vec2> x;
    for (int i = 1; i < 8; ++i) x.push_back(point(drawing, strand, i / 8.0));
    const Index region = strand.region == none ? *strand.beyond : strand.region;
    const std::string& called = shape.regions[std::size_t(region)].name;
    if (!loops[0].contains(x))
      return fmt::format("region '{}' leaves the body at {}; let it end on the outline", called, text(x[3]));
    for (const std::size_t h : holes_around(holes, x))
      if (loops[h].contains(x))
        return fmt::format("region '{}' reaches into {} at {}; let it end on the hole, or lie around it", called,
                           name(shape, h), text(x[3]));
  }
  return {};
}

/// Loops and cracks are known not to cross: each lies on one side of every other.
/// A box first, then some twenty points: most pairs are settled by their boxes.
Problem places(const Shape& shape, const Drawing& drawing, const Pieces& pieces) {
  std::vector<Fence> loops(loop_count(shape));
  std::vector<std::vector<Vec2>> on_crack(shape.cracks.size());
  for (const Piece& piece : pieces.pieces) {
    const Vec2 &a = pieces.points[std::size_t(piece.a)], &b = pieces.points[std::size_t(piece.b)];
    const Strand& strand = drawing.strands[std::size_t(piece.strand)];
    if (strand.crack != none) {
      on_crack[std::size_t(strand.crack)].push_back((a + b) / 2);
    } else if (!strand.beyond) {
      const std::size_t l =
          strand.region == none ? std::size_t(strand.loop) : 1 + shape.holes.size() + std::size_t(strand.region);
      loops[l].add(a, b, strand.arc.has_value());
    }
  }
  std::vector<AxisBox> boxes;
  for (std::size_t h = 1; h <= shape.holes.size(); ++h) boxes.push_back(loops[h].box);
  const BoxTree holes(boxes);
  if (Problem problem = beyond_loops(shape, drawing, loops, holes)) return problem;
  for (std::size_t h = 1; h < loops.size(); ++h) {
    const std::vector<Vec2>& on_loop = loops[h].points;
    if (on_loop.empty()) continue;  // a region in a shape with interfaces
    if (!loops[0].encloses(on_loop))
      return fmt::format("{} lies outside the outline, at {}", name(shape, h), text(on_loop.front()));
    for (const std::size_t other : holes_around(holes, {&on_loop.front(), 1}))
      if (other != h && loops[other].contains({on_loop.front()}) && loops[other].contains(on_loop))
        return fmt::format("{} lies inside {}; remove it", name(shape, h), name(shape, other));
  }
  for (std::size_t c = 0; c < on_crack.size(); ++c) {
    if (on_crack[c].empty()) continue;
    const std::string& crack = shape.cracks[c].name;
    if (!loops[0].encloses(on_crack[c]))
      return fmt::format("crack '{}' lies outside the body, at {}", crack, text(on_crack[c].front()));
    for (const std::size_t h : holes_around(holes, {&on_crack[c].front(), 1}))
      if (loops[h].contains(on_crack[c]))
        return fmt::format("crack '{}' lies inside {}, at {}", crack, name(shape, h), text(on_crack[c].front()));
  }
  return {};
}

/// Cracks that come back to a junction where they have been, or pass through the mouth of another one.
Problem revisited(const Shape& shape, const Drawing& drawing) {
  std::vector<std::vector<Index>> corners(shape.cracks.size());  // in the order of the path
  std::vector<Index> loop_of(drawing.corners.size(), none);
  for (const Strand& strand : drawing.strands) {
    if (strand.beyond) continue;  // interfaces are as simple as the regions
    if (strand.crack == none) {
      loop_of[std::size_t(strand.from)] = strand.loop;
      continue;
    }
    std::vector<Index>& path = corners[std::size_t(strand.crack)];
    if (path.empty()) path.push_back(strand.from);
    path.push_back(strand.to);
  }
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    std::vector<Index>& path = corners[c];
    for (std::size_t i = 1; i + 1 < path.size(); ++i)
      if (const Index l = loop_of[std::size_t(path[i])]; l != none)
        return fmt::format("crack '{}' meets {} at {} between its ends; only its ends may lie there",
                           shape.cracks[c].name, name(shape, std::size_t(l)),
                           text(drawing.corners[std::size_t(path[i])]));
    std::sort(path.begin(), path.end());
    const auto twice = std::adjacent_find(path.begin(), path.end());
    if (twice != path.end())
      return fmt::format("crack '{}' touches itself at {}; a crack must be a simple path", shape.cracks[c].name,
                         text(drawing.corners[std::size_t(*twice)]));
  }
  return {};
}

/// Sides to be kept whole on which a crack ends.
Problem cut_sides(const Shape& shape, const Drawing& drawing) {
  Index corners = Index(shape.outline.sides.size());
  for (const Loop& hole : shape.holes) corners += Index(hole.sides.size());
  for (const Strand& strand : drawing.strands)
    for (const Index corner : {strand.from, strand.to})
      if (strand.keep && corner >= corners)
        return fmt::format("a crack ends at {} on a side of {} that is to be one edge of the mesh",
                           text(drawing.corners[std::size_t(corner)]), name(shape, std::size_t(strand.loop)));
  return {};
}

/// Cracks that meet each other, or the border of a region, at less than a degree.
Problem wedges(const Shape& shape, const Drawing& drawing) {
  struct Arm {
    Index corner, crack;
    const Strand* strand;
    Vec2 direction;
  };
  std::vector<Arm> arms;
  for (const Strand& strand : drawing.strands) {
    if (strand.crack == none && !is_border(strand)) continue;
    arms.push_back({strand.from, strand.crack, &strand, velocity(drawing, strand, 0)});
    arms.push_back({strand.to, strand.crack, &strand, -velocity(drawing, strand, 1)});
  }
  std::stable_sort(arms.begin(), arms.end(), [](const Arm& a, const Arm& b) { return a.corner < b.corner; });
  for (auto a = arms.begin(); a != arms.end(); ++a)
    for (auto b = a + 1; b != arms.end() && b->corner == a->corner; ++b) {
      const double angle = std::abs(std::atan2(cross(a->direction, b->direction), a->direction.dot(b->direction)));
      if (a->crack == b->crack || angle >= pi / 180) continue;  // borders among themselves are as they are drawn
      if (a->crack == none || b->crack == none) {
        const Arm &crack = a->crack == none ? *b : *a, &border = a->crack == none ? *a : *b;
        if (crack.strand->beyond) continue;
        return fmt::format("{} meets {} at {} at an angle of {:.2g} degrees; at least 1 is needed",
                           name(shape, *crack.strand), name(shape, *border.strand),
                           text(drawing.corners[std::size_t(a->corner)]), angle * 180 / pi);
      }
      const auto [one, other] = std::minmax(a->crack, b->crack);
      return fmt::format("cracks '{}' and '{}' meet at {} at an angle of {:.2g} degrees; at least 1 is needed",
                         shape.cracks[std::size_t(one)].name, shape.cracks[std::size_t(other)].name,
                         text(drawing.corners[std::size_t(a->corner)]), angle * 180 / pi);
    }
  return {};
}

}  // namespace

std::optional<std::string> find_problem(const Shape& shape) {
  for (const auto check : {numbers, counts})
    if (Problem problem = check(shape)) return problem;
  const double size = extent(shape);
  if (!(size > 1e-100)) return "the outline has no extent";
  double farthest = 0;
  for (const Side& side : shape.outline.sides) farthest = std::max(farthest, side.start.cwiseAbs().maxCoeff());
  if (farthest > 1e5 * size)
    return fmt::format(
        "the outline, of extent {:.3g}, lies {:.3g} away from the origin, too far for the digits of its "
        "coordinates; move the origin closer",
        size, farthest);
  if (Problem problem = lengths(shape, size)) return problem;
  const std::vector<bool> along = along_regions(shape);
  if (Problem problem = lengths_of_cracks(shape, size, along)) return problem;
  const Gaps gaps{touch_tolerance * size, join_tolerance * size};
  if (!shape.regions.empty() && !shape.cracks.empty()) {  // what is wrong with regions, before cracks cut them
    Shape plain = shape;
    plain.cracks.clear();
    const Drawing uncut = draw(plain);
    if (Problem problem = find_crossing(plain, uncut, split_evenly(uncut), gaps, true)) return problem;
  }
  const Drawing drawing = draw(shape);
  const Pieces pieces = split_evenly(drawing);
  if (Problem problem = find_crossing(shape, drawing, pieces, gaps, true)) return problem;
  if (std::ranges::any_of(drawing.strands, [](const Strand& s) { return s.beyond.has_value(); }))
    if (Problem problem = find_wrong_interface(shape, along)) return problem;
  if (Problem problem = cut_sides(shape, drawing)) return problem;
  if (Problem problem = revisited(shape, drawing)) return problem;
  if (Problem problem = wedges(shape, drawing)) return problem;
  return places(shape, drawing, pieces);
}

}  // namespace kerf
