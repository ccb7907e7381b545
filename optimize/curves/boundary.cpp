// The boundary of a body of curves in samples: how normal moves weigh, a first guess of the second derivative, and the
// clearances that a step keeps. Normal moves are taken at three Gauss points per arc; M_ij = int phi_i phi_j ds is the
// product in which the shape residual is measured [theory: K.3]. The guess of the second derivative over the price of
// area is
//   int 4 v |d/ds| v + (6/w) v^2 ds,   |d/ds| the square root of -d^2/ds^2 on each chain, w the width of the body,
// by the pairs K x = lambda M x: M X sqrt(lambda) X' M [theory: K.4]. Clearances are linear rows, row . step <= room:
// widths of members and gaps along the way between facing samples, distances to what stays solid, regions, cracks and
// the frame, ends on their rails, the turn of the tightest arcs. A distance below its limit may not shrink; what lies
// outside the frame must come back. docs/theory/curves.md, sections "Variables and the shape residual" and "Steps".

#include "optimize/curves/boundary.hpp"

#include "base/dense.hpp"
#include "geometry/plane.hpp"
#include "optimize/constraints/sides.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double undulation = 4;       // of the second derivative per wave number
constexpr double thinning = 6;         // and per width
constexpr double facing = 0.5;         // cosine between a normal and the way across, at least
constexpr double at_the_frame = 0.25;  // of the mesh size: between samples where a corner may come in between
constexpr double of_solid = 0.02;      // of the mesh size: between chains and what stays solid
constexpr double neighborhood = 2.2;   // what is nearer along the boundary than this many distances is no other side

// Gauss points and weights on [0, 1].
constexpr std::array<std::array<double, 2>, 3> three_points{
    {{0.1127016653792583, 5.0 / 18}, {0.5, 8.0 / 18}, {0.8872983346207417, 5.0 / 18}}};

/// A point of the boundary of the body, the body on its left.
struct Sample {
  Vec2 at, left;
  Index loop;
  double s;            // along its loop
  Index chain = none;  // none: fixed
  ChainPlace place = {};
};

struct Samples {
  std::vector<Sample> all;
  std::vector<double> length;  // of the loops
};

// Samples lie in the middles of equal parts of each arc.
void add_chain(const DesignCurves& d, Index c, Index loop, double step, double& s, Samples& out) {
  const ArcChain& chain = d.chains[std::size_t(c)];
  for (std::size_t arc = 0; arc < 2 * segment_count(chain); ++arc) {
    const double l = point_on(chain, {arc, 0.5}).speed;
    const int n = std::max(1, int(std::ceil(l / step)));
    for (int i = 0; i < n; ++i) {
      const ChainPlace place{arc, (i + 0.5) / n};
      const ChainPoint p = point_on(chain, place);
      out.all.push_back({p.at, {-p.tangent.y(), p.tangent.x()}, loop, s + (i + 0.5) * l / n, c, place});
    }
    s += l;
  }
}

// Like those of a chain; on the arc of an ellipse the parts are equal in its parameter, not in length.
void add_side(const Side& side, const Vec2& end, Index loop, double step, double& s, Samples& out) {
  const double l = side.arc ? length(*side.arc) : (end - side.start).norm();
  const int n = std::max(1, int(std::ceil(l / step)));
  for (int i = 0; i < n; ++i) {
    const double part = (i + 0.5) / n;
    Vec2 x = (1 - part) * side.start + part * end, t = end - side.start;
    if (side.arc) {
      const double at = side.arc->from + part * (side.arc->to - side.arc->from);
      x = kerf::at(*side.arc, at);
      t = velocity(*side.arc, at) * (side.arc->to - side.arc->from);
    }
    t.normalize();
    out.all.push_back({x, {-t.y(), t.x()}, loop, s + part * l});
  }
  s += l;
}

// A chain takes two sides of the drawn loop per segment, a side of the frame one.
Samples samples_of(const DesignCurves& d, double step) {
  const Shape shape = shape_of(d);
  Samples out;
  for (std::size_t l = 0; l < d.loops.size(); ++l) {
    const Loop& drawn = l == 0 ? shape.outline : shape.holes[l - 1];
    double s = 0;
    std::size_t side = 0;
    for (const LoopPiece& piece : d.loops[l].pieces) {
      if (piece.chain != none) {
        add_chain(d, piece.chain, Index(l), step, s, out);
        side += 2 * segment_count(d.chains[std::size_t(piece.chain)]);
        continue;
      }
      add_side(drawn.sides[side], drawn.sides[(side + 1) % drawn.sides.size()].start, Index(l), step, s, out);
      ++side;
    }
    out.length.push_back(s);
  }
  return out;
}

// The shorter way around the loop.
double along(const Samples& samples, const Sample& a, const Sample& b) {
  if (a.loop != b.loop) return infinity;
  const double there = std::abs(a.s - b.s);
  return std::min(there, samples.length[std::size_t(a.loop)] - there);
}

/// Samples by square cells.
class Cells {
 public:
  Cells(const Samples& samples, double size) : samples_(samples), size_(size) {
    for (std::size_t i = 0; i < samples.all.size(); ++i) cells_[cell(samples.all[i].at)].push_back(i);
  }

  /// The nearest other side through the body (side 1) or the void (side -1) within a length of at most the cells' size,
  /// or none.
  Index across(std::size_t i, double side, double within) const {
    const Sample& a = samples_.all[i];
    double least = within;
    Index found = none;
    // Cells are as large as the distance looked for, so that the nine around the sample hold all.
    const auto [x, y] = cell(a.at);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        const auto here = cells_.find({x + dx, y + dy});
        if (here == cells_.end()) continue;
        for (const std::size_t j : here->second) {
          const Sample& b = samples_.all[j];
          const Vec2 way = b.at - a.at;
          const double d = way.norm();
          if (!(d < least) || j == i) continue;
          // Both normals face the way across, within 60 degrees; and what is near along the boundary itself is no other
          // side.
          if (side * way.dot(a.left) < facing * d || side * way.dot(b.left) > -facing * d) continue;
          if (along(samples_, a, b) < neighborhood * d) continue;
          least = d;
          found = Index(j);
        }
      }
    return found;
  }

 private:
  std::pair<long, long> cell(const Vec2& x) const {
    return {std::lround(std::floor(x.x() / size_)), std::lround(std::floor(x.y() / size_))};
  }
  const Samples& samples_;
  double size_;
  std::map<std::pair<long, long>, std::vector<std::size_t>> cells_;
};

// The rate of direction . x of the sample by the variables of its chain; fixed samples have none.
VectorXd move_along(const DesignCurves& d, const Sample& s, const Vec2& direction) {
  VectorXd row = VectorXd::Zero(d.variables);
  if (s.chain == none) return row;
  const ChainPoint p = point_on(d.chains[std::size_t(s.chain)], s.place);
  add_by_segment(d, s.chain, s.place.arc / 2, direction.transpose() * p.by, row);
  return row;
}

// A pair that sees each other gives one row.
/// Per third of an arc the least diameter of discs that touch the boundary there and at a side that faces it, through
/// the body (side 1) or the void (-1): the local thickness [theory: L.16].
struct Touching {
  std::size_t from, to;
  double width;
};
std::vector<Touching> touching(const Samples& samples, double side, double within) {
  constexpr double facing_most = -0.5;
  std::map<std::pair<long, long>, std::vector<std::size_t>> cells;
  const auto cell = [&](const Vec2& x) {
    return std::pair{std::lround(std::floor(x.x() / within)), std::lround(std::floor(x.y() / within))};
  };
  for (std::size_t i = 0; i < samples.all.size(); ++i) cells[cell(samples.all[i].at)].push_back(i);
  std::map<std::array<long, 3>, Touching> tightest;
  for (std::size_t i = 0; i < samples.all.size(); ++i) {
    const Sample& a = samples.all[i];
    if (a.chain == none) continue;
    Touching found{i, i, within};
    const auto [x, y] = cell(a.at);
    for (long dx = -1; dx <= 1; ++dx)
      for (long dy = -1; dy <= 1; ++dy) {
        const auto here = cells.find({x + dx, y + dy});
        if (here == cells.end()) continue;
        for (const std::size_t j : here->second) {
          const Sample& b = samples.all[j];
          if (a.left.dot(b.left) > facing_most) continue;
          const Vec2 way = b.at - a.at;
          const double across = side * a.left.dot(way), squared = way.squaredNorm();
          if (!(across > 0) || !(squared < found.width * across)) continue;
          const double distance = std::sqrt(squared);
          if (across < facing * distance || -side * b.left.dot(way) < facing * distance) continue;
          found = {i, j, squared / across};
        }
      }
    if (found.to == i) continue;
    const std::array<long, 3> part{a.chain, long(a.place.arc), std::lround(3 * a.place.part - 0.5)};
    const auto [known, fresh] = tightest.try_emplace(part, found);
    if (!fresh && found.width < known->second.width) known->second = found;
  }
  std::vector<Touching> all;
  for (const auto& [part, pair] : tightest) all.push_back(pair);
  return all;
}

/// Widths that were asked for, as they are measured at the end.
void add_asked_widths(const DesignCurves& d, const Clearances& how, LinearRows& rows) {
  const Samples samples = samples_of(d, how.fine);
  for (const double side : {1.0, -1.0}) {
    const double least = side > 0 ? how.members : how.gaps;
    const bool widen = side > 0 ? how.widen_members : how.widen_gaps;
    for (const Touching& pair : touching(samples, side, least + how.reach)) {
      const Sample &a = samples.all[pair.from], &b = samples.all[pair.to];
      const Vec2 way = (b.at - a.at).normalized();
      rows.add(move_along(d, a, way) - move_along(d, b, way),
               pair.width - (widen ? least : std::min(least, pair.width)));
    }
  }
}

void add_widths(const DesignCurves& d, const Samples& samples, const Clearances& how, LinearRows& rows) {
  if (how.fine > 0) return add_asked_widths(d, how, rows);
  const double within = std::max(how.members, how.gaps) + how.reach;
  const Cells cells(samples, within);
  for (std::size_t i = 0; i < samples.all.size(); ++i) {
    const Sample& a = samples.all[i];
    if (a.chain == none) continue;
    for (const double side : {1.0, -1.0}) {
      const Index j = cells.across(i, side, within);
      if (j == none) continue;
      const Sample& b = samples.all[std::size_t(j)];
      if (b.chain != none && std::size_t(j) < i && cells.across(std::size_t(j), side, within) == Index(i))
        continue;  // said by the other one
      const Vec2 way = b.at - a.at;
      const double distance = way.norm();
      // The width shrinks by n . (move of a - move of b); what is thinner than the least may not get thinner.
      const double least = side > 0 ? how.members : how.gaps;
      if (distance > least + how.reach) continue;
      rows.add(move_along(d, a, way / distance) - move_along(d, b, way / distance),
               distance - std::min(least, distance));
    }
  }
}

struct Line {
  Vec2 a, b;
};

std::vector<Line> lines_of(const Loop& loop, double chord) {
  const Polygon p = flatten(loop, chord, infinity);
  std::vector<Line> lines;
  for (std::size_t i = 0; i < p.points.size(); ++i) lines.push_back({p.points[i], p.points[(i + 1) % p.points.size()]});
  return lines;
}

/// The nearest point of lines within a length, as the way there; zero: none.
Vec2 way_to(const std::vector<Line>& lines, const Vec2& x, double within) {
  Vec2 way = Vec2::Zero();
  for (const Line& line : lines) {
    const double part = foot(x, line.a, line.b);
    const Vec2 there = line.a + part * (line.b - line.a) - x;
    if (const double distance = there.norm(); distance < within && distance > 0) within = distance, way = there;
  }
  return way;
}

/// Distances to lines that nothing may cross.
void keep_off(const DesignCurves& d, const Samples& samples, const std::vector<Line>& lines, double least, double reach,
              LinearRows& rows) {
  for (const Sample& s : samples.all) {
    if (s.chain == none) continue;
    const Vec2 way = way_to(lines, s.at, least + reach);
    if (way.isZero(0)) continue;
    const double nearest = way.norm();
    rows.add(move_along(d, s, way / nearest), nearest - std::min(least, nearest));
  }
}

/// The frame's boundary in lines, and what lies inside.
struct Fence {
  std::vector<std::vector<Vec2>> loops;
  std::vector<Line> lines;
  std::vector<Vec2> corners;  // that point into it
  double near;

  // `flatten` turns all loops counter-clockwise: a corner that points into the body is a right turn of the outline or a
  // left turn of a hole.
  Fence(const Shape& frame, double chord) : near(1e-3 * chord) {
    const auto add = [&](const Loop& loop, double side) {
      loops.push_back(flatten(loop, chord, infinity).points);
      const std::vector<Line> all = lines_of(loop, chord);
      for (std::size_t i = 0; i < all.size(); ++i) {
        const Line &line = all[i], &next = all[(i + 1) % all.size()];
        lines.push_back(line);
        if (side * cross(line.b - line.a, next.b - next.a) < 0) corners.push_back(line.b);
      }
    };
    add(frame.outline, 1);
    for (const Loop& hole : frame.holes) add(hole, -1);
  }
  /// On it, which is inside, too.
  bool touches(const Vec2& x) const {
    return std::ranges::any_of(lines, [&](const Line& line) { return distance(x, line.a, line.b) < near; });
  }
  bool has(const Vec2& x) const {
    if (touches(x)) return true;
    // Even-odd over all loops: inside the outline and in no hole.
    bool in = false;
    for (const std::vector<Vec2>& loop : loops) in = in != inside(loop, x);
    return in;
  }
};

/// The points of chains that are nearest to corners of the frame that point into it and are none of the body.
struct NearCorner {
  Sample sample;
  Vec2 way;     // to the corner
  bool beyond;  // the corner is in the body
};
// Between two samples a corner of the frame may come into the body; samples a twentieth of the mesh size apart see it.
std::vector<NearCorner> near_corners(const DesignCurves& d, const Fence& fence, double size, double within) {
  constexpr double fine = 0.05;
  std::vector<NearCorner> near;
  if (fence.corners.empty()) return near;
  const Samples samples = samples_of(d, fine * size);
  const Shape body = shape_of(d);
  const std::optional<Region> region = d.follow_arcs ? std::optional<Region>(body) : std::nullopt;
  // Corners that are points of the body already need no look.
  const auto starts_at = [&](const Loop& loop, const Vec2& x) {
    return std::ranges::any_of(loop.sides, [&](const Side& side) { return (side.start - x).norm() < 1e-6 * size; });
  };
  for (const Vec2& corner : fence.corners) {
    if (starts_at(body.outline, corner) ||
        std::ranges::any_of(body.holes, [&](const Loop& hole) { return starts_at(hole, corner); }))
      continue;
    if (region && region->away(corner) < 1e-3 * size) continue;
    const Sample* nearest = nullptr;
    double least = within;
    for (const Sample& s : samples.all)
      if (const double away = (corner - s.at).norm(); s.chain != none && away < least) least = away, nearest = &s;
    if (nearest && least > 0)
      near.push_back({*nearest, corner - nearest->at, nearest->left.dot(corner - nearest->at) > 0});
  }
  return near;
}

/// Stays inside, or comes back.
void keep_in(const DesignCurves& d, const Fence& fence, const Clearances& how, LinearRows& rows) {
  const double least = 0.05 * how.size, reach = how.reach;
  // Inside: the move towards the frame leaves `least`. Outside: the move along the way back is the whole way and a bit.
  const auto keep = [&](const Sample& s, const Vec2& way, bool in) {
    const double nearest = way.norm();
    if (in)
      rows.add(move_along(d, s, way / nearest), nearest - std::min(least, nearest));
    else
      rows.add(-move_along(d, s, way / nearest), -nearest - 0.5 * least);
  };
  for (const Sample& s : samples_of(d, at_the_frame * how.size).all) {
    if (s.chain == none) continue;
    if (fence.touches(s.at)) {
      // On the frame itself: only inwards.
      rows.add(move_along(d, s, -s.left), 0);
      continue;
    }
    const bool in = fence.has(s.at);
    const Vec2 way = way_to(fence.lines, s.at, in ? least + reach : infinity);
    if (!way.isZero(0)) keep(s, way, in);
  }
  for (const NearCorner& near : near_corners(d, fence, how.size, least + reach))
    keep(near.sample, near.way, !near.beyond);
}

// The boundary keeps 0.02 mesh sizes off what must stay solid, and half an element off regions and cracks.
/// A point of the border of what stays solid, and the point of a chain nearest to it.
struct Guarded {
  Sample sample;
  Vec2 way;  // to the point
  bool in;   // the point is in the body
};

/// Points at steps along the borders of what stays solid, those inside the frame.
std::vector<Vec2> borders(const Shape& frame, const std::vector<Loop>& solid, double step, double inside) {
  const Region whole(frame);
  std::vector<Vec2> points;
  for (const Loop& loop : solid) {
    std::vector<DrawnSide> sides;
    add_sides(loop, false, sides);
    for (const DrawnSide& side : sides) {
      const int n = std::max(1, int(std::ceil(length(side) / step)));
      for (int k = 0; k < n; ++k)
        if (const Vec2 x = at(side, double(k) / n); whole.depth(x) > inside) points.push_back(x);
    }
  }
  return points;
}

/// Those within a length. Between two of them an arc that meshes can tell bulges by a seventh of the margin.
/// The nearest sample of the chains tells about where the nearest point is.
std::vector<Guarded> guarded(const DesignCurves& d, const Shape& frame, const std::vector<Loop>& solid, double size,
                             double within) {
  constexpr double step = 0.1, coarse = 0.25;
  std::vector<Guarded> near;
  if (solid.empty()) return near;
  const std::vector<Vec2> points = borders(frame, solid, step * size, 1e-6 * size);
  const Samples samples = samples_of(d, coarse * size);
  const double reach = within + coarse * size;
  std::map<std::pair<long, long>, std::vector<const Sample*>> cells;
  const auto cell = [&](const Vec2& x) {
    return std::pair{std::lround(std::floor(x.x() / reach)), std::lround(std::floor(x.y() / reach))};
  };
  for (const Sample& s : samples.all)
    if (s.chain != none) cells[cell(s.at)].push_back(&s);
  const Region body(shape_of(d));
  for (const Vec2& x : points) {
    const Sample* about = nullptr;
    const auto [i, k] = cell(x);
    for (long di = -1; di <= 1; ++di)
      for (long dk = -1; dk <= 1; ++dk)
        if (const auto here = cells.find({i + di, k + dk}); here != cells.end())
          for (const Sample* s : here->second)
            if (!about || (s->at - x).squaredNorm() < (about->at - x).squaredNorm()) about = s;
    if (!about || (about->at - x).norm() > reach) continue;
    const ArcChain& chain = d.chains[std::size_t(about->chain)];
    const std::size_t segment = about->place.arc / 2, n = segment_count(chain);
    ChainPlace place = nearest(chain, x, segment, segment + 1);
    const auto look = [&](std::size_t other) {
      const ChainPlace there = nearest(chain, x, other, other + 1);
      if ((at(chain, there) - x).squaredNorm() < (at(chain, place) - x).squaredNorm()) place = there;
    };
    if (segment + 1 < n || chain.closed) look((segment + 1) % n);
    if (segment > 0 || chain.closed) look((segment + n - 1) % n);
    const ChainPoint p = point_on(chain, place);
    if ((p.at - x).norm() > within) continue;
    near.push_back(
        {{p.at, {-p.tangent.y(), p.tangent.x()}, none, 0, about->chain, place}, x - p.at, body.depth(x) >= 0});
  }
  return near;
}

/// What stays solid stays in the body, or comes back.
void keep_solid(const DesignCurves& d, const Shape& frame, const std::vector<Loop>& solid, const Clearances& how,
                LinearRows& rows) {
  const double least = of_solid * how.size;
  const auto depth = [](const Guarded& g) { return (g.in ? 1 : -1) * g.way.norm(); };
  // A third of an arc has one row, for the point that is least deep: knots are few, and rows that say the same cost.
  std::map<std::array<long, 3>, Guarded> tightest;
  for (const Guarded& g : guarded(d, frame, solid, how.size, least + how.reach)) {
    const std::array<long, 3> part{g.sample.chain, long(g.sample.place.arc),
                                   std::lround(3 * g.sample.place.part - 0.5)};
    const auto [known, fresh] = tightest.try_emplace(part, g);
    if (!fresh && depth(g) < depth(known->second)) known->second = g;
  }
  for (const auto& [part, g] : tightest) {
    const double away = g.way.norm();
    const Vec2 unit = away > 0 ? Vec2(g.way / away) : g.sample.left;
    VectorXd row = move_along(d, g.sample, unit);
    if (row.isZero(0)) continue;
    if (g.in)
      rows.add(std::move(row), away - std::min(least, away));
    else
      rows.add(-row, -away - least);
  }
}

void add_fixed(const DesignCurves& d, const Samples& samples, const Shape& frame, const std::vector<Loop>& frozen,
               const Clearances& how, LinearRows& rows) {
  const double chord = 1e-3 * how.size;
  std::vector<Line> other;
  keep_in(d, Fence(frame, chord), how, rows);
  keep_solid(d, frame, frozen, how, rows);
  for (const Loop& loop : frame.regions)
    for (const Line& line : lines_of(loop, chord)) other.push_back(line);
  for (const Crack& crack : d.carved.cracks) {
    const std::vector<Vec2> path = crack.arc ? points_on(*crack.arc, 32) : crack.points;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) other.push_back({path[i], path[i + 1]});
  }
  keep_off(d, samples, other, 0.5 * how.size, how.reach, rows);
}

// The variable of a sliding end is a length: coordinate differences times |dx/dcoordinate|.
void add_rails(const DesignCurves& d, LinearRows& rows) {
  const auto coordinate = [&](const KnotRef& ref, double& unit) {
    const KnotHold& hold = d.holds[std::size_t(ref.chain)][std::size_t(ref.knot)];
    const Rail& rail = d.rails[std::size_t(hold.rail)];
    const double at = rail.at(d.chains[std::size_t(ref.chain)].knots[std::size_t(ref.knot)].at);
    unit = rail.velocity(at).norm();
    return at;
  };
  for (std::size_t c = 0; c < d.chains.size(); ++c)
    for (std::size_t k = 0; k < d.holds[c].size(); ++k) {
      const KnotHold& hold = d.holds[c][k];
      if (hold.kind != KnotHold::Kind::Slides) continue;
      double unit = 1;
      const double at = coordinate({Index(c), Index(k)}, unit);
      VectorXd row = VectorXd::Zero(d.variables);
      row[hold.offset] = hold.offset_sign;
      if (std::isfinite(hold.upper)) rows.add(row, std::max(0.0, (hold.upper - at) * unit));
      if (std::isfinite(hold.lower)) rows.add(-row, std::max(0.0, (at - hold.lower) * unit));
    }
  for (const RailGap& pair : d.apart) {
    double unit = 1;
    const double a = coordinate(pair.first, unit), b = coordinate(pair.second, unit);
    VectorXd row = VectorXd::Zero(d.variables);
    // (b + s_b) - (a + s_a) >= least, in lengths; on the arc of an ellipse by the unit at the second end.
    const auto add = [&](const KnotRef& ref, double sign) {
      const KnotHold& hold = d.holds[std::size_t(ref.chain)][std::size_t(ref.knot)];
      row[hold.offset] += sign * hold.offset_sign;
    };
    add(pair.first, 1);
    add(pair.second, -1);
    rows.add(std::move(row), std::max(0.0, (b - a - pair.least) * unit));
  }
}

/// Sides of the frame between chains lose at most half of their length in a step and gain no more than it: their
/// vertices share what their ends do.
void add_lengths(const DesignCurves& d, LinearRows& rows) {
  constexpr double loss = 0.5, gain = 1;
  const Shape shape = shape_of(d);
  for (std::size_t l = 0; l < d.loops.size(); ++l)
    for (std::size_t i = 0; i < d.loops[l].pieces.size(); ++i) {
      if (d.loops[l].pieces[i].chain != none) continue;
      const SideEnds ends = side_ends(d, shape, l, i);
      const Vec2 side = ends.end - ends.side.start;
      VectorXd longer = VectorXd::Zero(d.variables);
      const auto add = [&](const KnotRef& ref, const Vec2& outwards) {
        if (ref.chain == none) return;
        const KnotHold& hold = d.holds[std::size_t(ref.chain)][std::size_t(ref.knot)];
        if (hold.kind != KnotHold::Kind::Slides) return;
        const Rail& rail = d.rails[std::size_t(hold.rail)];
        const Vec2 along = rail.velocity(rail.at(d.chains[std::size_t(ref.chain)].knots[std::size_t(ref.knot)].at));
        longer[hold.offset] += along.dot(outwards) > 0 ? hold.offset_sign : -hold.offset_sign;
      };
      add(ends.before, -side);
      add(ends.after, side);
      if (longer.isZero(0)) continue;
      rows.add(longer, gain * side.norm());
      rows.add(-longer, loss * side.norm());
    }
}

/// Chains leave what they end on into the frame.
/// The sine of the angle between the chain and the side must stay above 0.05: a chain that leaves along the frame has
/// no room for a mesh. Holes run the other way round.
void add_leaving(const DesignCurves& d, const Shape& frame, double size, LinearRows& rows) {
  constexpr double least = 0.05;  // sine of the angle to the frame
  std::vector<Line> lines;
  for (std::size_t l = 0; l <= frame.holes.size(); ++l)
    for (const Line& line : lines_of(l == 0 ? frame.outline : frame.holes[l - 1], 1e-3 * size)) {
      lines.push_back(line);
      if (l > 0) std::swap(lines.back().a, lines.back().b);
    }
  for (std::size_t c = 0; c < d.chains.size(); ++c) {
    if (d.chains[c].closed) continue;
    for (const bool last : {false, true}) {
      const std::size_t k = last ? d.chains[c].knots.size() - 1 : 0;
      const Knot& knot = d.chains[c].knots[k];
      double near = 1e-3 * size;
      Vec2 in = Vec2::Zero();
      for (const Line& line : lines)
        if (const double away = distance(knot.at, line.a, line.b); away < near) {
          near = away;
          const Vec2 t = (line.b - line.a).normalized();
          in = {-t.y(), t.x()};
        }
      if (in.isZero(0)) continue;
      const double sign = last ? -1 : 1, c_ = std::cos(knot.angle), s_ = std::sin(knot.angle);
      const double sine = sign * in.dot(Vec2(c_, s_));
      VectorXd row = VectorXd::Zero(d.variables);
      // d sine / d angle, negated: row . step <= sine - least.
      row[d.holds[c][k].angle] = -d.holds[c][k].angle_sign * sign * in.dot(Vec2(-s_, c_));
      rows.add(std::move(row), sine - std::min(least, sine));
    }
  }
}

/// Arcs no tighter than the least radius, those that are by a fifth less tight.
/// Linear in the curvature; only arcs that could become too tight by doubling theirs have a row.
void add_radii(const DesignCurves& d, const Clearances& how, LinearRows& rows) {
  for (std::size_t c = 0; c < d.chains.size(); ++c)
    for (std::size_t arc = 0; arc < 2 * segment_count(d.chains[c]); ++arc) {
      const ChainPoint p = point_on(d.chains[c], {arc, 0.5});
      const double bend = std::abs(p.curvature), room = 1 / how.min_radius - bend;
      if (room > bend) continue;
      VectorXd row = VectorXd::Zero(d.variables);
      add_by_segment(d, Index(c), arc / 2, (p.curvature > 0 ? 1.0 : -1.0) * p.bends, row);
      rows.add(row * how.min_radius, std::max(room, -0.2 * bend) * how.min_radius);
    }
}

}  // namespace

// Three points per arc, by chains and arcs: `too_far` counts on it.
NormalMoves normal_moves(const DesignCurves& d) {
  NormalMoves m;
  std::size_t count = 0;
  for (const ArcChain& chain : d.chains) count += 2 * three_points.size() * segment_count(chain);
  m.by.setZero(Eigen::Index(count), d.variables);
  m.weight.resize(Eigen::Index(count));
  Eigen::Index i = 0;
  VectorXd row(d.variables);
  for (std::size_t c = 0; c < d.chains.size(); ++c)
    for (std::size_t arc = 0; arc < 2 * segment_count(d.chains[c]); ++arc)
      for (const auto& [part, weight] : three_points) {
        const ChainPoint p = point_on(d.chains[c], {arc, part});
        const Vec2 left(-p.tangent.y(), p.tangent.x());
        // v = left . dx, positive into the body.
        row.setZero();
        add_by_segment(d, Index(c), arc / 2, left.transpose() * p.by, row);
        m.by.row(i) = row;
        m.weight[i++] = weight * p.speed;
        m.chain.push_back(Index(c));
        m.at.push_back(p.at);
        m.left.push_back(left);
      }
  m.length = m.weight.sum();
  return m;
}

void steady(MatrixXd& form, const std::vector<bool>& angles, double little) {
  // Lengths and angles have entries of different units: each gets a share of the mean of its own.
  for (const bool kind : {false, true}) {
    std::vector<Eigen::Index> these;
    for (Eigen::Index i = 0; i < form.rows(); ++i)
      if (angles[std::size_t(i)] == kind) these.push_back(i);
    if (these.empty()) continue;
    const double mean = form.diagonal()(these).mean();
    for (const Eigen::Index i : these) form(i, i) += little * mean;
  }
}

namespace {

constexpr double steadier = 1e-6;

}  // namespace

MatrixXd mass(const NormalMoves& m, const DesignCurves& d) {
  MatrixXd M = m.by.transpose() * m.weight.asDiagonal() * m.by;
  steady(M, angles_of(d), steadier);
  return M;
}

// The width is that of the nearest sample, at least half a mesh size and at most ten.
MatrixXd curvature_guess(const NormalMoves& m, const DesignCurves& d, double size) {
  const Samples samples = samples_of(d, 0.75 * size);
  const Eigen::Index n = d.variables;
  MatrixXd guess = MatrixXd::Zero(n, n);
  // Width of the body along the normal at each row: that of the nearest sample.
  VectorXd over_width = VectorXd::Zero(m.by.rows());
  const double wide = 10 * size;
  const Cells cells(samples, wide);
  for (Eigen::Index i = 0; i < m.by.rows(); ++i) {
    double least = infinity;
    std::size_t near = 0;
    for (std::size_t j = 0; j < samples.all.size(); ++j)
      if (const double away = (samples.all[j].at - m.at[std::size_t(i)]).squaredNorm();
          samples.all[j].chain == m.chain[std::size_t(i)] && away < least)
        least = away, near = j;
    const Index other = cells.across(near, 1, wide);
    const double width = other == none ? wide : (samples.all[std::size_t(other)].at - samples.all[near].at).norm();
    over_width[i] = thinning / std::max(width, 0.5 * size);
  }
  const std::vector<bool> angles = angles_of(d);
  guess += m.by.transpose() * (m.weight.cwiseProduct(over_width)).asDiagonal() * m.by;
  for (std::size_t c = 0; c < d.chains.size(); ++c) {
    // The square root is taken chain by chain.
    std::vector<Eigen::Index> mine;
    for (const KnotHold& hold : d.holds[c])
      for (const Index variable : {hold.offset, hold.angle})
        if (variable != none && std::ranges::find(mine, Eigen::Index(variable)) == mine.end()) mine.push_back(variable);
    std::vector<bool> turns;
    for (const Eigen::Index variable : mine) turns.push_back(angles[std::size_t(variable)]);
    std::vector<Eigen::Index> at;
    for (Eigen::Index i = 0; i < m.by.rows(); ++i)
      if (m.chain[std::size_t(i)] == Index(c)) at.push_back(i);
    // d/ds| from the pairs K x = lambda M x of the chain, K = int v'w' ds by differences between Gauss points.
    const MatrixXd V = m.by(at, mine);
    const VectorXd w = m.weight(at);
    MatrixXd M = transposed_multiply(w.asDiagonal() * V, V), K = MatrixXd::Zero(M.rows(), M.cols());
    steady(M, turns, steadier);
    const Eigen::Index rows = V.rows();
    for (Eigen::Index i = 0; i < (d.chains[c].closed ? rows : rows - 1); ++i) {
      const Eigen::Index j = (i + 1) % rows;
      const VectorXd jump = V.row(j) - V.row(i);
      K.selfadjointView<Eigen::Lower>().rankUpdate(
          jump, 1 / (m.at[std::size_t(at[std::size_t(i)])] - m.at[std::size_t(at[std::size_t(j)])]).norm());
    }
    const auto [values, vectors] = eigenpairs(K, M);
    const MatrixXd MV = multiply(M, vectors);
    // M X sqrt(lambda) X' M is the form F with F M^-1 F = K.
    guess(mine, mine) += multiply_transposed(undulation * MV * values.cwiseMax(0).cwiseSqrt().asDiagonal(), MV);
  }
  return guess;
}

// At samples and at the corners of the frame between them. Solid parts count half a margin around them, so that what is
// left of them at the end is nothing.
double overhang(const DesignCurves& d, const Shape& frame, const std::vector<Loop>& solid, double size) {
  const Fence fence(frame, 1e-3 * size);
  double most = 0;
  for (const Sample& s : samples_of(d, at_the_frame * size).all)
    if (s.chain != none && !fence.has(s.at)) most = std::max(most, way_to(fence.lines, s.at, infinity).norm());
  for (const NearCorner& near : near_corners(d, fence, size, 2 * size))
    if (near.beyond) most = std::max(most, near.way.norm());
  for (const Guarded& g : guarded(d, frame, solid, size, 2 * size))
    most = std::max(most, 0.5 * of_solid * size - (g.in ? 1 : -1) * g.way.norm());
  return most;
}

LinearRows clearance_rows(const DesignCurves& d, const Shape& frame, const std::vector<Loop>& frozen,
                          const Clearances& how) {
  LinearRows rows;
  // Widths and distances are seen at steps of half an element.
  const Samples samples = samples_of(d, 0.5 * how.size);
  add_widths(d, samples, how, rows);
  add_fixed(d, samples, frame, frozen, how, rows);
  add_rails(d, rows);
  add_lengths(d, rows);
  add_leaving(d, frame, how.size, rows);
  if (how.min_radius > 0) add_radii(d, how, rows);
  return rows;
}

}  // namespace kerf
