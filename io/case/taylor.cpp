// Arithmetic of Taylor coefficients c_k = f^(k)/k! with intervals for numbers [theory: D.1; Moore 1966]. The rule of
// each function comes from an equation without the function's series: the Leibniz rule for products, a differential
// equation for the others, whose coefficients of t^(k-1) give c_k from those before it:
//   t = a/b: t b = a;  t = a^p: a t' = p t a';  t = exp a: t' = a' t;  s = sin a, c = cos a: s' = a' c, c' = -a' s,
//   with_slope: d t' = a' (log, asin, acos, atan, asinh, ...: d is the reciprocal of the function's derivative).
// The range c_0 is always that of the interval function, which is sharper than a product or a quotient of ranges. A
// function that has no derivative at some point of the range (a root or a logarithm that touches 0) keeps its range and
// has the whole line for derivatives. docs/theory/data.md, "Enclosures".

#include "io/case/taylor.hpp"

namespace kerf {

Taylor TaylorArithmetic::constant(const Interval& value) const {
  Taylor t;
  t.c[0] = value;
  for (int k = 1; k <= order_; ++k) t.c[k] = exactly(0);
  return t;
}

Taylor TaylorArithmetic::range(const Interval& value) const {
  Taylor t;
  t.c[0] = value;
  for (int k = 1; k <= order_; ++k) t.c[k] = whole_line;
  return t;
}

Taylor TaylorArithmetic::add(const Taylor& a, const Taylor& b) const {
  Taylor t;
  for (int k = 0; k <= order_; ++k) t.c[k] = a.c[k] + b.c[k];
  return t;
}

Taylor TaylorArithmetic::negate(const Taylor& a) const {
  Taylor t;
  for (int k = 0; k <= order_; ++k) t.c[k] = -a.c[k];
  return t;
}

Taylor TaylorArithmetic::subtract(const Taylor& a, const Taylor& b) const {
  return add(a, negate(b));
}

Taylor TaylorArithmetic::multiply(const Taylor& a, const Taylor& b) const {
  Taylor t;
  for (int k = 0; k <= order_; ++k) {
    t.c[k] = exactly(0);
    for (int i = 0; i <= k; ++i) t.c[k] = t.c[k] + a.c[i] * b.c[k - i];
  }
  return t;
}

Taylor TaylorArithmetic::square(const Taylor& a) const {
  Taylor t = multiply(a, a);
  t.c[0] = kerf::power(a.c[0], 2);
  return t;
}

// t b = a.
Taylor TaylorArithmetic::divide(const Taylor& a, const Taylor& b) const {
  Taylor t;
  for (int k = 0; k <= order_; ++k) {
    Interval rest = a.c[k];
    for (int i = 1; i <= k; ++i) rest = rest - b.c[i] * t.c[k - i];
    t.c[k] = rest / b.c[0];
  }
  return t;
}

// By squaring; the sign of an even power is in the range of kerf::power, not in that of a product.
Taylor TaylorArithmetic::power(const Taylor& a, int n) const {
  if (n < 0) return divide(constant(exactly(1)), power(a, -n));
  if (n == 0) return constant(exactly(1));
  if (n == 1) return a;
  Taylor t = square(power(a, n / 2));
  if (n % 2 == 1) t = multiply(t, a);
  t.c[0] = common(t.c[0], kerf::power(a.c[0], n));
  return t;
}

// a t' = p t a'.
Taylor TaylorArithmetic::power(const Taylor& a, double p) const {
  Taylor t = range(kerf::power(a.c[0], p));
  if (!(a.c[0].low > 0)) return t;
  for (int k = 1; k <= order_; ++k) {
    Interval sum = exactly(0);
    for (int i = 1; i <= k; ++i) {
      const Interval weight = exactly(p) * exactly(i) - exactly(k - i);
      sum = sum + weight * a.c[i] * t.c[k - i];
    }
    t.c[k] = sum / (exactly(k) * a.c[0]);
  }
  return t;
}

Taylor TaylorArithmetic::square_root(const Taylor& a) const {
  Taylor t = power(a, 0.5);
  t.c[0] = kerf::square_root(a.c[0]);
  return t;
}

// t' = a' t.
Taylor TaylorArithmetic::exponential(const Taylor& a) const {
  Taylor t;
  t.c[0] = kerf::exponential(a.c[0]);
  for (int k = 1; k <= order_; ++k) {
    Interval sum = exactly(0);
    for (int i = 1; i <= k; ++i) sum = sum + exactly(i) * a.c[i] * t.c[k - i];
    t.c[k] = sum / exactly(k);
  }
  return t;
}

Taylor TaylorArithmetic::logarithm(const Taylor& a) const {
  if (!(a.c[0].low > 0)) return range(kerf::logarithm(a.c[0]));
  return with_slope(a, a, kerf::logarithm(a.c[0]));
}

void TaylorArithmetic::sine_and_cosine(const Taylor& a, Taylor& s, Taylor& c) const {
  s.c[0] = kerf::sine(a.c[0]);
  c.c[0] = kerf::cosine(a.c[0]);
  for (int k = 1; k <= order_; ++k) {
    Interval sines = exactly(0), cosines = exactly(0);
    for (int i = 1; i <= k; ++i) {
      sines = sines + exactly(i) * a.c[i] * c.c[k - i];
      cosines = cosines + exactly(i) * a.c[i] * s.c[k - i];
    }
    s.c[k] = sines / exactly(k);
    c.c[k] = -(cosines / exactly(k));
  }
}

Taylor TaylorArithmetic::sine(const Taylor& a) const {
  Taylor s, c;
  sine_and_cosine(a, s, c);
  return s;
}

Taylor TaylorArithmetic::cosine(const Taylor& a) const {
  Taylor s, c;
  sine_and_cosine(a, s, c);
  return c;
}

Taylor TaylorArithmetic::with_slope(const Taylor& a, const Taylor& d, const Interval& c) const {
  Taylor t;
  t.c[0] = c;
  for (int k = 1; k <= order_; ++k) {
    Interval rest = exactly(k) * a.c[k];
    for (int i = 1; i < k; ++i) rest = rest - exactly(i) * t.c[i] * d.c[k - i];
    t.c[k] = rest / (exactly(k) * d.c[0]);
  }
  return t;
}

// t' = a' u, u = 1 - t^2.
Taylor TaylorArithmetic::hyperbolic_tangent(const Taylor& a) const {
  Taylor t, u;
  t.c[0] = growing(a.c[0], [](double v) { return std::tanh(v); });
  u.c[0] = exactly(1) - kerf::power(t.c[0], 2);
  for (int k = 1; k <= order_; ++k) {
    Interval sum = exactly(0), squares = exactly(0);
    for (int i = 1; i <= k; ++i) sum = sum + exactly(i) * a.c[i] * u.c[k - i];
    t.c[k] = sum / exactly(k);
    for (int i = 0; i <= k; ++i) squares = squares + t.c[i] * t.c[k - i];
    u.c[k] = -squares;
  }
  return t;
}

Taylor TaylorArithmetic::arc_tangent(const Taylor& y, const Taylor& x) const {
  const Interval angle = kerf::arc_tangent(y.c[0], x.c[0]);
  if (order_ == 0 || (x.c[0].low <= 0 && contains(y.c[0], 0))) return range(angle);
  const Taylor radius = add(square(x), square(y));
  Taylor t;
  t.c[0] = angle;
  // radius t' = x y' - y x'.
  for (int k = 1; k <= order_; ++k) {
    Interval rest = exactly(0);
    for (int i = 1; i <= k; ++i) rest = rest + exactly(i) * (x.c[k - i] * y.c[i] - y.c[k - i] * x.c[i]);
    for (int i = 1; i < k; ++i) rest = rest - exactly(i) * t.c[i] * radius.c[k - i];
    t.c[k] = rest / (exactly(k) * radius.c[0]);
  }
  return t;
}

}  // namespace kerf
