// A body whose design sides are chains of arcs [Bolton 1975; theory: K.1, K.2], and the variables that move them. The
// builder traces every run of design sides of the carved polygon, pins it where cracks end, and fits a chain. A knot
// has an angle and a move along its normal; an end slides along the side of the frame it lies on (a rail: a line, or an
// arc with its parameter), or stays where the side bears loads, a crack ends or the frame has a corner. Ends on one
// rail keep a distance. Derivatives by x, y and angle of the two knots of a segment become those by variables in
// `add_by_segment`. The area is exact, as is its derivative -int left . dx ds along the arcs, by five Gauss points
// each. Knots that have come close together or far apart are placed anew at the spacing they began with.
// docs/theory/curves.md, sections "Arcs" and "Variables and the shape residual".

#include "optimize/curves/design_curves.hpp"

#include "geometry/plane.hpp"
#include "optimize/constraints/mirrored.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace kerf {

namespace {

using Eigen::VectorXd;

constexpr double same = 1e-6;  // of the extent: what is nearer is one point

Vec2 left_of(double angle) {
  return {-std::sin(angle), std::cos(angle)};
}

/// The direction in which a knot moves with its first variable.
Vec2 direction(const DesignCurves& d, const KnotHold& hold, const Knot& knot) {
  if (hold.kind == KnotHold::Kind::Free) return left_of(knot.angle);
  const Rail& rail = d.rails[std::size_t(hold.rail)];
  return rail.velocity(rail.at(knot.at)).normalized();
}

/// A knot seen in a mirror, in a chain that runs the other way round. Its left normal is the image of the left normal.
Knot image_of(const Mirror& mirror, const Knot& knot) {
  const double along = std::atan2(mirror.direction.y(), mirror.direction.x());
  return {image_of(mirror, knot.at), 2 * along + pi - knot.angle};
}

double near_turn(double angle, double old) {
  return angle + 2 * pi * std::round((old - angle) / (2 * pi));
}

Knot& knot_of(DesignCurves& d, const KnotRef& ref) {
  return d.chains[std::size_t(ref.chain)].knots[std::size_t(ref.knot)];
}

/// Images where what they are images of is; knots on the line stay on it.
void follow(DesignCurves& d) {
  for (const KnotImage& pair : d.images) {
    Knot& image = knot_of(d, pair.image);
    const Knot there = image_of(*d.mirror, knot_of(d, pair.of));
    const bool fixed =
        d.holds[std::size_t(pair.image.chain)][std::size_t(pair.image.knot)].kind == KnotHold::Kind::Fixed;
    if (pair.of.chain == pair.image.chain && pair.of.knot == pair.image.knot) {
      image.at = 0.5 * (image.at + there.at);
      continue;
    }
    if (!fixed) image.at = there.at;
    image.angle = near_turn(there.angle, image.angle);
  }
}

/// The side of the frame that contains both points, as a rail, and the coordinates of its ends.
struct FrameSide {
  Rail rail;
  double lower, upper;
  std::array<std::size_t, 2> number;  // loop, side
};
// An arc that is a whole ellipse has no ends: its coordinate is not bounded.
std::optional<FrameSide> side_with(const Shape& frame, const Side& side, const Vec2& a, const Vec2& b) {
  const double near = same * extent(frame);
  for (std::size_t l = 0; l <= frame.holes.size(); ++l) {
    const Loop& loop = l == 0 ? frame.outline : frame.holes[l - 1];
    for (std::size_t i = 0; i < loop.sides.size(); ++i) {
      const Side& other = loop.sides[i];
      if (other.label != side.label || other.arc.has_value() != side.arc.has_value()) continue;
      const Vec2 &from = other.start, &to = loop.sides[(i + 1) % loop.sides.size()].start;
      if (!side.arc) {
        if (distance(a, from, to) > near || distance(b, from, to) > near) continue;
        const double length = (to - from).norm();
        return FrameSide{{std::nullopt, from, (to - from) / length}, 0, length, {l, i}};
      }
      const Arc& arc = *other.arc;
      if ((arc.center - side.arc->center).norm() > near || (arc.axes - side.arc->axes).norm() > near) continue;
      FrameSide found{{arc, from, Vec2::UnitX()}, std::min(arc.from, arc.to), std::max(arc.from, arc.to), {l, i}};
      const double ca = found.rail.at(a), cb = found.rail.at(b), slack = near / smallest_radius(arc);
      const bool whole = found.upper - found.lower > 2 * pi - 1e-9;
      if (!whole && (std::min(ca, cb) < found.lower - slack || std::max(ca, cb) > found.upper + slack)) continue;
      if (whole) found.lower = -infinity, found.upper = infinity;
      return found;
    }
  }
  return std::nullopt;
}

bool listed(const std::vector<Index>& labels, Index label) {
  return std::find(labels.begin(), labels.end(), label) != labels.end();
}

/// Ends of cracks, which the chains must go through where they touch them.
std::vector<Vec2> crack_ends(const Shape& shape) {
  std::vector<Vec2> all;
  for (const Crack& crack : shape.cracks) {
    all.push_back(crack.points.front());
    all.push_back(crack.points.back());
  }
  return all;
}

/// The polygon with mouths of cracks among its points, and which those are.
ChainTrace with_mouths(std::vector<Vec2> points, bool closed, const std::vector<Vec2>& ends, double near) {
  ChainTrace trace{std::move(points), closed, {}};
  trace.pinned.assign(trace.points.size(), false);
  for (const Vec2& end : ends) {
    const std::size_t n = trace.points.size();
    for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
      const Vec2 &a = trace.points[i], &b = trace.points[(i + 1) % n];
      if (distance(end, a, b) > near) continue;
      if ((end - a).norm() <= near) {
        trace.pinned[i] = true;
      } else if ((end - b).norm() <= near) {
        trace.pinned[(i + 1) % n] = true;
      } else {
        trace.points.insert(trace.points.begin() + std::ptrdiff_t(i) + 1, end);
        trace.pinned.insert(trace.pinned.begin() + std::ptrdiff_t(i) + 1, true);
      }
      break;
    }
  }
  return trace;
}

// An arc runs evenly in its share: |dx/dpart| is its length.
std::vector<double> segment_lengths(const ArcChain& chain) {
  std::vector<double> all;
  for (std::size_t k = 0; k < segment_count(chain); ++k)
    all.push_back(point_on(chain, {2 * k, 0}).speed + point_on(chain, {2 * k + 1, 0}).speed);
  return all;
}

/// The knot at a length along a chain, from lengths of its segments.
Knot knot_at(const ArcChain& chain, const std::vector<double>& lengths, double s) {
  std::size_t k = 0;
  while (k + 1 < lengths.size() && s > lengths[k]) s -= lengths[k++];
  const double first = point_on(chain, {2 * k, 0}).speed;
  const ChainPlace place =
      s <= first ? ChainPlace{2 * k, s / first} : ChainPlace{2 * k + 1, (s - first) / (lengths[k] - first)};
  const ChainPoint p = point_on(chain, {place.arc, std::min(place.part, 1.0)});
  return {p.at, std::atan2(p.tangent.y(), p.tangent.x())};
}

/// Knots first to last of a chain at the spacing they had, the two where they are; of a closed one `last` may lie
/// beyond the number of knots.
void even_out(ArcChain& chain, const std::vector<double>& rest, std::size_t first, std::size_t last) {
  // Only segments that are out of proportion by more than 2.5 times: every change costs a new mesh.
  constexpr double close = 0.4, far = 2.5;
  const std::size_t n = segment_count(chain), knots = chain.knots.size();
  const std::vector<double> lengths = segment_lengths(chain);
  double before = 0, sum = 0, wanted = 0;
  for (std::size_t k = 0; k < first; ++k) before += lengths[k];
  for (std::size_t k = first; k < last; ++k) sum += lengths[k % n], wanted += rest[k % n];
  double least = infinity, most = 0;
  for (std::size_t k = first; k < last; ++k) {
    const double ratio = lengths[k % n] / rest[k % n] * wanted / sum;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  if (least > close && most < far) return;
  const ArcChain was = chain;
  double s = before, whole = 0;
  for (const double l : lengths) whole += l;
  for (std::size_t k = first + 1; k < last; ++k) {
    s += rest[(k - 1) % n] * sum / wanted;
    Knot knot = knot_at(was, lengths, s < whole ? s : s - whole);
    const double angle = was.knots[k % knots].angle;
    knot.angle += 2 * pi * std::round((angle - knot.angle) / (2 * pi));
    chain.knots[k % knots] = knot;
  }
}

// Traces the loops of the carved shape into chains and sides, holds the ends, and numbers the variables.
class Builder {
 public:
  Builder(const Shape& frame, const Carved& carved, const CurveRules& how) : frame_(frame), how_(how) {
    d_.carved = circular(carved.shape, 1e-3 * how.size);
    d_.label = carved.design_label;
    drop_short_sides(d_.carved.outline);
    for (Loop& hole : d_.carved.holes) drop_short_sides(hole);
    near_ = same * extent(frame);
    ends_ = crack_ends(carved.shape);
  }

  DesignCurves build() {
    add_loop(d_.carved.outline);
    for (const Loop& hole : d_.carved.holes) add_loop(hole);
    if (how_.mirror) pair_chains();
    limit_rails();
    number_variables();
    for (const ArcChain& chain : d_.chains) d_.spacing.push_back(segment_lengths(chain));
    return std::move(d_);
  }

 private:
  /// Ends of chains that lie right beside a corner of the frame go there: what is left of the side in between would be
  /// an edge of the mesh that no step may stretch.
  void drop_short_sides(Loop& loop) const {
    constexpr double shortest = 0.3;  // mesh sizes
    const auto design = [&](const Side& side) { return side.label == d_.label && !side.arc; };
    for (std::size_t i = 0; i < loop.sides.size() && loop.sides.size() > 4;) {
      const std::size_t n = loop.sides.size();
      const Side &side = loop.sides[i], &before = loop.sides[(i + n - 1) % n];
      Side& after = loop.sides[(i + 1) % n];
      const bool joins = design(before) != design(after);
      if (design(side) || !joins || side.arc || side.keep || listed(how_.solid, side.label) ||
          listed(how_.held, side.label) || (after.start - side.start).norm() > shortest * how_.size) {
        ++i;
        continue;
      }
      if (design(after)) after.start = side.start;
      loop.sides.erase(loop.sides.begin() + std::ptrdiff_t(i));
    }
  }

  // Pieces begin at the first design side after another one; a loop of design sides only is a closed chain.
  void add_loop(const Loop& loop) {
    const std::size_t n = loop.sides.size();
    const auto design = [&](std::size_t i) { return loop.sides[i % n].label == d_.label && !loop.sides[i % n].arc; };
    CurveLoop made{loop.name, {}};
    std::size_t first = 0;
    while (first < n && !(design(first) && !design(first + n - 1))) ++first;
    if (first == n) {
      if (design(0))
        made.pieces.push_back({add_chain(loop, 0, n, true)});
      else
        for (const Side& side : loop.sides) made.pieces.push_back({none, side});
      d_.loops.push_back(std::move(made));
      return;
    }
    for (std::size_t i = first; i < first + n;) {
      if (!design(i)) {
        made.pieces.push_back({none, loop.sides[i % n]});
        ++i;
        continue;
      }
      std::size_t end = i;
      while (design(end)) ++end;
      made.pieces.push_back({add_chain(loop, i, end, false)});
      hold_ends(loop, i, end);
      i = end;
    }
    d_.loops.push_back(std::move(made));
  }

  // Knots at mouths of cracks, which the fit keeps among its points, only turn.
  Index add_chain(const Loop& loop, std::size_t begin, std::size_t end, bool closed) {
    const std::size_t n = loop.sides.size();
    std::vector<Vec2> points;
    for (std::size_t i = begin; i < end + (closed ? 0 : 1); ++i) points.push_back(loop.sides[i % n].start);
    const ChainTrace trace = with_mouths(std::move(points), closed, ends_, near_);
    traces_.push_back(trace);
    if (how_.mirror)
      if (const auto half = half_of(trace)) return add_doubled(*half, trace);
    Fitted fitted = fit_arcs(trace, {how_.tolerance, how_.least_spacing});
    std::vector<KnotHold> holds(fitted.chain.knots.size());
    for (std::size_t k = 0; k < holds.size(); ++k)
      if (fitted.point[k] != none) holds[k].kind = KnotHold::Kind::Fixed;
    d_.distance = std::max(d_.distance, fitted.distance);
    d_.chains.push_back(std::move(fitted.chain));
    d_.holds.push_back(std::move(holds));
    return Index(d_.chains.size()) - 1;
  }

  bool is_image(const Vec2& x, const Vec2& y) const {
    return (image_of(*how_.mirror, x) - y).norm() <= near_;
  }

  /// Of a trace that is its own mirror image, run the other way round, the half that ends on the line; of a closed one
  /// it begins there, too.
  std::optional<ChainTrace> half_of(const ChainTrace& trace) const {
    const std::vector<Vec2>& x = trace.points;
    const std::size_t n = x.size();
    const auto take = [&](std::size_t first, std::size_t count) {
      ChainTrace half;
      for (std::size_t i = 0; i < count; ++i) {
        half.points.push_back(x[(first + i) % n]);
        half.pinned.push_back(!trace.pinned.empty() && trace.pinned[(first + i) % n]);
      }
      return half;
    };
    if (!trace.closed) {
      for (std::size_t i = 0; i < n; ++i)
        if (!is_image(x[i], x[n - 1 - i])) return {};
      return n % 2 == 1 && n > 2 ? std::optional(take(0, n / 2 + 1)) : std::nullopt;
    }
    for (std::size_t first = 0; first < n && n % 2 == 0; ++first) {
      bool own = true;
      for (std::size_t i = 0; own && i <= n / 2; ++i) own = is_image(x[(first + i) % n], x[(first + n - i) % n]);
      if (own) return take(first, n / 2 + 1);
    }
    return {};
  }

  /// A half fitted as it goes on beyond the line, which it crosses at a right angle: the ends on the line are knots,
  /// and what is drawn there is as near to the points as anywhere.
  Fitted fit_half(const ChainTrace& half, bool closed) const {
    const std::size_t n = half.points.size(), first = closed ? n - 1 : 0, last = first + n - 1;
    ChainTrace around;
    const auto put = [&](const Vec2& x, bool pinned) {
      around.points.push_back(x);
      around.pinned.push_back(pinned);
    };
    for (std::size_t i = n; closed && i-- > 1;) put(image_of(*how_.mirror, half.points[i]), half.pinned[i]);
    for (std::size_t i = 0; i < n; ++i) put(half.points[i], half.pinned[i] || i + 1 == n || (closed && i == 0));
    for (std::size_t i = n - 1; i-- > 0;) put(image_of(*how_.mirror, half.points[i]), half.pinned[i]);
    Fitted all = fit_arcs(around, {how_.tolerance, how_.least_spacing});
    Fitted part{.chain = {}, .point = {}, .distance = all.distance};
    for (std::size_t k = 0; k < all.point.size(); ++k) {
      const Index at = all.point[k];
      const bool begun = !part.chain.knots.empty() || (at != none && std::size_t(at) == first);
      if (!begun) continue;
      part.chain.knots.push_back(all.chain.knots[k]);
      part.point.push_back(at == none ? none : at - Index(first));
      if (at != none && std::size_t(at) == last) break;
    }
    return part;
  }

  /// A half and its image. On the line the chain runs across it, whatever moves.
  Index add_doubled(const ChainTrace& half, const ChainTrace& whole) {
    const bool closed = whole.closed;
    Fitted fitted = fit_half(half, closed);
    std::vector<Knot>& knots = fitted.chain.knots;
    const std::size_t m = knots.size() - 1, count = closed ? 2 * m : 2 * m + 1;
    const Mirror& mirror = *how_.mirror;
    std::vector<KnotHold> holds(count);
    const auto across = [&](Knot& knot) {
      const Vec2 a(-mirror.direction.y(), mirror.direction.x());
      const double angle = std::atan2(a.y(), a.x()), turned = near_turn(angle, knot.angle),
                   other = near_turn(angle + pi, knot.angle);
      knot.angle = std::abs(turned - knot.angle) < std::abs(other - knot.angle) ? turned : other;
    };
    across(knots[m]);
    if (closed) across(knots[0]);
    for (std::size_t k = 0; k <= m; ++k)
      if (fitted.point[k] != none && half.pinned[std::size_t(fitted.point[k])]) holds[k].kind = KnotHold::Kind::Fixed;
    if (!closed) holds[0].kind = KnotHold::Kind::Fixed;
    const Index chain = Index(d_.chains.size());
    d_.images.push_back({{chain, Index(m)}, {chain, Index(m)}});
    if (closed) d_.images.push_back({{chain, 0}, {chain, 0}});
    for (std::size_t k = m + 1; k < count; ++k) {
      const std::size_t of = 2 * m - k;
      knots.push_back(image_of(mirror, knots[of]));
      holds[k].kind = holds[of].kind;
      d_.images.push_back({{chain, Index(of)}, {chain, Index(k)}});
    }
    if (!closed) knots.back().at = whole.points.back();
    fitted.chain.closed = closed;
    d_.distance = std::max(d_.distance, fitted.distance);
    d_.chains.push_back(std::move(fitted.chain));
    d_.holds.push_back(std::move(holds));
    return chain;
  }

  /// The other chains by twos: the later one becomes the image of the earlier one.
  void pair_chains() {
    d_.mirror = how_.mirror;
    std::vector<bool> done(d_.chains.size(), false);
    for (const KnotImage& pair : d_.images) done[std::size_t(pair.of.chain)] = true;
    for (std::size_t c = 0; c < done.size(); ++c) {
      if (done[c]) continue;
      std::size_t other = c + 1;
      while (other < done.size() && (done[other] || !are_images(traces_[c], traces_[other]))) ++other;
      if (other == done.size())
        throw Error(Fault::Geometry, "the design is not its own mirror image: nothing is its half");
      done[c] = done[other] = true;
      become_image(c, other);
    }
    for (KnotImage& pair : d_.images) {
      KnotHold &of = hold_at(pair.of), &image = hold_at(pair.image);
      // What may not slide on one side of the line may not on the other one.
      if (of.kind != image.kind)
        for (KnotHold* hold : {&of, &image}) *hold = {.kind = KnotHold::Kind::Fixed};
    }
  }

  KnotHold& hold_at(const KnotRef& ref) {
    return d_.holds[std::size_t(ref.chain)][std::size_t(ref.knot)];
  }

  bool are_images(const ChainTrace& a, const ChainTrace& b) const {
    const std::size_t n = a.points.size();
    if (a.closed != b.closed || b.points.size() != n) return false;
    if (!a.closed) return is_image(a.points.front(), b.points.back()) && is_image(a.points.back(), b.points.front());
    for (std::size_t k = 0; k < n; ++k)
      if (is_image(a.points[0], b.points[k])) return is_image(a.points[1], b.points[(k + n - 1) % n]);
    return false;
  }

  void become_image(std::size_t of, std::size_t other) {
    const std::vector<Knot>& knots = d_.chains[of].knots;
    const std::size_t n = knots.size();
    std::vector<KnotHold> holds(n);
    for (std::size_t k = 0; k < n; ++k) holds[n - 1 - k].kind = d_.holds[of][k].kind;
    if (!d_.chains[of].closed) {
      holds.front() = d_.holds[other].front();
      holds.back() = d_.holds[other].back();
    }
    const Knot first = d_.chains[other].knots.front(), last = d_.chains[other].knots.back();
    d_.chains[other].knots.clear();
    for (std::size_t k = n; k-- > 0;) d_.chains[other].knots.push_back(image_of(*how_.mirror, knots[k]));
    if (!d_.chains[of].closed) {
      d_.chains[other].knots.front().at = first.at;
      d_.chains[other].knots.back().at = last.at;
    }
    d_.holds[other] = std::move(holds);
    for (std::size_t k = 0; k < n; ++k) d_.images.push_back({{Index(of), Index(k)}, {Index(other), Index(n - 1 - k)}});
  }

  /// The ends of the last chain, that of sides begin to end, slide where the sides next to them let them.
  void hold_ends(const Loop& loop, std::size_t begin, std::size_t end) {
    const std::size_t n = loop.sides.size();
    const Index chain = Index(d_.chains.size()) - 1;
    const auto start = [&](std::size_t i) -> const Vec2& { return loop.sides[i % n].start; };
    const auto design = [&](std::size_t i) { return loop.sides[i % n].label == d_.label; };
    slide({chain, 0}, loop.sides[(begin + n - 1) % n], {start(begin + n - 1), design(begin + n - 2)}, start(begin));
    slide({chain, Index(d_.chains.back().knots.size()) - 1}, loop.sides[end % n], {start(end + 1), design(end + 1)},
          start(end));
  }

  struct OtherEnd {
    Vec2 at;
    bool moves;  // with another chain
  };

  /// From one end of a side, x, to the other, in the coordinate of its rail: along the arc, which may be most of a
  /// circle.
  double way_along(const Side& side, const Rail& rail, const Vec2& other, const Vec2& x) const {
    if (!side.arc) return rail.at(other) - rail.at(x);
    const double way = side.arc->to - side.arc->from;
    return (x - side.start).norm() <= near_ ? way : -way;
  }

  /// `other`: where the side next to the knot has its other end.
  void slide(const KnotRef& ref, const Side& side, const OtherEnd& other, const Vec2& x) {
    if (listed(how_.solid, side.label) || side.keep) return;
    for (const Vec2& end : ends_)
      if ((end - x).norm() <= near_) return;
    // Sides that carving made are none of the frame's.
    const std::optional<FrameSide> on = side_with(frame_, side, other.at, x);
    if (!on) return;
    const double at = on->rail.at(x), unit = on->rail.velocity(at).norm();
    // At a corner of the frame it may move away from it, along this side.
    const double there = at + way_along(side, on->rail, other.at, x);
    // A side without length leaves no way to slide.
    if (std::abs(there - at) * unit < near_) return;
    KnotHold& hold = d_.holds[std::size_t(ref.chain)][std::size_t(ref.knot)];
    hold.kind = KnotHold::Kind::Slides;
    // A side of the frame is one rail, however many chains end on it.
    const auto known = rails_.find(on->number);
    if (known == rails_.end()) {
      rails_[on->number] = hold.rail = Index(d_.rails.size());
      d_.rails.push_back(on->rail);
    } else {
      hold.rail = known->second;
    }
    hold.lower = on->lower;
    hold.upper = on->upper;
    if (!other.moves) (there < at ? hold.lower : hold.upper) = there;
  }

  struct OnRail {
    double coordinate;
    KnotRef ref;
  };

  /// Ends that share a rail stay apart and on it.
  /// A gap that is smaller than asked for already may stay as it is.
  void limit_rails() {
    for (std::size_t r = 0; r < d_.rails.size(); ++r) {
      std::vector<OnRail> all;
      for (std::size_t c = 0; c < d_.chains.size(); ++c)
        for (std::size_t k = 0; k < d_.holds[c].size(); ++k)
          if (d_.holds[c][k].rail == Index(r))
            all.push_back({d_.rails[r].at(d_.chains[c].knots[k].at), {Index(c), Index(k)}});
      std::sort(all.begin(), all.end(), [](const OnRail& a, const OnRail& b) { return a.coordinate < b.coordinate; });
      // Lengths become coordinates by the rail's speed. Ends stay 3/4 of the gap off the ends of the rail.
      const double least = how_.least_gap / d_.rails[r].velocity(all.front().coordinate).norm();
      for (const OnRail& one : all) {
        KnotHold& hold = d_.holds[std::size_t(one.ref.chain)][std::size_t(one.ref.knot)];
        if (std::isfinite(hold.lower)) hold.lower = std::min(one.coordinate, hold.lower + 0.75 * least);
        if (std::isfinite(hold.upper)) hold.upper = std::max(one.coordinate, hold.upper - 0.75 * least);
      }
      for (std::size_t i = 0; i + 1 < all.size(); ++i)
        d_.apart.push_back({all[i].ref, all[i + 1].ref, std::min(least, all[i + 1].coordinate - all[i].coordinate)});
    }
  }

  // Per knot the move, where it has one, then the angle.
  // Images have those of what they are images of; a knot on the mirror's line does not turn.
  void number_variables() {
    std::map<std::array<Index, 2>, const KnotImage*> image;
    for (const KnotImage& pair : d_.images) image[{pair.image.chain, pair.image.knot}] = &pair;
    for (std::size_t c = 0; c < d_.holds.size(); ++c)
      for (std::size_t k = 0; k < d_.holds[c].size(); ++k) {
        const auto found = image.find({Index(c), Index(k)});
        const bool own =
            found != image.end() && found->second->of.chain == Index(c) && found->second->of.knot == Index(k);
        if (found != image.end() && !own) continue;
        KnotHold& hold = d_.holds[c][k];
        if (hold.kind != KnotHold::Kind::Fixed) hold.offset = Index(d_.variables++);
        if (!own) hold.angle = Index(d_.variables++);
      }
    for (const auto& [at, pair] : image) {
      const KnotHold& of = hold_at(pair->of);
      KnotHold& hold = hold_at(pair->image);
      if (&of == &hold) continue;
      hold.offset = of.offset;
      hold.angle = of.angle;
      hold.angle_sign = -1;
      if (hold.kind != KnotHold::Kind::Slides) continue;
      const Vec2 origin = how_.mirror->point,
                 way = image_of(*how_.mirror, Vec2(origin + direction(d_, of, knot_of(d_, pair->of)))) - origin;
      hold.offset_sign = way.dot(direction(d_, hold, knot_of(d_, pair->image))) > 0 ? 1 : -1;
    }
    follow(d_);
  }

  const Shape& frame_;
  const CurveRules& how_;
  DesignCurves d_;
  double near_ = 0;
  std::vector<Vec2> ends_;
  std::vector<ChainTrace> traces_;  // per chain
  std::map<std::array<std::size_t, 2>, Index> rails_;
};

/// The side of a piece after the piece before it: where that is a chain it begins at its end.
/// Its arc keeps center and axes, so that only its parameters change.
Side side_after(const DesignCurves& d, const CurveLoop& loop, std::size_t i) {
  const std::size_t n = loop.pieces.size();
  Side side = loop.pieces[i].side;
  const auto end_of = [&](std::size_t piece, bool last) -> const Vec2* {
    const Index chain = loop.pieces[piece % n].chain;
    if (chain == none) return nullptr;
    const std::vector<Knot>& knots = d.chains[std::size_t(chain)].knots;
    return last ? &knots.back().at : &knots.front().at;
  };
  const Vec2 *before = end_of(i + n - 1, true), *after = end_of(i + 1, false);
  if (before) side.start = *before;
  if (before || after) side.keep = false;
  if (!side.arc) return side;
  const auto near = [&](const Vec2& x, double old) {
    const double t = parameter(*side.arc, x);
    return t + 2 * pi * std::round((old - t) / (2 * pi));
  };
  if (before) side.arc->from = near(*before, side.arc->from);
  if (after) side.arc->to = near(*after, side.arc->to);
  return side;
}

/// Arcs as they come back from a file with their ends and their center, to the last bit: meshes may depend on it.
void as_read(Loop& loop) {
  const std::size_t n = loop.sides.size();
  if (n == 1) return;
  for (std::size_t i = 0; i < n; ++i) {
    std::optional<Arc>& arc = loop.sides[i].arc;
    const Vec2 &a = loop.sides[i].start, &b = loop.sides[(i + 1) % n].start;
    for (int k = 0; arc && k < 4; ++k) {
      const Arc next = arc_between(a, b, arc->center);
      const bool same = next.center == arc->center;
      arc = next;
      if (same) break;
    }
  }
}

/// Points and weights on [0, 1].
constexpr std::array<std::array<double, 2>, 5> five_points{{{0.046910077030668004, 0.11846344252809454},
                                                            {0.23076534494715845, 0.23931433524968324},
                                                            {0.5, 0.28444444444444444},
                                                            {0.76923465505284155, 0.23931433524968324},
                                                            {0.95308992296933200, 0.11846344252809454}}};

}  // namespace

// Of the parameters of an arc the one nearest to its middle.
double Rail::at(const Vec2& x) const {
  if (!arc) return along.dot(x - from);
  const double t = parameter(*arc, x), middle = (arc->from + arc->to) / 2;
  return t + 2 * pi * std::round((middle - t) / (2 * pi));
}

Vec2 Rail::point(double coordinate) const {
  return arc ? kerf::at(*arc, coordinate) : Vec2(from + coordinate * along);
}

// Of unit length on a straight rail.
Vec2 Rail::velocity(double coordinate) const {
  return arc ? kerf::velocity(*arc, coordinate) : along;
}

DesignCurves design_curves(const Shape& frame, const Carved& carved, const CurveRules& how) {
  return Builder(frame, carved, how).build();
}

// Two arcs per segment in place of what was carved; sides of the frame between chains end where these do.
Shape shape_of(const DesignCurves& d) {
  Shape shape = d.carved;
  for (std::size_t l = 0; l < d.loops.size(); ++l) {
    const CurveLoop& loop = d.loops[l];
    Loop drawn{loop.name, {}};
    for (std::size_t i = 0; i < loop.pieces.size(); ++i) {
      if (loop.pieces[i].chain == none) {
        drawn.sides.push_back(side_after(d, loop, i));
        continue;
      }
      const std::vector<Side> all = sides(d.chains[std::size_t(loop.pieces[i].chain)], d.label);
      drawn.sides.insert(drawn.sides.end(), all.begin(), all.end());
    }
    as_read(drawn);
    (l == 0 ? shape.outline : shape.holes[l - 1]) = std::move(drawn);
  }
  return shape;
}

// The drawn loop has one side per piece of the frame and two per segment before it.
SideEnds side_ends(const DesignCurves& d, const Shape& shape, std::size_t l, std::size_t i) {
  const CurveLoop& loop = d.loops[l];
  const std::size_t n = loop.pieces.size();
  const Loop& drawn = l == 0 ? shape.outline : shape.holes[l - 1];
  std::size_t at = 0;
  for (std::size_t k = 0; k < i; ++k)
    at += loop.pieces[k].chain == none ? 1 : 2 * segment_count(d.chains[std::size_t(loop.pieces[k].chain)]);
  SideEnds ends{drawn.sides[at], drawn.sides[(at + 1) % drawn.sides.size()].start, {}, {}};
  const Index before = loop.pieces[(i + n - 1) % n].chain, after = loop.pieces[(i + 1) % n].chain;
  if (before != none) ends.before = {before, Index(d.chains[std::size_t(before)].knots.size()) - 1};
  if (after != none) ends.after = {after, 0};
  return ends;
}

std::vector<bool> angles_of(const DesignCurves& d) {
  std::vector<bool> turns(std::size_t(d.variables), false);
  for (const auto& chain : d.holds)
    for (const KnotHold& hold : chain) {
      if (hold.angle != none) turns[std::size_t(hold.angle)] = true;
      const bool slides = hold.kind == KnotHold::Kind::Slides;
      if (slides && d.rails[std::size_t(hold.rail)].arc) turns[std::size_t(hold.offset)] = true;
    }
  return turns;
}

// Along normals and rails as they are before the step: a move is linear in the variables but for curved rails.
DesignCurves moved(const DesignCurves& d, const VectorXd& step) {
  DesignCurves next = d;
  for (std::size_t c = 0; c < d.chains.size(); ++c)
    for (std::size_t k = 0; k < d.holds[c].size(); ++k) {
      const KnotHold& hold = d.holds[c][k];
      const Knot& from = d.chains[c].knots[k];
      Knot& knot = next.chains[c].knots[k];
      if (hold.angle != none) knot.angle += hold.angle_sign * step[hold.angle];
      if (hold.kind == KnotHold::Kind::Free) {
        knot.at += hold.offset_sign * step[hold.offset] * left_of(from.angle);
      } else if (hold.kind == KnotHold::Kind::Slides) {
        const Rail& rail = d.rails[std::size_t(hold.rail)];
        const double at = rail.at(from.at);
        knot.at = rail.point(at + hold.offset_sign * step[hold.offset] / rail.velocity(at).norm());
      }
    }
  follow(next);
  return next;
}

// Between knots that do not move freely, which stay.
void even_out(DesignCurves& d) {
  for (std::size_t c = 0; c < d.chains.size(); ++c) {
    std::vector<std::size_t> stay;  // an open chain has its ends among them
    for (std::size_t k = 0; k < d.holds[c].size(); ++k)
      if (d.holds[c][k].kind != KnotHold::Kind::Free || d.holds[c][k].angle == none) stay.push_back(k);
    if (d.chains[c].closed && stay.empty()) stay.push_back(0);
    if (d.chains[c].closed) stay.push_back(stay.front() + d.chains[c].knots.size());
    for (std::size_t i = 0; i + 1 < stay.size(); ++i) even_out(d.chains[c], d.spacing[c], stay[i], stay[i + 1]);
  }
  follow(d);
}

void add_by_segment(const DesignCurves& d, Index chain, std::size_t segment, const Eigen::Matrix<double, 1, 6>& by,
                    VectorXd& sum) {
  const auto c = std::size_t(chain);
  for (std::size_t end = 0; end < 2; ++end) {
    const std::size_t k = (segment + end) % d.chains[c].knots.size();
    const KnotHold& hold = d.holds[c][k];
    // dx/doffset is the unit direction of the hold.
    const auto from = Eigen::Index(3 * end);
    if (hold.offset != none)
      sum[hold.offset] +=
          hold.offset_sign * by.segment<2>(from).dot(direction(d, hold, d.chains[c].knots[k]).transpose());
    if (hold.angle != none) sum[hold.angle] += hold.angle_sign * by[from + 2];
  }
}

VectorXd pack(const DesignCurves& d) {
  std::vector<double> all;
  for (const ArcChain& chain : d.chains)
    for (const Knot& knot : chain.knots) all.insert(all.end(), {knot.at.x(), knot.at.y(), knot.angle});
  return Eigen::Map<const VectorXd>(all.data(), Eigen::Index(all.size()));
}

double area_of(const DesignCurves& d, VectorXd* by) {
  if (by) {
    by->setZero(d.variables);
    for (std::size_t c = 0; c < d.chains.size(); ++c)
      for (std::size_t arc = 0; arc < 2 * segment_count(d.chains[c]); ++arc)
        for (const auto& [part, weight] : five_points) {
          const ChainPoint p = point_on(d.chains[c], {arc, part});
          // dA = -int left . dx ds: what moves into the body takes area from it.
          const Vec2 left(-p.tangent.y(), p.tangent.x());  // into the body
          add_by_segment(d, Index(c), arc / 2, -weight * p.speed * left.transpose() * p.by, *by);
        }
  }
  return area(shape_of(d));
}

// Newton's method: a common normal move changes the area by about its length.
bool offset_to_area(DesignCurves& d, double wanted) {
  VectorXd all = VectorXd::Zero(d.variables), by;
  for (const auto& holds : d.holds)
    for (const KnotHold& hold : holds)
      if (hold.kind == KnotHold::Kind::Free) all[hold.offset] = 1;
  for (int i = 0; i < 8; ++i) {
    const double missing = wanted - area_of(d, &by), rate = by.dot(all);
    if (std::abs(missing) <= 1e-12 * wanted) return true;
    if (!(std::abs(rate) > 0)) return false;
    d = moved(d, missing / rate * all);
  }
  return std::abs(wanted - area_of(d, nullptr)) <= 1e-9 * wanted;
}

}  // namespace kerf
