// Encloses an expression, given as a syntax tree, on a piece of an edge or over a box. On a piece, s from `from` to
// `to`, every node gets Taylor coefficients that hold f^(k)/k! all along it, k <= 8 [theory: D.1; Moore 1966]; the one
// of k = 8 bounds what a polynomial of degree 7 leaves out [theory: D.2]. Over a box there is the range alone.
// The place along a curved edge is a polynomial of degree 4,
//   x(s) = a + s (b - a) + s (1 - s) (q_0 + q_1 s + q_2 s^2),
// whose derivative gives the normal and |dx/ds|. Where f is not smooth on the piece, enclose() offers instead
//   cut:   a place where an argument g of abs, min, a comparison, ... passes its level, by bisection; g' has one sign,
//   power: f = a + b d^alpha, d the distance from the end where the base of one power vanishes linearly,
// or the range alone, upon which the caller halves the piece. Of c ? a : b only a branch that may be taken is
// evaluated, since the other one need not have a value there. docs/theory/data.md, "Enclosures" and "Edges".

#include "io/case/decided.hpp"
#include "io/case/functions.hpp"
#include "io/case/node_order.hpp"
#include "io/case/syntax.hpp"

#include <optional>

namespace kerf {

namespace {

using Kind = SyntaxNode::Kind;

/// Values of the variables.
struct Variables {
  std::array<Taylor, 4> of;
  int order;
  Taylor stretch = {};  // along a curved edge |dx/ds| over the length of the chord
};

/// The ranges of a box; where a normal is asked for, the whole line.
Variables on_box(const Interval& x, const Interval& y) {
  const TaylorArithmetic with(0);
  return {.of = {with.constant(x), with.constant(y), with.range(whole_line), with.range(whole_line)}, .order = 0};
}

/// The coefficients of x(s) - a, from s on.
std::array<std::array<Interval, 5>, 2> powers_of(const EdgeLine& edge) {
  std::array<std::array<Interval, 5>, 2> p;
  for (int d = 0; d < 2; ++d) {
    const Interval side = edge.b[d] == edge.a[d] ? exactly(0) : widened(edge.b[d] - edge.a[d], edge.b[d] - edge.a[d]);
    const auto q = [&](int k) { return exactly(edge.curvature[static_cast<std::size_t>(k)][d]); };
    p[static_cast<std::size_t>(d)] = {exactly(0), side + q(0), q(1) - q(0), q(2) - q(1), -q(2)};
  }
  return p;
}

/// The place along a curved edge, the unit normal of the curve, and |dx/ds| over the length of the chord.
struct OnCurve {
  std::array<Taylor, 2> x, n;
  Taylor stretch;
};
OnCurve on_curve(const EdgeLine& edge, double from, double to, int order) {
  // x(s + t) = sum_i p_i (s + t)^i: the coefficient of t^k is sum_i binomial(i, k) p_i s^(i-k), by Horner in s.
  static constexpr std::array<std::array<double, 5>, 5> binomial{
      {{1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}}};
  const TaylorArithmetic with(order);
  const auto powers = powers_of(edge);
  const Interval s{from, to};
  OnCurve c;
  std::array<Taylor, 2> slope;
  for (std::size_t d = 0; d < 2; ++d) {
    c.x[d] = slope[d] = with.constant(exactly(0));
    for (std::size_t k = 0; k < 5; ++k) {  // of the power k of t in x(s + t)
      Interval sum = exactly(0);
      for (std::size_t i = 4; i > k; --i) sum = (sum + exactly(binomial[i][k]) * powers[d][i]) * s;
      sum = sum + (k == 0 ? exactly(edge.a[static_cast<int>(d)]) : powers[d][k]);
      if (static_cast<int>(k) <= order) c.x[d].c[k] = sum;
      if (k > 0 && static_cast<int>(k) - 1 <= order) slope[d].c[k - 1] = exactly(static_cast<double>(k)) * sum;
    }
  }
  const Taylor speed = with.square_root(with.add(with.square(slope[0]), with.square(slope[1])));
  const Vec2 chord = edge.b - edge.a;
  const double side = cross(chord, edge.n) > 0 ? -1 : 1;  // the normal is on this side of (y', -x')
  c.n[0] = with.divide(with.multiply(with.constant(exactly(side)), slope[1]), speed);
  c.n[1] = with.divide(with.multiply(with.constant(exactly(-side)), slope[0]), speed);
  const double length = chord.norm();
  c.stretch = with.divide(speed, with.constant(widened(length, length, library_ulps)));
  return c;
}

Variables on_piece(const EdgeLine& edge, double from, double to, int order) {
  Variables v{.order = order};
  const TaylorArithmetic with(order);
  if (!edge.is_straight()) {
    const OnCurve c = on_curve(edge, from, to, order);
    v.of = {c.x[0], c.x[1], c.n[0], c.n[1]};
    v.stretch = c.stretch;
    return v;
  }
  for (int d = 0; d < 2; ++d) {
    const double step = edge.b[d] - edge.a[d];
    const Interval side = step == 0 ? exactly(0) : widened(step, step);
    // Exact at both ends.
    const auto at = [&](double s) {
      return s == 0 ? exactly(edge.a[d]) : s == 1 ? exactly(edge.b[d]) : exactly(edge.a[d]) + exactly(s) * side;
    };
    v.of[d] = with.constant(hull(at(from), at(to)));
    if (order > 0) v.of[d].c[1] = side;
    v.of[2 + d] = with.constant(exactly(edge.n[d]));
  }
  return v;
}

/// Why something is not smooth: a node that may be `level` there.
struct Undecided {
  int node;
  double level;
};

/// A tree on one piece or box. Every node is evaluated at most once, after those that it needs, and only where it is
/// needed.
class Evaluation {
 public:
  Evaluation(const Syntax& syntax, const Variables& variables)
      : syntax_(syntax),
        variables_(variables),
        with_(variables.order),
        value_(syntax.nodes.size()),
        known_(syntax.nodes.size(), false) {}
  /// On a piece, with its two ends for functions that are monotone there.
  Evaluation(const Syntax& syntax, const Variables& variables, Evaluation& low, Evaluation& high)
      : Evaluation(syntax, variables) {
    ends_ = {&low, &high};
  }

  const Taylor& root() {
    return at(static_cast<int>(syntax_.nodes.size()) - 1);
  }
  const Taylor& at(int node) {
    if (!known_[node])
      evaluate_in_order(
          node, [&](int k) { return bool(known_[k]); }, [&](int k, std::vector<int>& wanted) { append(k, wanted); },
          [&](int k) {
            value_[k] = evaluate(k);
            known_[k] = true;
          });
    return value_[node];
  }
  /// As `at`, the range sharpened by the values at the ends where the node is monotone.
  const Taylor& sharp(int node) {
    at(node);
    Taylor& t = value_[node];
    if (variables_.order > 0 && ends_[0] && is_monotone(t))
      t.c[0] = common(t.c[0], hull(ends_[0]->at(node).c[0], ends_[1]->at(node).c[0]));
    return t;
  }
  bool is_monotone(const Taylor& t) const {
    return t.c[1].low >= 0 || t.c[1].high <= 0;
  }

  std::vector<Undecided> undecided;
  std::vector<int> singular;  // power nodes whose base touches 0
  const TaylorArithmetic& arithmetic() const {
    return with_;
  }

 private:
  /// What a node needs still; of min and max the test, then the one or ones that may be taken.
  void append(int node, std::vector<int>& wanted) const {
    const SyntaxNode& n = syntax_.nodes[node];
    const auto known = [&](int k) { return bool(known_[k]); };
    const auto range = [&](int k) -> const Interval& { return value_[k].c[0]; };
    const Breaking kind = n.kind == Kind::Call ? breaking(n.argument) : Breaking::No;
    if (kind != Breaking::Min && kind != Breaking::Max) return append_needed(n, known, range, wanted);
    const int test = n.of.back();
    if (!known(test)) return wanted.push_back(test);
    const bool least = kind == Breaking::Min;
    const Interval& c = range(test);
    if (!(c.high <= 0) && !known(n.of[least ? 1 : 0])) wanted.push_back(n.of[least ? 1 : 0]);
    if (!(c.low >= 0) && !known(n.of[least ? 0 : 1])) wanted.push_back(n.of[least ? 0 : 1]);
  }

  /// Of a node whose needs are known.
  Taylor evaluate(int node) {
    const SyntaxNode& n = syntax_.nodes[node];
    const auto of = [&](int k) -> const Taylor& { return at(n.of[k]); };
    switch (n.kind) {
      case Kind::Constant:
        return with_.constant(exactly(n.value));
      case Kind::Variable:
        return variables_.of[n.argument];
      case Kind::Negate:
        return with_.negate(of(0));
      case Kind::Add:
        return with_.add(of(0), of(1));
      case Kind::Subtract:
        return with_.subtract(of(0), of(1));
      case Kind::Multiply:
        return n.of[0] == n.of[1] ? with_.square(of(0)) : with_.multiply(of(0), of(1));
      case Kind::Divide:
        return with_.divide(of(0), sharp(n.of[1]));
      case Kind::Power:
        return power(node, n);
      case Kind::And:
      case Kind::Or:
        return connective(n);
      case Kind::Choice:
        return choice(n);
      case Kind::Call:
        return call(n);
      default:
        return comparison(n);
    }
  }

  Taylor power(int node, const SyntaxNode& n) {
    const Taylor exponent = at(n.of[1]);
    const double p = exponent.c[0].low;
    if (!is(exponent.c[0], p) || !is_constant(exponent))
      return with_.exponential(with_.multiply(exponent, with_.logarithm(sharp(n.of[0]))));
    if (is_product(p)) {
      const Taylor& base = p < 0 ? sharp(n.of[0]) : at(n.of[0]);
      return with_.power(base, static_cast<int>(p));
    }
    const Taylor& base = sharp(n.of[0]);
    // From a place where the base vanishes on, up to rounding: derivatives say nothing.
    constexpr double vanishing = 1e-10;
    if (base.c[0].low > vanishing * base.c[0].high) return with_.power(base, p);
    singular.push_back(node);
    return with_.range(kerf::power(base.c[0], p));
  }
  bool is_constant(const Taylor& t) const {
    for (int k = 1; k <= variables_.order; ++k)
      if (!is(t.c[k], 0)) return false;
    return true;
  }

  Taylor open(int node, double level, const Interval& range) {
    undecided.push_back({node, level});
    return with_.range(range);
  }

  Taylor comparison(const SyntaxNode& n) {
    const std::optional<bool> known = decided(n.kind, sharp(n.of[0]).c[0]);
    if (known) return with_.constant(exactly(*known ? 1 : 0));
    return open(n.of[0], 0, {0, 1});
  }

  Taylor connective(const SyntaxNode& n) {
    const Truth both = connected(n.kind == Kind::And, truth(at(n.of[0]).c[0]), [&] { return truth(at(n.of[1]).c[0]); });
    return both == Truth::Open ? with_.range({0, 1}) : with_.constant(exactly(both == Truth::Yes ? 1 : 0));
  }

  Taylor choice(const SyntaxNode& n) {
    const Truth condition = truth(at(n.of[0]).c[0]);
    if (condition != Truth::Open) return at(n.of[condition == Truth::Yes ? 1 : 2]);
    const Interval yes = at(n.of[1]).c[0], no = at(n.of[2]).c[0];
    return with_.range(hull(yes, no));
  }

  /// atan2 turns over where its first argument passes 0 and the second one is negative.
  Taylor angle(const SyntaxNode& n) {
    const Taylor &y = sharp(n.of[0]), &x = sharp(n.of[1]);
    if (x.c[0].low > 0 || !contains(y.c[0], 0)) return with_.arc_tangent(y, x);
    if (is(y.c[0], 0) && is_constant(y) && x.c[0].high < 0) return with_.constant(widened(pi, pi));
    return open(n.of[0], 0, {-above(pi), above(pi)});
  }

  Taylor call(const SyntaxNode& n) {
    const Breaking kind = breaking(n.argument);
    if (kind == Breaking::No) {
      std::vector<Taylor> arguments;
      for (const int k : n.of) arguments.push_back(sharp(k));
      return kerf::evaluate(n.argument, arguments, with_);
    }
    if (kind == Breaking::Angle) return angle(n);
    const int test = n.of.back();
    const Taylor g = sharp(test);
    const Interval& c = g.c[0];
    switch (kind) {
      case Breaking::Abs:
        if (c.low >= 0) return g;
        if (c.high <= 0) return with_.negate(g);
        return open(test, 0, absolute(c));
      case Breaking::Sign:
        if (c.low > 0 || c.high < 0) return with_.constant(exactly(c.low > 0 ? 1 : -1));
        if (is(c, 0)) return with_.constant(exactly(0));
        return open(test, 0, {c.low < 0 ? -1.0 : 0.0, c.high > 0 ? 1.0 : 0.0});
      case Breaking::Rint: {
        if (!is_bounded(c)) return with_.range(whole_line);
        const double low = std::rint(c.low), high = std::rint(c.high);
        if (low == high) return with_.constant(exactly(low));
        return open(test, low + 0.5, {low, high});
      }
      default: {  // min and max
        const bool least = kind == Breaking::Min;
        if (c.high <= 0) return at(n.of[least ? 0 : 1]);
        if (c.low >= 0) return at(n.of[least ? 1 : 0]);
        const Interval a = at(n.of[0]).c[0], b = at(n.of[1]).c[0];
        return open(test, 0,
                    least ? Interval{std::min(a.low, b.low), std::min(a.high, b.high)}
                          : Interval{std::max(a.low, b.low), std::max(a.high, b.high)});
      }
    }
  }

  const Syntax& syntax_;
  const Variables& variables_;
  TaylorArithmetic with_;
  std::array<Evaluation*, 2> ends_{};
  std::vector<Taylor> value_;
  std::vector<bool> known_;
};

/// The range of one node at a point of an edge.
Interval at_point(const Syntax& syntax, const EdgeLine& edge, double s, int node) {
  const Variables here = on_piece(edge, s, s, 0);
  return Evaluation(syntax, here).at(node).c[0];
}

/// Where a monotone node passes its level: it is on one side of it up to `low` and on the other from `high` on.
std::optional<Interval> passage(const Syntax& syntax, const EdgeLine& edge, double from, double to,
                                const Undecided& what) {
  const auto side = [&](double s) {
    const Interval v = at_point(syntax, edge, s, what.node);
    return v.low > what.level ? 1 : v.high < what.level ? -1 : 0;
  };
  const int before = side(from), after = side(to);
  if (before == after) return std::nullopt;
  // The distance of the numbers just below 1.
  constexpr double finest = 0x1p-53;
  // The last place of a run of `sign` that begins at `inside`, towards `outside`.
  const auto reach = [&](double inside, double outside, int sign) {
    while (std::abs(outside - inside) > finest) {
      const double mid = 0.5 * (inside + outside);
      if (mid == inside || mid == outside) break;
      (side(mid) == sign ? inside : outside) = mid;
    }
    return inside;
  };
  const Interval cut{before == 0 ? from : reach(from, to, before), after == 0 ? to : reach(to, from, after)};
  if (cut.low == from && cut.high == to) return std::nullopt;
  return cut;
}

/// f = a + b P for the values P of one node.
struct Halves {
  Taylor a;
  std::optional<Taylor> b;
};

/// Takes the tree apart along that node; nothing where f is not of this form.
class Parting {
 public:
  Parting(const Syntax& syntax, Evaluation& values, int node) : syntax_(syntax), values_(values), node_(node) {
    needs_.assign(syntax.nodes.size(), false);
    needs_[node] = true;
    for (std::size_t k = static_cast<std::size_t>(node) + 1; k < needs_.size(); ++k)
      for (const int of : syntax.nodes[k].of) needs_[k] = needs_[k] || needs_[of];
    done_.resize(syntax.nodes.size());
  }
  std::optional<Halves> root() {
    return of(static_cast<int>(syntax_.nodes.size()) - 1);
  }

 private:
  std::optional<Halves> of(int k) {
    if (!needs_[k]) return Halves{values_.at(k), std::nullopt};
    const TaylorArithmetic& with = values_.arithmetic();
    if (k == node_) return Halves{with.constant(exactly(0)), with.constant(exactly(1))};
    if (!done_[k])
      evaluate_in_order(
          k, [&](int j) { return !needs_[j] || j == node_ || done_[j].has_value(); },
          [&](int j, std::vector<int>& wanted) { append(syntax_.nodes[j], wanted); },
          [&](int j) { done_[j] = combine(syntax_.nodes[j]); });
    return *done_[k];
  }
  /// What combine() asks for; of a choice the branch that is taken.
  void append(const SyntaxNode& n, std::vector<int>& wanted) {
    const auto want = [&](int k) {
      if (needs_[k] && k != node_ && !done_[k]) wanted.push_back(k);
    };
    if (n.kind == Kind::Choice) {
      if (needs_[n.of[0]]) return;
      const Truth condition = truth(values_.at(n.of[0]).c[0]);
      if (condition != Truth::Open) want(n.of[condition == Truth::Yes ? 1 : 2]);
      return;
    }
    for (std::size_t k = n.of.size(); k-- > 0;) want(n.of[k]);
  }
  std::optional<Halves> combine(const SyntaxNode& n) {
    const TaylorArithmetic& with = values_.arithmetic();
    if (n.kind == Kind::Choice) {
      if (needs_[n.of[0]]) return std::nullopt;
      const Truth condition = truth(values_.at(n.of[0]).c[0]);
      if (condition == Truth::Open) return std::nullopt;
      return of(n.of[condition == Truth::Yes ? 1 : 2]);
    }
    std::vector<Halves> parts;
    for (const int k : n.of) {
      const std::optional<Halves> part = of(k);
      if (!part) return std::nullopt;
      parts.push_back(*part);
    }
    const auto both = [&](auto&& operation) {
      Halves h{operation(parts[0].a), std::nullopt};
      if (parts[0].b) h.b = operation(*parts[0].b);
      return h;
    };
    switch (n.kind) {
      case Kind::Negate:
        return both([&](const Taylor& t) { return with.negate(t); });
      case Kind::Add:
        return added(parts[0], parts[1]);
      case Kind::Subtract: {
        Halves minus{with.negate(parts[1].a), std::nullopt};
        if (parts[1].b) minus.b = with.negate(*parts[1].b);
        return added(parts[0], minus);
      }
      case Kind::Multiply:
        if (parts[0].b && parts[1].b) return std::nullopt;
        if (parts[1].b) std::swap(parts[0], parts[1]);
        return both([&](const Taylor& t) { return with.multiply(t, parts[1].a); });
      case Kind::Divide:
        if (parts[1].b) return std::nullopt;
        return both([&](const Taylor& t) { return with.divide(t, parts[1].a); });
      default:
        return std::nullopt;
    }
  }
  Halves added(const Halves& p, const Halves& q) const {
    const TaylorArithmetic& with = values_.arithmetic();
    Halves h{with.add(p.a, q.a), p.b ? p.b : q.b};
    if (p.b && q.b) h.b = with.add(*p.b, *q.b);
    return h;
  }

  const Syntax& syntax_;
  Evaluation& values_;
  int node_;
  std::vector<bool> needs_;
  std::vector<std::optional<std::optional<Halves>>> done_;
};

double eighth_of(const Taylor& t) {
  const double bound = magnitude(t.c[taylor_order]);
  return std::isnan(bound) ? infinity : bound;
}

/// The expression next to the place where the base of one power vanishes linearly.
std::optional<ScalarOnPiece::Parts> part_at_power(const std::shared_ptr<const Syntax>& syntax, const EdgeLine& edge,
                                                  double from, double to, int node, Evaluation& values) {
  const SyntaxNode& n = syntax->nodes[node];
  const Taylor base = values.at(n.of[0]);
  for (int k = 2; k <= taylor_order; ++k)
    if (!is(base.c[k], 0)) return std::nullopt;
  if (contains(base.c[1], 0)) return std::nullopt;
  const bool at_low_end = base.c[1].low > 0;
  // Up to the digits of the place.
  constexpr double rounding = 1e-12, digits = 1e-6;
  // The base at this end against its range over the piece: 0 up to rounding.
  const Interval start = at_point(*syntax, edge, at_low_end ? from : to, n.of[0]);
  const double reach = magnitude(base.c[1]) * (to - from);
  if (magnitude(start) > (contains(start, 0) ? digits : rounding) * reach) return std::nullopt;
  const std::optional<Halves> halves = Parting(*syntax, values, node).root();
  if (!halves || !halves->b) return std::nullopt;
  // base = slope d: b (slope d)^alpha = (slope^alpha b) d^alpha.
  const double exponent = middle(values.at(n.of[1]).c[0]), slope = std::pow(std::abs(middle(base.c[1])), exponent);
  return ScalarOnPiece::Parts{at_low_end, exponent, eighth_of(halves->a), slope * eighth_of(*halves->b),
                              [syntax, edge, node, slope](double s) -> std::pair<double, double> {
                                const Variables here = on_piece(edge, s, s, 0);
                                Evaluation point(*syntax, here);
                                const std::optional<Halves> h = Parting(*syntax, point, node).root();
                                if (!h || !h->b) return {nan, nan};
                                return {middle(h->a.c[0]), slope * middle(h->b->c[0])};
                              }};
}

}  // namespace

ScalarOnPiece enclose(const std::shared_ptr<const Syntax>& syntax, const EdgeLine& edge, double from, double to) {
  const Variables at_low = on_piece(edge, from, from, 0), at_high = on_piece(edge, to, to, 0),
                  here = on_piece(edge, from, to, taylor_order);
  Evaluation low(*syntax, at_low), high(*syntax, at_high), values(*syntax, here, low, high);
  const bool straight = edge.is_straight();
  const Taylor f =
      straight || !edge.density ? values.root() : TaylorArithmetic(taylor_order).multiply(values.root(), here.stretch);
  // On a curved edge a density per length is integrated over s: f |dx/ds| / |b - a| is what must be smooth.
  ScalarOnPiece piece{f.c[0], eighth_of(f), std::nullopt, std::nullopt};
  if (std::isfinite(piece.eighth)) return piece;
  // As narrow as the numbers of places allow, about a cut: one branch or the other, which the range of all of them
  // together may not be.
  constexpr double narrowest = 0x1p-49;
  if (to - from <= narrowest) {
    const Interval ends = hull(low.root().c[0], high.root().c[0]);
    if (is_bounded(ends)) piece.value = is_bounded(piece.value) ? common(piece.value, ends) : ends;
    return piece;
  }
  for (const Undecided& what : values.undecided) {
    const Taylor& g = values.at(what.node);
    if (contains(g.c[1], 0)) continue;
    piece.cut = passage(*syntax, edge, from, to, what);
    if (piece.cut) return piece;
  }
  if (straight && values.undecided.empty() && values.singular.size() == 1)
    piece.power = part_at_power(syntax, edge, from, to, values.singular[0], values);
  return piece;
}

Interval enclose(const Syntax& syntax, const Interval& x, const Interval& y) {
  const Variables here = on_box(x, y);
  return Evaluation(syntax, here).root().c[0];
}

}  // namespace kerf
