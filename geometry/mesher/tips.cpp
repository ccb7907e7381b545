// Free ends of cracks, their room, and patches around them. A patch is a disc of triangles with edges 1 at the tip that
// grow by `grading` up to `radius`, meshed on the upper half and mirrored, so that the mesh at a tip is its own mirror
// image in the crack: without that, slip at a closed tip makes a false pressure, see docs/theory/fracture.md, "False
// pressure at sliding tips". It is put at its place scaled by the edge at the tip, along an arc bent with it. Patches
// come in few kinds: radii in steps of a half, gradings in steps of 1/20. The drawing around them has a hole in place
// of each, whose sides are edges of the mesh.

#include "geometry/mesher/tips.hpp"

#include "geometry/boxes.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double wanted_radius = 10, least_radius = 3;  // in edges at the tip
constexpr double share = 0.45;                          // of the room
constexpr double most_turn = 0.5;                       // of a crack within the room of its tip

/// Away from a free end of a strand; may be shorter than the way along it.
double reach_along(const Drawing& drawing, const Strand& strand) {
  const Vec2 &a = drawing.corners[std::size_t(strand.from)], &b = drawing.corners[std::size_t(strand.to)];
  const double chord = (b - a).norm();
  return strand.arc ? std::min(chord, most_turn * smallest_radius(*strand.arc)) : chord;
}

/// At most the distance to a strand.
double least_distance(const Strand& strand, const Vec2& x) {
  if (!strand.arc) return 0;
  const double d = (x - strand.arc->center).norm();
  return std::max({0.0, d - largest_radius(*strand.arc), smallest_radius(*strand.arc) - d});
}

/// Where a point of the frame of the tip lies: x along the crack and beyond it, y across.
/// Along an arc x is a length along the circle and y a distance from it: a bent patch keeps its radial edges.
Vec2 beside_crack(const Drawing& drawing, const TipEnd& tip, const Vec2& x) {
  const Strand& strand = drawing.strands[tip.strand];
  const Vec2& at_tip = drawing.corners[std::size_t(tip.corner)];
  if (!strand.arc) {
    const Vec2& other = drawing.corners[std::size_t(tip.at_start ? strand.to : strand.from)];
    const Vec2 ahead = (at_tip - other).normalized();
    return at_tip + x.x() * ahead + x.y() * Vec2(-ahead.y(), ahead.x());
  }
  const Arc& arc = *strand.arc;
  const double radius = smallest_radius(arc);
  const double way = (arc.to > arc.from) == tip.at_start ? -1 : 1;  // of t beyond the tip
  const double t = (tip.at_start ? arc.from : arc.to) + way * x.x() / radius;
  return arc.center + (radius - way * x.y()) * Vec2(std::cos(t), std::sin(t));
}

}  // namespace

/// A corner with one strand. Arcs whose circle is further away than the room so far are not looked at.
std::vector<TipEnd> free_ends(const Drawing& drawing) {
  std::vector<int> degree(drawing.corners.size(), 0);
  for (const Strand& s : drawing.strands) {
    ++degree[std::size_t(s.from)];
    ++degree[std::size_t(s.to)];
  }
  std::vector<TipEnd> ends;
  if (std::ranges::all_of(drawing.strands, [](const Strand& s) { return s.crack == none; })) return ends;
  const BoxTree tree(boxes_of(drawing));
  const auto anywhere = [](const AxisBox&) { return true; };
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    const Strand& strand = drawing.strands[k];
    if (strand.crack == none) continue;
    for (const bool start : {true, false}) {
      const Index corner = start ? strand.from : strand.to;
      if (degree[std::size_t(corner)] != 1) continue;
      const Vec2& x = drawing.corners[std::size_t(corner)];
      double room = reach_along(drawing, strand);
      tree.each_near(x, room, anywhere, [&](Index i) {
        const Strand& other = drawing.strands[std::size_t(i)];
        if (std::size_t(i) != k && least_distance(other, x) < room)
          room = std::min(room, nearest(drawing, other, x).distance);
      });
      ends.push_back({k, start, corner, strand.crack, room});
    }
  }
  return ends;
}

// With fewer edges no ring around the tip resolves anything: K is off by percents or unknown. With 20 it is right to a
// few thousandths, at 150 triangles more per tip.
constexpr double fewest = 2, enough = 20;

double largest_in_room(double room) {
  return room / fewest;
}

double size_in_room(double room, double asked) {
  return asked > largest_in_room(room) ? room / enough : asked;
}

Shape half_disc(const PatchKind& kind) {
  const double r = kind.radius;
  Side left{.start = {-r, 0}, .label = 0}, right{.start = {0, 0}, .label = 0},
      rim{.start = {r, 0}, .label = 1, .arc = Arc{Vec2::Zero(), r * Mat2::Identity(), 0, pi}};
  return {
      .outline = {"patch", {left, right, rim}}, .holes = {}, .cracks = {}, .labels = {"crack", "rim"}, .regions = {}};
}

/// Points of the rim come first, counter-clockwise from the crack; points on the axis are shared by both halves.
Patch mirrored(const Mesh& half) {
  const std::size_t n = half.points.size();
  std::vector<bool> on_axis(n, false), on_rim(n, false);
  for (std::size_t e = 0; e < half.edges.size(); ++e)
    for (const Index v : half.edges[e]) {
      if (half.label[e] == 0) on_axis[std::size_t(v)] = true;
      if (half.label[e] == 1) on_rim[std::size_t(v)] = true;
    }
  // Counter-clockwise from the crack: the lower half comes first.
  std::vector<Index> rim;
  for (std::size_t v = 0; v < n; ++v)
    if (on_rim[v]) rim.push_back(Index(v));
  std::sort(rim.begin(), rim.end(),
            [&](Index a, Index b) { return half.points[std::size_t(a)].x() < half.points[std::size_t(b)].x(); });
  Patch patch;
  std::vector<Index> upper(n, none), lower(n, none);
  const auto add = [&](std::vector<Index>& numbers, std::size_t v, double sign) {
    numbers[v] = Index(patch.points.size());
    patch.points.push_back({half.points[v].x(), on_axis[v] ? 0 : sign * half.points[v].y()});
    if (on_axis[v]) upper[v] = lower[v] = numbers[v];
  };
  for (const Index v : rim) add(lower, std::size_t(v), -1);
  for (std::size_t i = rim.size() - 1; i-- > 1;) add(upper, std::size_t(rim[i]), 1);
  patch.boundary = Index(patch.points.size());
  for (std::size_t v = 0; v < n; ++v) {
    if (lower[v] == none) add(lower, v, -1);
    if (upper[v] == none) add(upper, v, 1);
  }
  for (const auto& [a, b, c] : half.triangles) {
    patch.triangles.push_back({upper[std::size_t(a)], upper[std::size_t(b)], upper[std::size_t(c)]});
    patch.triangles.push_back({lower[std::size_t(a)], lower[std::size_t(c)], lower[std::size_t(b)]});
  }
  for (std::size_t v = 0; v < n; ++v)
    if (on_axis[v] && half.points[v].x() <= 0) patch.crack.push_back(upper[v]);
  std::sort(patch.crack.begin(), patch.crack.end(),
            [&](Index a, Index b) { return patch.points[std::size_t(a)].x() > patch.points[std::size_t(b)].x(); });
  return patch;
}

/// The rim's edges must not be longer than what the field asks for around it: grading = (h/size - 1)/radius from the
/// least h.
bool fit(PatchPlace& place, const Drawing& drawing, const SizeField& field, double most) {
  double radius = std::min(most, std::floor(2 * share * place.tip.room / place.size) / 2);
  for (; radius >= least_radius; radius -= 0.5) {
    double around = infinity;
    for (int i = 0; i < 16; ++i) {
      const Vec2 x(std::cos(pi * i / 8), std::sin(pi * i / 8));
      around = std::min(around, size_at(field, beside_crack(drawing, place.tip, radius * place.size * x)));
    }
    // In steps, so that tips share their patches.
    const double grading = std::floor(20 * (around / place.size - 1) / radius + 1e-6) / 20;
    if (grading < 0) continue;
    place.kind = {radius, std::min(grading, 1.0)};
    return true;
  }
  return false;
}

std::vector<PatchPlace> place_patches(const Drawing& drawing, const SizeField& field) {
  std::vector<PatchPlace> places;
  for (const TipEnd& tip : free_ends(drawing)) {
    PatchPlace place{tip, {}, size_at(field, drawing.corners[std::size_t(tip.corner)])};
    if (fit(place, drawing, field, wanted_radius)) places.push_back(place);
  }
  return places;
}

Patch put(const Patch& patch, const Drawing& drawing, const PatchPlace& place) {
  Patch there = patch;
  there.tip = place.tip;
  for (Vec2& x : there.points) x = beside_crack(drawing, place.tip, place.size * x);
  there.points[std::size_t(there.crack.front())] = drawing.corners[std::size_t(place.tip.corner)];
  return there;
}

/// The crack ends on point 0 of the patch; an arc ends at the angle of that point, a turn of at most half away.
Drawing without(Drawing drawing, const std::vector<Patch>& patches, Index first_loop) {
  for (const Patch& patch : patches) {
    const Index first = Index(drawing.corners.size()), loop = first_loop++;
    drawing.corners.insert(drawing.corners.end(), patch.points.begin(), patch.points.begin() + patch.boundary);
    Strand& crack = drawing.strands[patch.tip.strand];
    if (crack.arc) {
      const Vec2 x = patch.points.front() - crack.arc->center;
      double& end = patch.tip.at_start ? crack.arc->from : crack.arc->to;
      end += std::remainder(std::atan2(x.y(), x.x()) - end, 2 * pi);
    }
    (patch.tip.at_start ? crack.from : crack.to) = first;
    for (Index i = 0; i < patch.boundary; ++i)
      drawing.strands.push_back({.from = first + i,
                                 .to = first + (i + 1) % patch.boundary,
                                 .arc = {},
                                 .label = none,
                                 .loop = loop,
                                 .crack = none,
                                 .region = none,
                                 .keep = true});
  }
  return drawing;
}

}  // namespace kerf
