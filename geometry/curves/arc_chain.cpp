// Chains of circular arcs, two per segment between knots with directions t_0, t_1 [Bolton 1975; theory: K.1, K.2]:
//   d = |v|^2/(v . (t0 + t1) + sqrt((v . (t0 + t1))^2 + 2 (1 - t0 . t1) |v|^2)),   middle = (x0 + x1 + d (t0 - t1))/2,
// and on an arc from a to b that makes the angle alpha with its chord, after the share s of its turn,
//   x(s) = a + sin(s alpha)/sin(alpha) R((s - 1) alpha) (b - a),
// which is smooth in knots and directions, straight lines included. Points with their derivatives by both knots come
// from the same template on numbers with six derivatives (dual.hpp). Places nearest to points, lengths, and arcs for
// shapes. docs/theory/curves.md, "Arcs".

#include "geometry/arc_chain.hpp"

#include "geometry/curves/dual.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double straight = 4e-6;  // half a turn below which an arc is drawn as its chord: off by 1e-6 of its length

template <typename S>
struct Pair {
  S x, y;
};

/// From a to b; the tangents at the ends make `half` with the chord, positive when it turns left.
template <typename S>
struct HalfBiarc {
  Pair<S> a, b;
  S half;
};

/// The biarc whose two arcs have tangents of equal length between the knots (x0, y0, angle0) and (x1, y1, angle1).
template <typename S>
std::array<HalfBiarc<S>, 2> biarc(const std::array<S, 6>& knots) {
  using std::atan2, std::cos, std::sin, std::sqrt;
  const auto& [x0, y0, angle0, x1, y1, angle1] = knots;
  const S c0 = cos(angle0), s0 = sin(angle0), c1 = cos(angle1), s1 = sin(angle1);
  const S vx = x1 - x0, vy = y1 - y0;
  const S squared = vx * vx + vy * vy, along = vx * (c0 + c1) + vy * (s0 + s1);
  const S fold = S(2.0) * (S(1.0) - (c0 * c1 + s0 * s1));
  const S d = squared / (along + sqrt(along * along + fold * squared));
  const Pair<S> middle{(x0 + x1 + d * (c0 - c1)) * S(0.5), (y0 + y1 + d * (s0 - s1)) * S(0.5)};
  const S px = middle.x - x0, py = middle.y - y0, qx = x1 - middle.x, qy = y1 - middle.y;
  return {HalfBiarc<S>{{x0, y0}, middle, atan2(c0 * py - s0 * px, c0 * px + s0 * py)},
          HalfBiarc<S>{middle, {x1, y1}, atan2(qx * s1 - qy * c1, qx * c1 + qy * s1)}};
}

/// sin(part half) / sin(half).
template <typename S>
/// Below 1e-4 by the series to second order, whose error is below rounding; its derivative is right, too.
S chord_share(const S& half, double part) {
  using std::sin;
  const double value = [&] {
    if constexpr (std::is_same_v<S, double>)
      return half;
    else
      return half.value;
  }();
  if (std::abs(value) < 1e-4) return S(part) * (S(1.0) + half * half * S((1 - part * part) / 6));
  return sin(half * S(part)) / sin(half);
}

template <typename S>
Pair<S> on(const HalfBiarc<S>& arc, double part) {
  using std::cos, std::sin;
  const S share = chord_share(arc.half, part), turn = arc.half * S(part - 1);
  const S c = cos(turn), s = sin(turn), x = arc.b.x - arc.a.x, y = arc.b.y - arc.a.y;
  return {arc.a.x + share * (c * x - s * y), arc.a.y + share * (s * x + c * y)};
}

std::array<double, 6> numbers(const ArcChain& chain, std::size_t segment) {
  const Knot &a = chain.knots[segment], &b = chain.knots[(segment + 1) % chain.knots.size()];
  return {a.at.x(), a.at.y(), a.angle, b.at.x(), b.at.y(), b.angle};
}

HalfBiarc<double> arc_of(const ArcChain& chain, std::size_t arc) {
  return biarc(numbers(chain, arc / 2))[arc % 2];
}

Vec2 vec(const Pair<double>& p) {
  return {p.x, p.y};
}

Arc circle_of(const HalfBiarc<double>& arc) {
  const Vec2 a = vec(arc.a), b = vec(arc.b), chord = b - a;
  const double s = 2 * std::sin(arc.half);
  const Vec2 center = 0.5 * (a + b) + std::cos(arc.half) / s * Vec2(-chord.y(), chord.x());
  const double radius = chord.norm() / std::abs(s), from = std::atan2(a.y() - center.y(), a.x() - center.x());
  return {center, radius * Mat2::Identity(), from, from + 2 * arc.half};
}

double length(const HalfBiarc<double>& arc) {
  const double chord = (vec(arc.b) - vec(arc.a)).norm(), h = arc.half;
  return std::abs(h) < 1e-4 ? chord * (1 + h * h / 6) : chord * h / std::sin(h);
}

}  // namespace

std::size_t segment_count(const ArcChain& chain) {
  return chain.knots.size() - (chain.closed ? 0 : 1);
}

/// curvature = 2 sin(half)/chord; the tangent is that of the chord, turned by half (2 part - 1).
ChainPoint point_on(const ArcChain& chain, const ChainPlace& place) {
  const std::array<double, 6> value = numbers(chain, place.arc / 2);
  std::array<Dual, 6> variable;
  for (int k = 0; k < 6; ++k) variable[std::size_t(k)] = Dual::variable(value[std::size_t(k)], k);
  const HalfBiarc<Dual> arc = biarc(variable)[place.arc % 2];
  const Pair<Dual> x = on(arc, place.part);
  ChainPoint p;
  p.at = {x.x.value, x.y.value};
  p.by << x.x.by, x.y.by;
  const Dual cx = arc.b.x - arc.a.x, cy = arc.b.y - arc.a.y, chord = sqrt(cx * cx + cy * cy);
  const Dual curvature = Dual(2) * sin(arc.half) / chord;
  p.curvature = curvature.value;
  p.bends = curvature.by;
  const double turn = arc.half.value * (2 * place.part - 1), c = std::cos(turn), s = std::sin(turn);
  p.tangent = Vec2(c * cx.value - s * cy.value, s * cx.value + c * cy.value) / chord.value;
  p.speed = length(arc_of(chain, place.arc));
  return p;
}

Vec2 at(const ArcChain& chain, const ChainPlace& place) {
  return vec(on(arc_of(chain, place.arc), place.part));
}

namespace {

/// The point of an arc nearest to x, as a share of its turn.
double nearest_part(const HalfBiarc<double>& arc, const Vec2& x) {
  if (std::abs(arc.half) <= 1e-5) return foot(x, vec(arc.a), vec(arc.b));
  const Arc whole = circle_of(arc);
  return std::clamp(0.5 + beyond_middle(whole, x) / (whole.to - whole.from), 0.0, 1.0);
}

struct Nearest {
  ChainPlace place = {};
  double squared = infinity;
  void see(const HalfBiarc<double>& arc, std::size_t number, const Vec2& x) {
    const double part = nearest_part(arc, x), d = (vec(on(arc, part)) - x).squaredNorm();
    if (d < squared) squared = d, place = {number, part};
  }
};

}  // namespace

ChainPlace nearest(const ArcChain& chain, const Vec2& x, std::size_t first, std::size_t last) {
  Nearest best;
  for (std::size_t k = 2 * first; k < 2 * last; ++k) best.see(arc_of(chain, k), k, x);
  return best.place;
}

/// A start within `most` exists, so that arcs whose start is further than that plus their length cannot be nearer.
std::vector<ChainPlace> nearest(const ArcChain& chain, std::span<const Vec2> points) {
  struct Piece {
    HalfBiarc<double> arc;
    Vec2 start;
    double length;
  };
  std::vector<Piece> pieces;
  for (std::size_t segment = 0; segment < segment_count(chain); ++segment)
    for (const HalfBiarc<double>& arc : biarc(numbers(chain, segment)))
      pieces.push_back({arc, vec(arc.a), length(arc)});
  std::vector<ChainPlace> places;
  for (const Vec2& x : points) {
    double most = infinity;  // what the nearest start is away
    for (const Piece& p : pieces) most = std::min(most, (p.start - x).squaredNorm());
    most = (1 + 1e-9) * std::sqrt(most);
    Nearest best;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const double reach = most + pieces[k].length;  // no point of an arc is further from its start than it is long
      if ((pieces[k].start - x).squaredNorm() <= reach * reach) best.see(pieces[k].arc, k, x);
    }
    places.push_back(best.place);
  }
  return places;
}

double length(const ArcChain& chain) {
  double sum = 0;
  for (std::size_t k = 0; k < 2 * segment_count(chain); ++k) sum += length(arc_of(chain, k));
  return sum;
}

double largest_turn(const ArcChain& chain) {
  double most = 0;
  for (std::size_t k = 0; k < 2 * segment_count(chain); ++k)
    most = std::max(most, 2 * std::abs(arc_of(chain, k).half) / pi);
  return most;
}

/// An arc that is nearly straight is drawn as its chord: its circle would have no digits left.
std::vector<Side> sides(const ArcChain& chain, Index label) {
  std::vector<Side> all;
  for (std::size_t k = 0; k < 2 * segment_count(chain); ++k) {
    const HalfBiarc<double> arc = arc_of(chain, k);
    Side side{.start = vec(arc.a), .label = label, .arc = std::nullopt, .keep = false, .smooth = true};
    if (std::abs(arc.half) > straight) side.arc = circle_of(arc);
    all.push_back(std::move(side));
  }
  return all;
}

}  // namespace kerf
