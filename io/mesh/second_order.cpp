// Curves through the nodes of edges of second order. An edge with a node in its middle is bent; edges of the rim, of a
// crack or of a border between materials form chains, and a chain is cut where it turns by more than a smooth curve
// would. Each smooth run of bent edges then gets, in this order,
//   one circle through all nodes,  one ellipse (5 nodes: A x^2 + B x y + C y^2 + D x + E y = 1),
//   circles of two edges and more, ellipses of three and more, as long as their nodes lie on one,
//   for what is left a conic per edge through both ends and the middle with given tangents [theory: E.37],
// the tangents those of the neighbor or of the polynomial of degree 4 through five nodes of both. Nodes lie on a curve
// up to 1e-4 of the least rise of the run's nodes above their chords, or 1e-9 of the extent. Every edge gets an arc (a
// piece of an ellipse) of its own; curves() says which edges share one. docs/theory/elements.md, "Curved triangles".

#include "io/mesh/second_order.hpp"

#include "base/dense.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace kerf {

namespace {

constexpr double least_bend = 1e-6;      // of the length of an edge, from its chord to the node in its middle
constexpr double same_curve = 1e-4;      // of that distance, from a node to the curve of its neighbors
constexpr double nodes_digits = 1e-9;    // of the extent
constexpr double corner = pi / 180;      // smaller turns between edges are those of a smooth curve
constexpr double part_of_turn = 0.25;    // and so are smaller parts of the turn of the edges themselves
constexpr double least_half_turn = .02;  // of the pieces of ellipses that stand for parabolas
constexpr double most_half_turn = pi / 3;

/// An edge in the direction of its chain.
struct Bent {
  Index edge = none;
  Index start = none, end = none;  // vertices
  Vec2 a, middle, b;
  bool bent = false;
  std::optional<Arc> arc = {};
  Index curve = none;
};
using Chain = std::vector<Bent>;

using Direction = std::complex<double>;
Direction direction(const Vec2& v) {
  const Direction d(v.x(), v.y());
  return d / std::abs(d);
}
Vec2 vector(const Direction& d) {
  return {d.real(), d.imag()};
}
/// By how much the second is turned from the first.
double angle_between(const Direction& p, const Direction& q) {
  return std::arg(q * std::conj(p));
}

double rise(const Bent& e) {
  return std::abs(cross(e.b - e.a, e.middle - e.a)) / (e.b - e.a).norm();
}

/// The angle by which the circle through the three nodes turns: its chords from the middle enclose half of it.
double turn_of(const Bent& e) {
  return e.bent ? 2 * angle_between(direction(e.middle - e.a), direction(e.b - e.middle)) : 0;
}

/// The directions of that circle at both ends: between tangent and chord lies half the angle of the chord.
std::array<Direction, 2> end_directions(const Bent& e) {
  const Direction chord = direction(e.b - e.a);
  if (!e.bent) return {chord, chord};
  // Inscribed angles: the tangent at a is turned from a-m by as much as a-b is from m-b; at b likewise.
  const Direction p = direction(e.middle - e.a), q = direction(e.b - e.middle);
  return {p * chord / q, q * chord / p};
}

bool smooth_joint(const Bent& e, const Bent& next) {
  const double turn = std::abs(angle_between(end_directions(e)[1], end_directions(next)[0]));
  return turn < std::max(corner, part_of_turn * (std::abs(turn_of(e)) + std::abs(turn_of(next))) / 2);
}

/// Edges that go on in each other; closed where the last one ends in the start of the first.
std::vector<Chain> chains_of(const Mesh& mesh, const MiddleNodes& nodes) {
  std::map<std::pair<Index, Index>, std::vector<Index>> at;  // of a chain's number and a vertex
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (nodes.chain[e] != none)
      for (const Index v : mesh.edges[e]) at[{nodes.chain[e], v}].push_back(Index(e));
  std::vector<bool> done(mesh.edges.size(), false);
  const auto follow = [&](Index e, Index from) {
    Chain chain;
    while (e != none && !done[std::size_t(e)]) {
      done[std::size_t(e)] = true;
      const auto& [low, high] = mesh.edges[std::size_t(e)];
      const Index to = low == from ? high : low;
      Bent b{e, from, to, mesh.points[std::size_t(from)], nodes.at[std::size_t(e)], mesh.points[std::size_t(to)]};
      b.bent = b.middle.allFinite() && rise(b) > least_bend * (b.b - b.a).norm();
      chain.push_back(b);
      const std::vector<Index>& there = at[{nodes.chain[std::size_t(e)], to}];
      e = there.size() != 2 ? none : there[0] == e ? there[1] : there[0];
      from = to;
    }
    return chain;
  };
  std::vector<Chain> chains;
  for (const auto& [key, edges] : at)
    if (edges.size() != 2)
      for (const Index e : edges)
        if (!done[std::size_t(e)]) chains.push_back(follow(e, key.second));
  for (const auto& [key, edges] : at)
    if (!done[std::size_t(edges.front())]) chains.push_back(follow(edges.front(), key.second));
  return chains;
}

bool is_closed(const Chain& chain) {
  return chain.size() > 1 && chain.back().end == chain.front().start;
}

std::vector<Vec2> nodes_of(std::span<const Bent> run) {
  std::vector<Vec2> nodes{run.front().a};
  for (const Bent& e : run) {
    nodes.push_back(e.middle);
    nodes.push_back(e.b);
  }
  return nodes;
}

double tolerance(std::span<const Bent> run, double extent) {
  double least = infinity;
  for (const Bent& e : run) least = std::min(least, rise(e));
  return std::max(nodes_digits * extent, same_curve * least);
}

std::optional<Vec2> center_through(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 p = b - a, q = c - a;
  const double twice = 2 * cross(p, q);
  if (twice == 0) return std::nullopt;
  const Vec2 from_a(q.y() * p.squaredNorm() - p.y() * q.squaredNorm(),
                    p.x() * q.squaredNorm() - q.x() * p.squaredNorm());
  return a + from_a / twice;
}

/// The circle on which all nodes lie, as an arc without ends.
std::optional<Arc> circle_through(std::span<const Bent> run, double extent) {
  const std::vector<Vec2> x = nodes_of(run);
  const bool whole = (x.back() - x.front()).norm() < (x[1] - x[0]).norm();
  const std::size_t n = whole ? x.size() - 1 : x.size();
  const auto center = whole ? center_through(x[0], x[n / 3], x[2 * n / 3]) : center_through(x[0], x[n / 2], x[n - 1]);
  if (!center) return std::nullopt;
  const double radius = (x[0] - *center).norm(), allowed = tolerance(run, extent);
  for (const Vec2& p : x)
    if (!(std::abs((p - *center).norm() - radius) <= allowed)) return std::nullopt;
  return Arc{*center, radius * Mat2::Identity(), 0, 0};
}

/// The ellipse c + {x : x' M x = 1} as an arc without ends, its semi-axes at right angles; none if M is not positive.
std::optional<Arc> ellipse_of(const Vec2& center, const Mat2& M) {
  const double mean = M.trace() / 2, difference = (M(0, 0) - M(1, 1)) / 2, mixed = M(0, 1);
  const double apart = std::hypot(difference, mixed), low = mean - apart;
  if (!(low > 1e-9 * mean)) return std::nullopt;
  const double t = 0.5 * std::atan2(mixed, difference);
  const Vec2 e(std::cos(t), std::sin(t)), across(-e.y(), e.x());
  // M has the eigenvalues mean +- apart, and a semi-axis is 1/sqrt of its eigenvalue; t turns to the larger eigenvalue.
  Mat2 axes;
  axes << e / std::sqrt(mean + apart), across / std::sqrt(low);
  return Arc{center, axes, 0, 0};
}

/// The ellipse on which all nodes lie, from five of them: A x^2 + B x y + C y^2 + D x + E y = 1 about their mean.
std::optional<Arc> ellipse_through(std::span<const Bent> run, double extent) {
  std::vector<Vec2> x = nodes_of(run);
  if ((x.back() - x.front()).norm() < (x[1] - x[0]).norm()) x.pop_back();
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : x) mean += p / double(x.size());
  double scale = 0;
  for (const Vec2& p : x) scale = std::max(scale, (p - mean).norm());
  const auto row = [&](const Vec2& p) {
    const Vec2 d = (p - mean) / scale;
    return Eigen::RowVectorXd{{d.x() * d.x(), d.x() * d.y(), d.y() * d.y(), d.x(), d.y()}};
  };
  Eigen::MatrixXd rows(5, 5);
  for (std::size_t k = 0; k < 5; ++k) rows.row(Eigen::Index(k)) = row(x[k * (x.size() - 1) / 4]);
  const Eigen::VectorXd q = multiply(inverse(rows), Eigen::VectorXd::Ones(5));
  if (!q.allFinite()) return std::nullopt;
  Mat2 M;
  M << q[0], q[1] / 2, q[1] / 2, q[2];
  const Vec2 linear(q[3], q[4]);
  const double whole = M.determinant();
  if (!(whole > 0)) return std::nullopt;
  const Mat2 cofactor = (Mat2() << M(1, 1), -M(0, 1), -M(1, 0), M(0, 0)).finished();
  const Vec2 center = -0.5 * cofactor * linear / whole;
  const double level = 1 + center.dot(M * center);
  const auto ellipse = ellipse_of(mean + scale * center, M / (level * scale * scale));
  if (!ellipse) return std::nullopt;
  const double allowed = tolerance(run, extent);
  for (const Vec2& p : x)
    if (!((onto(*ellipse, p) - p).norm() <= allowed)) return std::nullopt;
  return ellipse;
}

/// The piece of an ellipse from a to b, the shorter way.
Arc piece_of(Arc whole, const Vec2& a, const Vec2& b) {
  whole.from = parameter(whole, a);
  whole.to = whole.from + std::remainder(parameter(whole, b) - whole.from, 2 * pi);
  return whole;
}

/// The piece of an ellipse from a to b through the middle, in the given directions at its ends: with the corner p of
/// its tangents a conic of weight w, m at l_1^2 = 4 w^2 l_0 l_2 in the triangle a, p, b [theory: E.37]. A parabola or a
/// hyperbola (w >= 1) is met as nearly as an ellipse does it. None where the tangents do not meet between.
std::optional<Arc> conic(const Bent& e, const Direction& from, const Direction& to) {
  const Vec2 s = vector(from), t = vector(to), chord = e.b - e.a;
  const double turn = cross(s, t), ahead = cross(chord, t) / turn, back = cross(s, chord) / turn;
  if (turn == 0 || !(ahead > 0) || !(back > 0)) return std::nullopt;
  const Vec2 p = e.a + ahead * s;
  // Barycentric coordinates of the middle node in the triangle a, p, b: l_1 of p, l_2 of b.
  const double whole = cross(p - e.a, chord), l1 = cross(e.middle - e.a, chord) / whole,
               l2 = cross(p - e.a, e.middle - e.a) / whole, l0 = 1 - l1 - l2;
  const double natural = std::abs(angle_between(from, to)) / 2;
  const double w = l0 > 0 && l1 > 0 && l2 > 0 ? l1 / (2 * std::sqrt(l0 * l2)) : std::cos(natural);
  // For an ellipse w is the cosine of half the angle that the piece turns by in coordinates where it is a circle.
  const double half = std::clamp(w < 1 ? std::acos(w) : 0, least_half_turn, most_half_turn);
  const double c = std::cos(half), sine = std::sin(half);
  const Vec2 middle = 0.5 * (e.a + e.b), x = (p - middle) * c / (sine * sine), y = chord / (2 * sine);
  const Mat2 square = x * x.transpose() + y * y.transpose();  // of the semi-axes
  const double determinant = square.determinant();
  const Mat2 M = (Mat2() << square(1, 1), -square(0, 1), -square(1, 0), square(0, 0)).finished() / determinant;
  const auto ellipse = ellipse_of(middle - c * x, M);
  return ellipse ? std::optional(piece_of(*ellipse, e.a, e.b)) : std::nullopt;
}

/// The direction at x[at] of the polynomial through nodes, over the lengths between them.
Direction slope_at(std::span<const Vec2> x, std::size_t at) {
  std::vector<double> s{0};
  for (std::size_t k = 1; k < x.size(); ++k) s.push_back(s.back() + (x[k] - x[k - 1]).norm());
  Vec2 slope = Vec2::Zero();
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (k == at) continue;
    double by = 1 / (s[k] - s[at]);  // L_k'(s_at) = prod_(j != k, at) (s_at - s_j)/(s_k - s_j) / (s_k - s_at)
    for (std::size_t j = 0; j < x.size(); ++j)
      if (j != k && j != at) by *= (s[at] - s[j]) / (s[k] - s[j]);
    slope += by * (x[k] - x[at]);
  }
  return direction(slope);
}

class Bender {
 public:
  Bender(Mesh& mesh, double extent) : mesh_(mesh), extent_(extent), curve_(mesh.edges.size(), none) {}

  void add(Chain chain) {
    const bool closed = is_closed(chain);
    const std::size_t n = chain.size();
    std::size_t begin = n;
    for (std::size_t i = 0; i < n && begin == n; ++i) {
      const Bent &before = chain[(i + n - 1) % n], &e = chain[i];
      if ((i == 0 && !closed) || before.bent != e.bent || !smooth_joint(before, e)) begin = i;
    }
    const bool loop = begin == n;  // all of one smooth curve
    std::rotate(chain.begin(), chain.begin() + Index(loop ? 0 : begin), chain.end());
    if (loop) {
      if (!chain.front().bent) return;
      const std::size_t end = longest(chain, 0, n, 2, circle_through);
      std::rotate(chain.begin(), chain.begin() + Index(end % n), chain.end());
    }
    for (std::size_t i = 0; i < n;) {
      std::size_t end = i + 1;
      while (end < n && chain[end].bent == chain[i].bent && smooth_joint(chain[end - 1], chain[end])) ++end;
      if (chain[i].bent) find_curves(std::span(chain).subspan(i, end - i));
      i = end;
    }
    join(chain, closed);
    for (const Bent& e : chain) keep(e);
  }

  std::vector<Index> curves() {
    return std::move(curve_);
  }

 private:
  using Fit = std::optional<Arc> (*)(std::span<const Bent> run, double extent);

  /// The end of the longest run from i whose nodes lie on one curve; i if that has less than `least` edges.
  std::size_t longest(std::span<const Bent> run, std::size_t i, std::size_t limit, std::size_t least, Fit fit) const {
    std::size_t end = i + least;
    if (end > limit || !fit(run.subspan(i, least), extent_)) return i;
    while (end < limit && fit(run.subspan(i, end + 1 - i), extent_)) ++end;
    return end;
  }

  void assign(std::span<Bent> run, const Arc& whole, bool round) {
    for (Bent& e : run) {
      e.arc = round ? arc_between(e.a, e.b, whole.center) : piece_of(whole, e.a, e.b);
      e.curve = next_;
    }
    ++next_;
  }

  /// Of a smooth run of bent edges: circles first, then ellipses.
  void find_curves(std::span<Bent> run) {
    if (const auto circle = circle_through(run, extent_)) return assign(run, *circle, true);
    if (run.size() > 2)
      if (const auto ellipse = ellipse_through(run, extent_)) return assign(run, *ellipse, false);
    for (const auto& [fit, least] : {std::pair<Fit, std::size_t>(circle_through, 2), {ellipse_through, 3}})
      for (std::size_t i = 0; i < run.size();) {
        std::size_t limit = i;
        while (limit < run.size() && !run[limit].arc) ++limit;
        const std::size_t end = longest(run, i, limit, least, fit);
        if (end > i) assign(run.subspan(i, end - i), *fit(run.subspan(i, end - i), extent_), fit == &circle_through);
        i = std::max(end, i + 1);
      }
  }

  /// The direction of e at its end (start) that its neighbor there has or both share.
  Direction at_joint(const Bent* before, const Bent& e, const Bent* after, bool start) const {
    const Bent* other = start ? before : after;
    if (other && !(start ? smooth_joint(*other, e) : smooth_joint(e, *other))) other = nullptr;
    if (other && !other->bent) return direction(other->b - other->a);
    if (other && other->arc) {
      const Vec2 v = velocity(*other->arc, start ? other->arc->to : other->arc->from);
      return direction(other->arc->to > other->arc->from ? v : Vec2(-v));
    }
    if (other) {
      const Bent &p = start ? *other : e, &q = start ? e : *other;
      return slope_at(std::array{p.a, p.middle, p.b, q.middle, q.b}, 2);
    }
    const Bent* beyond = start ? after : before;  // one-sided
    if (beyond && beyond->bent && (start ? smooth_joint(e, *beyond) : smooth_joint(*beyond, e)))
      return start ? slope_at(std::array{e.a, e.middle, e.b, beyond->middle, beyond->b}, 0)
                   : slope_at(std::array{beyond->a, beyond->middle, e.a, e.middle, e.b}, 4);
    return end_directions(e)[start ? 0 : 1];
  }

  /// What lies on no circle or ellipse follows its tangents; a chord that stays gives its direction to its neighbors.
  void join(Chain& chain, bool closed) const {
    const std::size_t n = chain.size();
    std::vector<std::optional<Arc>> found(n);
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < n; ++i) {
        Bent& e = chain[i];
        if (!e.bent || e.arc) continue;
        const Bent* before = i > 0 ? &chain[i - 1] : closed ? &chain[n - 1] : nullptr;
        const Bent* after = i + 1 < n ? &chain[i + 1] : closed ? &chain[0] : nullptr;
        found[i] = conic(e, at_joint(before, e, after, true), at_joint(before, e, after, false));
        if (found[i]) continue;
        e.bent = false;
        again = true;
      }
    }
    for (std::size_t i = 0; i < n; ++i)
      if (chain[i].bent && !chain[i].arc) chain[i].arc = found[i];
  }

  void keep(const Bent& e) {
    if (!e.arc) return;
    if (mesh_.arc.empty()) mesh_.arc.assign(mesh_.edges.size(), none);
    mesh_.arc[std::size_t(e.edge)] = Index(mesh_.arcs.size());
    mesh_.arcs.push_back(*e.arc);
    if (mesh_.edges[std::size_t(e.edge)][0] != e.start) std::swap(mesh_.arcs.back().from, mesh_.arcs.back().to);
    curve_[std::size_t(e.edge)] = e.curve != none ? e.curve : next_++;
  }

  Mesh& mesh_;
  double extent_;
  std::vector<Index> curve_;
  Index next_ = 0;
};

}  // namespace

std::vector<Index> bend(Mesh& mesh, const MiddleNodes& nodes, double extent) {
  Bender bender(mesh, extent);
  for (Chain& chain : chains_of(mesh, nodes)) bender.add(std::move(chain));
  return bender.curves();
}

}  // namespace kerf
