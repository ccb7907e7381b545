// Taylor models over a box [theory: D.4; Makino, Berz 2003]: f(u, v) = T(u, v) + rest, T a polynomial with numbers for
// coefficients, rest an interval that holds what T leaves out and all rounding. Products cut off terms above the degree
// and put their magnitudes (|u|, |v| <= 1) into the rest. A function g of one number is composed by its own series
// about a number a in the range A, with Lagrange's remainder,
//   g(h) = sum_{k <= n} g_k(a) (h - a)^k + [g_{n+1}(A) (A - a)^{n+1}],
// its coefficients by Taylor arithmetic. Kinks and jumps add to the rest what the branches may differ by:
//   |a| = a + 2 max(-a, 0);  min(a, b) = b + min(a - b, 0);  c ? a : b in a + hull(0, b - a).
// Every model keeps its range beside the polynomial, and falls back to its middle as a constant where the rest is
// wider. docs/theory/data.md, "Triangles".

#include "io/case/taylor_model.hpp"

namespace kerf {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
// The sums of as many terms as there are coefficients are right to this share of the terms' magnitudes.
// A coefficient of u^a v^b in a product is a sum of (a+1)(b+1) <= 20 products, a + b <= 7.
constexpr double rounding = 64 * eps;

constexpr std::size_t first_of(int degree) {
  return static_cast<std::size_t>(degree * (degree + 1) / 2);
}

/// Sums of the magnitudes of the terms of each degree, not less.
std::array<double, model_degree + 1> sizes(const TaylorModel& m) {
  std::array<double, model_degree + 1> size{};
  for (int k = 0; k <= m.degree; ++k) {
    for (std::size_t i = first_of(k); i < first_of(k + 1); ++i) size[static_cast<std::size_t>(k)] += std::abs(m.c[i]);
    size[static_cast<std::size_t>(k)] *= 1 + rounding;
  }
  return size;
}

Interval about_zero(double size) {
  return size == 0 ? exactly(0) : Interval{-above(size), above(size)};
}

/// b t + a t^2 over |t| <= 1.
Interval quadratic(double b, double a) {
  double low = std::min(a - b, a + b), high = std::max(a - b, a + b);
  // The vertex t = -b/(2a) is inside where |b| < 2 |a|.
  if (std::abs(b) < 2 * std::abs(a)) (a > 0 ? low : high) = -b * b / (4 * a);
  const double margin = rounding * (std::abs(a) + std::abs(b));
  return {std::min(low, 0.0) - margin, std::max(high, 0.0) + margin};
}

/// The polynomial over the box. What grows along one axis and bends is seen to the point: kinks that only touch.
Interval bounds_of(const TaylorModel& m) {
  if (m.degree == 0) return exactly(m.c[0]);
  Interval all = exactly(m.c[0]);
  const bool bends = m.degree >= 2;
  all = all + quadratic(m.c[1], bends ? m.c[3] : 0) + quadratic(m.c[2], bends ? m.c[5] : 0);
  double beyond = bends ? std::abs(m.c[4]) : 0;
  for (std::size_t i = first_of(3); i < first_of(m.degree + 1); ++i) beyond += std::abs(m.c[i]);
  return all + about_zero((1 + rounding) * beyond);
}

}  // namespace

/// With the sharper of two ranges, and without a polynomial where that leaves more than the range is wide.
TaylorModel ModelArithmetic::finished(TaylorModel m, const Interval& range) const {
  bool finite = is_bounded(m.rest);
  for (std::size_t i = 0; i < first_of(m.degree + 1); ++i) finite = finite && std::isfinite(m.c[i]);
  if (!finite) return this->range(range);
  while (m.degree > 0) {
    bool ends = false;
    for (std::size_t i = first_of(m.degree); i < first_of(m.degree + 1); ++i) ends = ends || m.c[i] != 0;
    if (ends) break;
    --m.degree;
  }
  m.range = common(range, bounds_of(m) + m.rest);
  return width(m.rest) <= width(m.range) ? m : this->range(m.range);
}

TaylorModel ModelArithmetic::range(const Interval& value) const {
  TaylorModel m;
  m.range = value;
  m.c[0] = is_bounded(value) ? middle(value) : 0;
  m.rest = value - exactly(m.c[0]);
  return m;
}

TaylorModel ModelArithmetic::coordinate(int axis, const Interval& over) const {
  TaylorModel m = range(over);
  if (degree_ == 0 || !is_bounded(over)) return m;
  const double half = 0.5 * width(over);
  m.degree = half == 0 ? 0 : 1;
  m.c[axis == 0 ? 1 : 2] = half;
  m.rest = about_zero(4 * eps * magnitude(over));
  return m;
}

namespace {

/// Without its range.
TaylorModel sum_of(const TaylorModel& a, const TaylorModel& b) {
  TaylorModel m = a.degree >= b.degree ? a : b;
  const TaylorModel& other = a.degree >= b.degree ? b : a;
  double size = 0;
  for (std::size_t i = 0; i < first_of(other.degree + 1); ++i) {
    m.c[i] += other.c[i];
    size += std::abs(m.c[i]);
  }
  m.rest = a.rest + b.rest + about_zero(eps * size);
  return m;
}

}  // namespace

TaylorModel ModelArithmetic::add(const TaylorModel& a, const TaylorModel& b) const {
  return finished(sum_of(a, b), a.range + b.range);
}

TaylorModel ModelArithmetic::negate(const TaylorModel& a) const {
  TaylorModel m = a;
  for (std::size_t i = 0; i < first_of(m.degree + 1); ++i) m.c[i] = -m.c[i];
  m.rest = -a.rest;
  m.range = -a.range;
  return m;
}

TaylorModel ModelArithmetic::subtract(const TaylorModel& a, const TaylorModel& b) const {
  return add(a, negate(b));
}

namespace {

/// Up to this degree, without its range.
TaylorModel product_of(const TaylorModel& a, const TaylorModel& b, int degree) {
  const auto of_a = sizes(a), of_b = sizes(b);
  TaylorModel m;
  m.degree = std::min(degree, a.degree + b.degree);
  double beyond = 0, size = 0;
  for (int k = 0; k <= a.degree; ++k)
    for (int l = 0; l <= b.degree; ++l) {
      const double both = of_a[static_cast<std::size_t>(k)] * of_b[static_cast<std::size_t>(l)];
      if (both == 0) continue;
      if (k + l > degree) {
        beyond += both;
        continue;
      }
      size += both;
      double* const to = &m.c[first_of(k + l)];
      const double *const p = &a.c[first_of(k)], *const q = &b.c[first_of(l)];
      for (int i = 0; i <= k; ++i)
        for (int j = 0; j <= l; ++j) to[i + j] += p[i] * q[j];
    }
  constexpr double tiny = std::numeric_limits<double>::min();  // products may fall below all numbers
  const double off = size + beyond == 0 ? 0 : (1 + rounding) * beyond + rounding * size + tiny;
  const auto all = [](const TaylorModel& of, const auto& sizes_of) {
    double varying = 0;
    for (int k = 1; k <= of.degree; ++k) varying += sizes_of[static_cast<std::size_t>(k)];
    return exactly(of.c[0]) + about_zero((1 + rounding) * varying);
  };
  m.rest = all(a, of_a) * b.rest + all(b, of_b) * a.rest + a.rest * b.rest + about_zero(off);
  return m;
}

}  // namespace

TaylorModel ModelArithmetic::multiply(const TaylorModel& a, const TaylorModel& b) const {
  return finished(product_of(a, b, degree_), a.range * b.range);
}

TaylorModel ModelArithmetic::square(const TaylorModel& a) const {
  return finished(product_of(a, a, degree_), kerf::power(a.range, 2));
}

TaylorModel ModelArithmetic::divide(const TaylorModel& a, const TaylorModel& b) const {
  const TaylorModel inverse = compose(
      b, [](const Taylor& t, const TaylorArithmetic& with) { return with.divide(with.constant(exactly(1)), t); });
  return finished(product_of(a, inverse, degree_), a.range / b.range);
}

TaylorModel ModelArithmetic::power(const TaylorModel& a, int n) const {
  if (n < 0) return divide(range(exactly(1)), power(a, -n));
  if (n == 0) return range(exactly(1));
  if (n == 1) return a;
  TaylorModel m = square(power(a, n / 2));
  if (n % 2 == 1) m = product_of(m, a, degree_);
  return finished(std::move(m), kerf::power(a.range, n));
}

TaylorModel ModelArithmetic::compose(const TaylorModel& a, const Function& f) const {
  const TaylorArithmetic values(0), with(degree_ + 1);
  Taylor over;
  over.c[0] = a.range;
  const Interval value = f(over, values).c[0];
  if (a.degree == 0 || !is_bounded(a.range)) return range(value);
  const auto number = [&](const Interval& at) {
    Taylor t = with.constant(at);
    t.c[1] = exactly(1);
    return t;
  };
  const Interval last = f(number(a.range), with).c[static_cast<std::size_t>(degree_ + 1)];
  if (!is_bounded(last)) return range(value);
  const double about = contains(a.range, a.c[0]) ? a.c[0] : middle(a.range);
  const Taylor series = f(number(exactly(about)), with);
  TaylorModel step = a;
  step.c[0] = a.c[0] - about;
  step.rest = step.rest + about_zero(eps * std::abs(step.c[0]));
  step.range = a.range - exactly(about);
  const auto term = [&](int k) { return range(series.c[static_cast<std::size_t>(k)]); };
  // What is multiplied by k more steps is wanted to so much lower a degree.
  TaylorModel m = term(degree_);
  for (int k = degree_ - 1; k >= 0; --k) m = sum_of(product_of(m, step, degree_ - k), term(k));
  m.rest = m.rest + last * kerf::power(step.range, degree_ + 1);
  return finished(std::move(m), value);
}

TaylorModel ModelArithmetic::arc_tangent(const TaylorModel& y, const TaylorModel& x) const {
  const Interval value = kerf::arc_tangent(y.range, x.range);
  const auto angle = [&](const TaylorModel& of) {
    return compose(of, [](const Taylor& t, const TaylorArithmetic& with) {
      return with.with_slope(t, with.add(with.constant(exactly(1)), with.square(t)), kerf::arc_tangent(t.c[0]));
    });
  };
  if (x.range.low > 0) return finished(angle(divide(y, x)), value);
  if (contains(y.range, 0)) return range(value);
  const double quarter = y.range.low > 0 ? pi / 2 : -pi / 2;
  return finished(subtract(range(widened(quarter, quarter)), angle(divide(x, y))), value);
}

TaylorModel ModelArithmetic::absolute(const TaylorModel& a) const {
  if (a.range.low >= 0) return a;
  if (a.range.high <= 0) return negate(a);
  // a + 2 max(-a, 0), or the same from -a.
  const bool up = a.range.high >= -a.range.low;
  TaylorModel m = up ? a : negate(a);
  m.rest = m.rest + exactly(2) * Interval{0, up ? -a.range.low : a.range.high};
  return finished(std::move(m), kerf::absolute(a.range));
}

TaylorModel ModelArithmetic::least(const TaylorModel& a, const TaylorModel& b) const {
  const Interval smaller{std::min(a.range.low, b.range.low), std::min(a.range.high, b.range.high)};
  const TaylorModel d = subtract(a, b);
  if (d.range.high <= 0) return a;
  if (d.range.low >= 0) return b;
  // b + min(a - b, 0), or the same from a.
  const bool from_a = d.range.high <= -d.range.low;
  TaylorModel m = from_a ? a : b;
  m.rest = m.rest + Interval{from_a ? -d.range.high : d.range.low, 0};
  return finished(std::move(m), smaller);
}

TaylorModel ModelArithmetic::either(const TaylorModel& a, const TaylorModel& b) const {
  // Of the polynomials, not of the ranges: each of the two may have no value where the other one is taken.
  const TaylorModel d = sum_of(b, negate(a));
  TaylorModel m = a;
  m.rest = m.rest + hull(exactly(0), bounds_of(d) + d.rest);
  return finished(std::move(m), hull(a.range, b.range));
}

}  // namespace kerf
