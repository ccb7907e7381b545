// Sums, multiples and linear fields of the place that carry their enclosures along: intervals rounded outwards, so that
// what is proved of the parts is proved of the whole [theory: D.1]. Enclosures of expressions are in io/case. Of a sum
//   value = value_a + value_b,   |f^(8)|/8! <= c_a + c_b,   remainder <= remainder_a + remainder_b,
// the cut is that of either part; powers at an end are not carried on, and leave a range alone. A linear field is
// largest at the ends of a piece and at the corners of a box; its values there get 1e-13 of their size as room for
// rounding. docs/theory/data.md, section Enclosures.

#include "kerf/field.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kerf {

namespace {

// One step of nextafter covers the half unit that the sum rounds by. inf - inf is the whole line.
Interval plus(const Interval& a, const Interval& b) {
  const auto outwards = [](double v, double towards) { return std::nextafter(v, towards); };
  const double low = a.low + b.low, high = a.high + b.high;
  if (std::isnan(low) || std::isnan(high)) return {};
  return {outwards(low, -infinity), outwards(high, infinity)};
}

class Sum final : public Enclosure {
 public:
  Sum(std::shared_ptr<const Enclosure> a, std::shared_ptr<const Enclosure> b) : a_(std::move(a)), b_(std::move(b)) {}

  OnPiece along(const EdgeLine& edge, double from, double to) const override {
    const OnPiece a = a_->along(edge, from, to), b = b_->along(edge, from, to);
    OnPiece both;
    for (std::size_t d = 0; d < 2; ++d) {
      both.value[d] = plus(a.value[d], b.value[d]);
      both.eighth[d] = std::nextafter(a.eighth[d] + b.eighth[d], infinity);
    }
    both.cut = a.cut ? a.cut : b.cut;
    return both;
  }
  std::array<Interval, 2> over(const Interval& x, const Interval& y) const override {
    const auto a = a_->over(x, y), b = b_->over(x, y);
    return {plus(a[0], b[0]), plus(a[1], b[1])};
  }
  std::array<double, 2> remainder(const Interval& x, const Interval& y, int degree) const override {
    const auto a = a_->remainder(x, y, degree), b = b_->remainder(x, y, degree);
    return {std::nextafter(a[0] + b[0], infinity), std::nextafter(a[1] + b[1], infinity)};
  }
  int degree() const override {
    return a_->degree() < 0 || b_->degree() < 0 ? -1 : std::max(a_->degree(), b_->degree());
  }

 private:
  std::shared_ptr<const Enclosure> a_, b_;
};

// The power at an end would need its parts scaled, too: it is given up, and the range stands.
class Scaled final : public Enclosure {
 public:
  Scaled(double factor, std::shared_ptr<const Enclosure> a) : factor_(factor), a_(std::move(a)) {}

  OnPiece along(const EdgeLine& edge, double from, double to) const override {
    OnPiece piece = a_->along(edge, from, to);
    for (std::size_t d = 0; d < 2; ++d) {
      piece.value[d] = times(piece.value[d]);
      piece.eighth[d] = std::nextafter(std::abs(factor_) * piece.eighth[d], infinity);
    }
    piece.power.reset();
    return piece;
  }
  std::array<Interval, 2> over(const Interval& x, const Interval& y) const override {
    const auto a = a_->over(x, y);
    return {times(a[0]), times(a[1])};
  }
  std::array<double, 2> remainder(const Interval& x, const Interval& y, int degree) const override {
    auto a = a_->remainder(x, y, degree);
    for (double& bound : a) bound = std::nextafter(std::abs(factor_) * bound, infinity);
    return a;
  }
  int degree() const override {
    return a_->degree();
  }

 private:
  Interval times(const Interval& v) const {
    const double a = factor_ * v.low, b = factor_ * v.high;
    if (std::isnan(a) || std::isnan(b)) return {};
    return {std::nextafter(std::min(a, b), -infinity), std::nextafter(std::max(a, b), infinity)};
  }
  double factor_;
  std::shared_ptr<const Enclosure> a_;
};

// Extreme at the ends of a piece and the corners of a box.
// Along curved edges nothing is known: there the field is no polynomial of degree 1 in s.
class Linear final : public Enclosure {
 public:
  explicit Linear(std::function<Vec2(const Vec2&)> f) : f_(std::move(f)) {}

  OnPiece along(const EdgeLine& edge, double from, double to) const override {
    if (!edge.is_straight()) return {};
    const Vec2 side = edge.b - edge.a;
    return {.value = around({edge.a + from * side, edge.a + to * side}), .eighth = {0, 0}};
  }
  std::array<Interval, 2> over(const Interval& x, const Interval& y) const override {
    return around({Vec2(x.low, y.low), Vec2(x.high, y.low), Vec2(x.low, y.high), Vec2(x.high, y.high)});
  }
  std::array<double, 2> remainder(const Interval&, const Interval&, int degree) const override {
    return degree > 0 ? std::array{0.0, 0.0} : std::array{infinity, infinity};
  }
  int degree() const override {
    return 1;
  }

 private:
  std::array<Interval, 2> around(const std::vector<Vec2>& points) const {
    Vec2 low = Vec2::Constant(infinity), high = -low;
    double size = 0;
    for (const Vec2& x : points) {
      const Vec2 v = f_(x);
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
      size = std::max(size, v.cwiseAbs().maxCoeff());
    }
    constexpr double rounding = 1e-13;
    const double margin = rounding * size;
    return {Interval{low.x() - margin, high.x() + margin}, Interval{low.y() - margin, high.y() + margin}};
  }

  std::function<Vec2(const Vec2&)> f_;
};

}  // namespace

VectorField linear_field(std::function<Vec2(const Vec2& x)> f) {
  const auto known = std::make_shared<Linear>(f);
  return VectorField(std::move(f), known);
}

VectorField scaled(double factor, const VectorField& a) {
  if (!a) return a;
  return VectorField([factor, a](const Vec2& x) -> Vec2 { return factor * a(x); },
                     a.known() ? std::make_shared<Scaled>(factor, a.known()) : nullptr);
}

// A sum with a black box is a black box.
VectorField sum(const VectorField& a, const VectorField& b) {
  if (!a) return b;
  if (!b) return a;
  return VectorField([a, b](const Vec2& x) -> Vec2 { return a(x) + b(x); },
                     a.known() && b.known() ? std::make_shared<Sum>(a.known(), b.known()) : nullptr);
}

}  // namespace kerf
