// A shape as corners and smooth strands between them, the body on their left: sides of loops in order, cracks between
// kinks, ends and junctions, sides of regions. Ends of cracks within 1e-6 of the extent of a side are moved onto it and
// cut it: a straight side in two, a whole circle at its seam. Loops that run the wrong way are turned. The nearest
// point of a straight strand is exact; on an arc the stationarity condition (x(t) - y) . x'(t) = 0 is bisected between
// samples, as many as the eccentricity asks for. Everything that looks at a shape (find_problem, the mesher, carving)
// looks at this drawing.

#include "geometry/shape/drawing.hpp"

#include "geometry/interfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

namespace kerf {

namespace {

double parameter(const Arc& arc, double s) {
  return arc.from + s * (arc.to - arc.from);
}

Vec2 on_strand(const std::vector<Vec2>& corners, const Strand& strand, double s) {
  if (s <= 0) return corners[std::size_t(strand.from)];
  if (s >= 1) return corners[std::size_t(strand.to)];
  if (strand.arc) return at(*strand.arc, parameter(*strand.arc, s));
  return corners[std::size_t(strand.from)] + s * (corners[std::size_t(strand.to)] - corners[std::size_t(strand.from)]);
}

}  // namespace

AxisBox box_of(const Drawing& drawing, const Strand& strand) {
  if (strand.arc) return AxisBox{strand.arc->center, strand.arc->center}.grown(largest_radius(*strand.arc));
  return box_around(drawing.corners[std::size_t(strand.from)], drawing.corners[std::size_t(strand.to)]);
}

std::vector<AxisBox> boxes_of(const Drawing& drawing) {
  std::vector<AxisBox> boxes;
  for (const Strand& strand : drawing.strands) boxes.push_back(box_of(drawing, strand));
  return boxes;
}

/// Exact on a straight strand; samples, then bisection of the stationarity condition (x - y(t)) . y'(t) = 0, on an arc.
Foot nearest(const Drawing& drawing, const Strand& strand, const Vec2& x) {
  const std::vector<Vec2>& corners = drawing.corners;
  if (!strand.arc) {
    const Vec2 &a = corners[std::size_t(strand.from)], &b = corners[std::size_t(strand.to)];
    return {foot(x, a, b), distance(x, a, b)};
  }
  const Arc& arc = *strand.arc;
  const auto slope = [&](double s) {
    const double t = parameter(arc, s);
    const Vec2 derivative = velocity(arc, t) * (arc.to - arc.from);
    return derivative.dot(at(arc, t) - x);  // of half the squared distance
  };
  Foot best{0, infinity};
  const auto offer = [&](double s) {
    const double distance = (on_strand(corners, strand, s) - x).norm();
    if (distance < best.distance) best = {s, distance};
  };
  offer(0);
  offer(1);
  const double eccentricity = largest_radius(arc) / smallest_radius(arc);
  const int samples = int(std::clamp(64 * std::sqrt(eccentricity), 64.0, 4096.0));
  for (int i = 0; i < samples; ++i) {
    double low = double(i) / samples, high = double(i + 1) / samples;
    if (!(slope(low) <= 0 && slope(high) >= 0)) continue;  // no minimum between them
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      (slope(middle) <= 0 ? low : high) = middle;
    }
    offer((low + high) / 2);
  }
  return best;
}

namespace {

/// `number` counts the outline, then the holes; or `region` counts the regions.
void add_loop(Drawing& drawing, const Loop& loop, Index number, Index region = none) {
  const Index first_corner = Index(drawing.corners.size()), count = Index(loop.sides.size());
  const std::size_t first_strand = drawing.strands.size();
  for (Index i = 0; i < count; ++i) {
    const Side& side = loop.sides[std::size_t(i)];
    drawing.corners.push_back(side.start);
    drawing.strands.push_back({.from = first_corner + i,
                               .to = first_corner + (i + 1) % count,
                               .arc = side.arc,
                               .label = side.label,
                               .loop = number,
                               .crack = none,
                               .region = region,
                               .keep = side.keep,
                               .smooth = side.smooth});
  }
  const bool body_on_left = (signed_area(loop) > 0) == (number <= 0);
  if (body_on_left) return;
  std::reverse(drawing.strands.begin() + Index(first_strand), drawing.strands.end());
  for (auto s = drawing.strands.begin() + Index(first_strand); s != drawing.strands.end(); ++s) {
    std::swap(s->from, s->to);
    if (s->arc) std::swap(s->arc->from, s->arc->to);
  }
}

/// The sides of loops while ends of cracks cut them.
class CutSides {
 public:
  explicit CutSides(Drawing& drawing) : drawing_(drawing), tree_(boxes_of(drawing)) {
    for (const Strand& strand : drawing.strands) turned_.resize(std::size_t(strand.loop) + 1, false);
  }

  /// The corner for the end x of a crack: on the side that it reaches, or a tip of its own.
  Index end_corner(const Vec2& x) {
    const double join = join_tolerance * drawing_.extent;
    Foot best{0, infinity};
    std::size_t side = 0, part = 0;
    // Twice: sides have moved by less than `join` since the tree was made.
    for (const Index k : tree_.meeting(AxisBox{x, x}.grown(2 * join))) {
      const std::span<Strand> parts = parts_of(std::size_t(k));
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const Foot foot = nearest(drawing_, parts[i], x);
        if (foot.distance < best.distance) best = foot, side = std::size_t(k), part = i;
      }
    }
    const Index fresh = Index(drawing_.corners.size());
    if (!(best.distance <= join)) {
      drawing_.corners.push_back(x);
      return fresh;
    }
    // The seam of a whole circle is no corner, unless a crack has ended there.
    Strand& strand = parts_of(side)[part];
    const bool whole = strand.arc && strand.from == strand.to, seam = whole && !turned_[std::size_t(strand.loop)];
    if (!seam)
      for (const Index corner : {strand.from, strand.to})
        if ((drawing_.corners[std::size_t(corner)] - x).norm() <= join) return corner;
    const Vec2 foot = on_strand(drawing_.corners, strand, best.s);
    const Vec2 place = best.distance <= 1e-13 * drawing_.extent ? x : foot;
    if (seam) {  // turned, so that it starts and ends there
      turned_[std::size_t(strand.loop)] = true;
      drawing_.corners[std::size_t(strand.from)] = place;
      const double turn = best.s * (strand.arc->to - strand.arc->from);
      strand.arc->from += turn;
      strand.arc->to += turn;
      return strand.from;
    }
    Strand rest = strand;
    rest.from = strand.to = fresh;
    if (strand.arc) rest.arc->from = strand.arc->to = parameter(*strand.arc, best.s);
    std::vector<Strand>& parts = parts_[side];
    if (parts.empty()) parts.push_back(strand);
    parts.insert(parts.begin() + Index(part) + 1, rest);
    drawing_.corners.push_back(place);
    return fresh;
  }

  /// All of them, in order.
  std::vector<Strand> strands() const {
    std::vector<Strand> all;
    for (std::size_t k = 0; k < drawing_.strands.size(); ++k)
      if (const auto cut = parts_.find(k); cut != parts_.end())
        all.insert(all.end(), cut->second.begin(), cut->second.end());
      else
        all.push_back(drawing_.strands[k]);
    return all;
  }

 private:
  std::span<Strand> parts_of(std::size_t side) {
    const auto cut = parts_.find(side);
    return cut != parts_.end() ? std::span(cut->second) : std::span(&drawing_.strands[side], 1);
  }

  Drawing& drawing_;
  BoxTree tree_;
  std::vector<bool> turned_;                          // whole circles at whose seam a crack ends, per loop
  std::map<std::size_t, std::vector<Strand>> parts_;  // of those that are cut
};

}  // namespace

/// For a side on an arc int x cross dx = cross(center, b - a) + det(axes) (to - from), both from the same origin.
double signed_area(const Loop& loop) {
  double twice = 0;  // the integral of x cross dx
  if (loop.sides.empty()) return 0;
  const Vec2 origin = loop.sides.front().start;
  for (std::size_t i = 0; i < loop.sides.size(); ++i) {
    const Side& side = loop.sides[i];
    const Vec2 a = side.start - origin, b = loop.sides[(i + 1) % loop.sides.size()].start - origin;
    if (side.arc)
      twice += cross(side.arc->center - origin, b - a) + determinant(*side.arc) * (side.arc->to - side.arc->from);
    else
      twice += cross(a, b);
  }
  return twice / 2;
}

bool closed(const Side& side) {
  return side.arc && std::abs(std::abs(side.arc->to - side.arc->from) - 2 * pi) < 1e-9;
}

Vec2 point(const Drawing& drawing, const Strand& strand, double s) {
  return on_strand(drawing.corners, strand, s);
}

Vec2 velocity(const Drawing& drawing, const Strand& strand, double s) {
  if (!strand.arc) return drawing.corners[std::size_t(strand.to)] - drawing.corners[std::size_t(strand.from)];
  const Arc& arc = *strand.arc;
  const double t = parameter(arc, s);
  // Not by way of velocity(arc, t): as one product, which rounds in another way.
  return (arc.to - arc.from) * (arc.axes * Vec2(-std::sin(t), std::cos(t)));
}

double length(const Drawing& drawing, const Strand& strand) {
  if (strand.arc) return length(*strand.arc);
  return (drawing.corners[std::size_t(strand.to)] - drawing.corners[std::size_t(strand.from)]).norm();
}

/// Ends of all cracks come first, as they cut sides: strands of cracks are added once those of loops are final.
Drawing draw(const Shape& shape, Regions regions) {
  Drawing drawing;
  drawing.extent = extent(shape);
  add_loop(drawing, shape.outline, 0);
  for (std::size_t h = 0; h < shape.holes.size(); ++h) add_loop(drawing, shape.holes[h], Index(h) + 1);
  std::vector<std::array<Index, 2>> ends;
  const std::vector<bool> along = along_regions(shape);
  CutSides sides(drawing);
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    const Crack& crack = shape.cracks[c];
    if (along[c]) {
      ends.push_back({none, none});
      continue;
    }
    const Index start = sides.end_corner(crack.points.front());
    ends.push_back({start, sides.end_corner(crack.points.back())});
  }
  drawing.strands = sides.strands();
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    if (along[c]) continue;
    const std::vector<Vec2>& path = shape.cracks[c].points;
    Index from = ends[c][0];
    for (std::size_t i = 1; i < path.size(); ++i) {
      const bool last = i + 1 == path.size();
      const Index to = last ? ends[c][1] : Index(drawing.corners.size());
      if (!last) drawing.corners.push_back(path[i]);
      drawing.strands.push_back(
          {.from = from, .to = to, .arc = shape.cracks[c].arc, .label = none, .loop = none, .crack = Index(c)});
      from = to;
    }
  }
  join_cracks(drawing);
  for (std::size_t r = 0; r < shape.regions.size(); ++r) add_loop(drawing, shape.regions[r], none, Index(r));
  if (regions == Regions::Apart) return drawing;
  if (std::ranges::find(along, true) != along.end() || regions_touch(drawing)) join_regions(drawing, shape, along);
  join_borders(drawing);
  return drawing;
}

bool whole(const Strand& strand) {
  return strand.arc && strand.from == strand.to && std::abs(strand.arc->to - strand.arc->from) > pi;
}
bool is_border(const Strand& strand) {
  return strand.region != none || strand.beyond.has_value();
}

void append_pieces(const Strand& strand, std::vector<StrandCut> cuts, std::vector<Strand>& pieces) {
  std::stable_sort(cuts.begin(), cuts.end(), [](const StrandCut& a, const StrandCut& b) { return a.s < b.s; });
  std::vector<StrandCut> ends = cuts;
  if (!whole(strand) || cuts.empty()) {
    ends.insert(ends.begin(), {0, strand.from});
    ends.push_back({1, strand.to});
  } else {
    ends.push_back({1 + cuts.front().s, cuts.front().corner});
  }
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    Strand piece = strand;
    piece.from = ends[i].corner;
    piece.to = ends[i + 1].corner;
    if (strand.arc) {
      const double turn = strand.arc->to - strand.arc->from;
      piece.arc->from = strand.arc->from + ends[i].s * turn;
      piece.arc->to = strand.arc->from + ends[i + 1].s * turn;
    }
    if (piece.from != piece.to || whole(piece)) pieces.push_back(piece);
  }
}

std::string name(const Shape& shape, const Strand& strand) {
  if (strand.crack != none)
    return fmt::format("{} '{}'", strand.beyond ? "interface" : "crack", shape.cracks[std::size_t(strand.crack)].name);
  if (strand.region != none) return fmt::format("region '{}'", shape.regions[std::size_t(strand.region)].name);
  return strand.loop == 0 ? "the outline" : fmt::format("hole '{}'", shape.holes[std::size_t(strand.loop) - 1].name);
}

Pieces split_evenly(const Drawing& drawing) {
  constexpr double step = 0.09;
  Pieces all{drawing.corners, {}};
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    const Strand& strand = drawing.strands[k];
    const int count = strand.arc ? std::max(3, int(std::ceil(std::abs(strand.arc->to - strand.arc->from) / step))) : 1;
    Index previous = strand.from;
    for (int i = 1; i <= count; ++i) {
      const Index next = i == count ? strand.to : Index(all.points.size());
      if (i < count) all.points.push_back(point(drawing, strand, double(i) / count));
      all.pieces.push_back({previous, next, Index(k), double(i - 1) / count, double(i) / count});
      previous = next;
    }
  }
  return all;
}

}  // namespace kerf
