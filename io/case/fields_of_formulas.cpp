// Pairs of formulas as vector fields on edges and over boxes, with what can be proved of them (the interface
// Enclosure): ranges, bounds of the eighth derivative, cuts and powers along an edge [theory: D.1, D.2], and the
// deviation from polynomials over a box [theory: D.4]. Three fields derive from others:
//   a pressure            t = -p n, as the trees of -p n_1 and -p n_2,
//   without normal part   t - (t . n) n,    without component d   t - t_d e_d,    both as M(n) times an enclosed field.
// On a straight edge M is one matrix, and ranges and bounds go through |M|; on a curved edge nothing is said of the
// product. Two equal trees are evaluated once. docs/theory/data.md, "Enclosures".

#include "io/case/formula.hpp"

namespace kerf {

namespace {

bool are_same(const Syntax& first, const Syntax& second) {
  return first.nodes == second.nodes;
}

/// Two formulas. Fields without a meaning on boundaries know no normal.
class OfFormulas final : public Enclosure {
 public:
  OfFormulas(std::shared_ptr<const Syntax> first, std::shared_ptr<const Syntax> second)
      : parts_{std::move(first), std::move(second)}, same_(are_same(*parts_[0], *parts_[1])) {}

  OnPiece along(const EdgeLine& edge, double from, double to) const override {
    OnPiece piece;
    std::array<std::optional<ScalarOnPiece::Parts>, 2> power;
    for (std::size_t d = 0; d < 2; ++d) {
      const ScalarOnPiece one = enclose(parts_[d], edge, from, to);
      piece.value[d] = one.value;
      piece.eighth[d] = one.eighth;
      if (one.cut && !piece.cut) piece.cut = one.cut;
      power[d] = one.power;
    }
    for (std::size_t d = 0; d < 2 && !piece.power; ++d)
      if (power[d]) piece.power = together(power, piece, d);
    return piece;
  }
  std::array<Interval, 2> over(const Interval& x, const Interval& y) const override {
    const Interval first = enclose(*parts_[0], x, y);
    return {first, same_ ? first : enclose(*parts_[1], x, y)};
  }
  std::array<double, 2> remainder(const Interval& x, const Interval& y, int degree) const override {
    const double first = kerf::deviation(*parts_[0], x, y, degree);
    return {first, same_ ? first : kerf::deviation(*parts_[1], x, y, degree)};
  }
  int degree() const override {
    const int first = degree_of(*parts_[0]), second = degree_of(*parts_[1]);
    return first < 0 || second < 0 ? -1 : std::max(first, second);
  }

 private:
  /// Component d has a power; the other one has the same, or is smooth.
  std::optional<Power> together(const std::array<std::optional<ScalarOnPiece::Parts>, 2>& power, const OnPiece& piece,
                                std::size_t d) const {
    const std::size_t other = 1 - d;
    Power p{.at_low_end = power[d]->at_low_end, .exponent = power[d]->exponent};
    p.regular_eighth[d] = power[d]->regular_eighth;
    p.factor_eighth[d] = power[d]->factor_eighth;
    std::function<std::pair<double, double>(double)> beside;
    if (power[other]) {
      if (power[other]->at_low_end != p.at_low_end || power[other]->exponent != p.exponent) return std::nullopt;
      p.regular_eighth[other] = power[other]->regular_eighth;
      p.factor_eighth[other] = power[other]->factor_eighth;
      beside = power[other]->at;
    } else if (is(piece.value[other], middle(piece.value[other]))) {
      beside = [value = middle(piece.value[other])](double) { return std::pair(value, 0.0); };
    } else {
      return std::nullopt;
    }
    p.parts = [own = power[d]->at, beside, d](double s) {
      const auto a = own(s), b = beside(s);
      return d == 0 ? std::pair(Vec2(a.first, b.first), Vec2(a.second, b.second))
                    : std::pair(Vec2(b.first, a.first), Vec2(b.second, a.second));
    };
    return p;
  }

  std::array<std::shared_ptr<const Syntax>, 2> parts_;
  bool same_;  // one evaluation serves both
};

/// M(n) times a field: on straight edges.
class Mapped final : public Enclosure {
 public:
  Mapped(std::shared_ptr<const Enclosure> field, std::function<Mat2(const Vec2&)> map)
      : field_(std::move(field)), map_(std::move(map)) {}

  OnPiece along(const EdgeLine& edge, double from, double to) const override {
    if (!edge.is_straight()) return {};
    const Mat2 m = map_(edge.n);
    const OnPiece before = field_->along(edge, from, to);
    OnPiece piece = before;
    piece.value = times(m, before.value);
    piece.eighth = times(m, before.eighth);
    if (before.power) {
      piece.power->regular_eighth = times(m, before.power->regular_eighth);
      piece.power->factor_eighth = times(m, before.power->factor_eighth);
      piece.power->parts = [m, parts = before.power->parts](double s) {
        const auto p = parts(s);
        return std::pair(Vec2(m * p.first), Vec2(m * p.second));
      };
    }
    return piece;
  }
  std::array<Interval, 2> over(const Interval&, const Interval&) const override {
    return {whole_line, whole_line};
  }
  int degree() const override {
    return field_->degree();
  }

 private:
  static std::array<Interval, 2> times(const Mat2& m, const std::array<Interval, 2>& v) {
    std::array<Interval, 2> out;
    for (int d = 0; d < 2; ++d) out[d] = exactly(m(d, 0)) * v[0] + exactly(m(d, 1)) * v[1];
    return out;
  }
  static std::array<double, 2> times(const Mat2& m, const std::array<double, 2>& bound) {
    std::array<double, 2> out{0, 0};
    for (int d = 0; d < 2; ++d)
      for (int k = 0; k < 2; ++k)
        if (m(d, k) != 0) out[d] = above(out[d] + above(std::abs(m(d, k)) * bound[k]));
    return out;
  }

  std::shared_ptr<const Enclosure> field_;
  std::function<Mat2(const Vec2&)> map_;
};

std::shared_ptr<const Enclosure> known(const Formula& first, const Formula& second) {
  if (!first.syntax || !second.syntax) return nullptr;
  return std::make_shared<OfFormulas>(first.syntax, second.syntax);
}

/// -p n_d.
std::shared_ptr<const Syntax> times_minus_normal(const Syntax& p, int d) {
  using Kind = SyntaxNode::Kind;
  auto product = std::make_shared<Syntax>(p);
  const int value = static_cast<int>(product->nodes.size()) - 1;
  product->nodes.push_back({.kind = Kind::Variable, .argument = 2 + d});
  product->nodes.push_back({.kind = Kind::Multiply, .of = {value, value + 1}});
  product->nodes.push_back({.kind = Kind::Negate, .of = {value + 2}});
  return product;
}

BoundaryField mapped(const BoundaryField& field, const std::function<Mat2(const Vec2&)>& map) {
  return BoundaryField([field, map](const Vec2& x, const Vec2& n) { return Vec2(map(n) * field(x, n)); },
                       field.known() ? std::make_shared<Mapped>(field.known(), map) : nullptr);
}

}  // namespace

Formula nothing() {
  const auto syntax = std::make_shared<Syntax>();
  syntax->nodes.push_back({.kind = SyntaxNode::Kind::Constant});
  return {[](const Vec2&, const Vec2&) { return 0.0; }, 0.0, syntax};
}

BoundaryField vector_field(const Formula& first, const Formula& second) {
  if (first.pair && first.pair == second.pair) return BoundaryField(*first.pair);
  return BoundaryField([first = first.value, second = second.value](
                           const Vec2& x, const Vec2& n) { return Vec2(first(x, n), second(x, n)); },
                       known(first, second));
}

VectorField body_field(const Formula& first, const Formula& second) {
  if (first.pair && first.pair == second.pair)
    return VectorField([both = first.pair](const Vec2& x) { return (*both)(x, Vec2::Zero()); });
  if (first.syntax && second.syntax && are_same(*first.syntax, *second.syntax))
    return VectorField([one = first.value](const Vec2& x) -> Vec2 { return Vec2::Constant(one(x, Vec2::Zero())); },
                       known(first, second));
  return VectorField([first = first.value, second = second.value](
                         const Vec2& x) { return Vec2(first(x, Vec2::Zero()), second(x, Vec2::Zero())); },
                     known(first, second));
}

BoundaryField pressure_field(const Formula& pressure) {
  std::array<std::shared_ptr<const Syntax>, 2> parts;
  if (pressure.syntax)
    for (int d = 0; d < 2; ++d) parts[static_cast<std::size_t>(d)] = times_minus_normal(*pressure.syntax, d);
  return BoundaryField([p = pressure.value](const Vec2& x, const Vec2& n) { return Vec2(-p(x, n) * n); },
                       pressure.syntax ? std::make_shared<OfFormulas>(parts[0], parts[1]) : nullptr);
}

BoundaryField without_normal_part(const BoundaryField& field) {
  return mapped(field, [](const Vec2& n) { return Mat2(Mat2::Identity() - n * n.transpose()); });
}

BoundaryField without_component(const BoundaryField& field, int component) {
  return mapped(field, [component](const Vec2&) {
    Mat2 m = Mat2::Identity();
    m(component, component) = 0;
    return m;
  });
}

BoundaryField scaled_load(const BoundaryField& field, double factor) {
  return mapped(field, [factor](const Vec2&) { return Mat2(factor * Mat2::Identity()); });
}

}  // namespace kerf
