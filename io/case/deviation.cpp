// How far an expression is from a polynomial over a box: the Taylor model of its syntax tree, node after node [theory:
// D.4; Makino, Berz 2003]. The answer is half the width of the rest at the root: the polynomial plus the middle of the
// rest is no further than that from f. A condition that ranges settle takes its branch, with its polynomial; one that
// the box leaves open gives what the two branches differ by, so that a kink costs its width times the jump of the slope
// and a jump half of itself. Comparisons, && and || are numbers 0, 1 or [0, 1]. Normals have no value over a box.
// docs/theory/data.md, "Triangles".

#include "io/case/decided.hpp"
#include "io/case/functions.hpp"
#include "io/case/node_order.hpp"
#include "io/case/syntax.hpp"
#include "io/case/taylor_model.hpp"

#include <optional>

namespace kerf {

namespace {

using Kind = SyntaxNode::Kind;

double sign_of(double v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/// A tree over one box. Every node is evaluated at most once, and only where it is needed.
class ModelOverBox {
 public:
  ModelOverBox(const Syntax& syntax, const Interval& x, const Interval& y, int degree)
      : syntax_(syntax), x_(x), y_(y), with_(degree), value_(syntax.nodes.size()) {}

  const TaylorModel& root() {
    return at(static_cast<int>(syntax_.nodes.size()) - 1);
  }

 private:
  const TaylorModel& at(int node) {
    const auto value = [&](int k) -> std::optional<TaylorModel>& { return value_[static_cast<std::size_t>(k)]; };
    const auto known = [&](int k) { return value(k).has_value(); };
    const auto range = [&](int k) -> const Interval& { return value(k)->range; };
    const auto node_of = [&](int k) -> const SyntaxNode& { return syntax_.nodes[static_cast<std::size_t>(k)]; };
    if (!known(node))
      evaluate_in_order(
          node, known, [&](int k, std::vector<int>& wanted) { append_needed(node_of(k), known, range, wanted); },
          [&](int k) { value(k) = evaluate(node_of(k)); });
    return *value(node);
  }

  /// Of a node whose needs are known.
  TaylorModel evaluate(const SyntaxNode& n) {
    const auto of = [&](std::size_t k) -> const TaylorModel& { return at(n.of[k]); };
    switch (n.kind) {
      case Kind::Constant:
        return with_.range(exactly(n.value));
      case Kind::Variable:
        return n.argument < 2 ? with_.coordinate(n.argument, n.argument == 0 ? x_ : y_) : with_.range(whole_line);
      case Kind::Negate:
        return with_.negate(of(0));
      case Kind::Add:
        return with_.add(of(0), of(1));
      case Kind::Subtract:
        return with_.subtract(of(0), of(1));
      case Kind::Multiply:
        return n.of[0] == n.of[1] ? with_.square(of(0)) : with_.multiply(of(0), of(1));
      case Kind::Divide:
        return with_.divide(of(0), of(1));
      case Kind::Power:
        return power(of(0), of(1));
      case Kind::And:
      case Kind::Or:
        return connective(n);
      case Kind::Choice: {
        const Truth condition = truth(of(0).range);
        return condition == Truth::Open ? with_.either(of(1), of(2)) : of(condition == Truth::Yes ? 1 : 2);
      }
      case Kind::Call:
        return call(n);
      default: {
        const std::optional<bool> known = decided(n.kind, of(0).range);
        return with_.range(known ? exactly(*known ? 1 : 0) : Interval{0, 1});
      }
    }
  }

  TaylorModel power(const TaylorModel& base, const TaylorModel& exponent) const {
    const double p = exponent.range.low;
    if (!is(exponent.range, p)) {
      const TaylorModel log =
          with_.compose(base, [](const Taylor& t, const TaylorArithmetic& with) { return with.logarithm(t); });
      return with_.compose(with_.multiply(exponent, log),
                           [](const Taylor& t, const TaylorArithmetic& with) { return with.exponential(t); });
    }
    if (is_product(p)) return with_.power(base, static_cast<int>(p));
    return with_.compose(base, [p](const Taylor& t, const TaylorArithmetic& with) { return with.power(t, p); });
  }

  TaylorModel connective(const SyntaxNode& n) {
    const Truth both =
        connected(n.kind == Kind::And, truth(at(n.of[0]).range), [&] { return truth(at(n.of[1]).range); });
    return with_.range(both == Truth::Open ? Interval{0, 1} : exactly(both == Truth::Yes ? 1 : 0));
  }

  TaylorModel call(const SyntaxNode& n) {
    const TaylorModel& last = at(n.of.back());
    const Interval& c = last.range;
    switch (breaking(n.argument)) {
      case Breaking::Abs:
        return with_.absolute(last);
      case Breaking::Sign:
        return with_.range({sign_of(c.low), sign_of(c.high)});
      case Breaking::Rint:
        return with_.range(is_bounded(c) ? Interval{std::rint(c.low), std::rint(c.high)} : whole_line);
      case Breaking::Angle:
        return with_.arc_tangent(at(n.of[0]), at(n.of[1]));
      case Breaking::Min:
        return with_.least(at(n.of[0]), at(n.of[1]));
      case Breaking::Max:
        return with_.negate(with_.least(with_.negate(at(n.of[0])), with_.negate(at(n.of[1]))));
      case Breaking::No:
        break;
    }
    if (n.of.size() == 1)
      return with_.compose(last, [&n](const Taylor& t, const TaylorArithmetic& with) {
        return kerf::evaluate(n.argument, std::span(&t, 1), with);
      });
    TaylorModel total = at(n.of[0]);
    for (std::size_t k = 1; k < n.of.size(); ++k) total = with_.add(total, at(n.of[k]));
    if (n.argument == function_called("sum")) return total;
    return with_.divide(total, with_.range(exactly(static_cast<double>(n.of.size()))));
  }

  const Syntax& syntax_;
  const Interval x_, y_;
  ModelArithmetic with_;
  std::vector<std::optional<TaylorModel>> value_;
};

}  // namespace

double deviation(const Syntax& syntax, const Interval& x, const Interval& y, int degree) {
  const double wide = width(ModelOverBox(syntax, x, y, degree).root().rest);
  return std::isnan(wide) ? infinity : above(0.5 * wide);
}

}  // namespace kerf
