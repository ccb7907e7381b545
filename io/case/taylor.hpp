#pragma once
// Taylor coefficients f^(k)/k!, k <= order, as intervals that hold them everywhere on a piece [Moore 1966].

#include "io/case/interval.hpp"

namespace kerf {

inline constexpr int taylor_order = 8;

/// c[0] is the range. Coefficients beyond the order that was asked for are not touched.
struct Taylor {
  std::array<Interval, taylor_order + 1> c;
};

/// Arithmetic up to an order; 0 is plain interval arithmetic. What has no derivatives has the whole line for them.
class TaylorArithmetic {
 public:
  explicit TaylorArithmetic(int order) : order_(order) {}

  Taylor constant(const Interval& value) const;
  /// Nothing is known but the values.
  Taylor range(const Interval& value) const;
  Taylor add(const Taylor& a, const Taylor& b) const;
  Taylor subtract(const Taylor& a, const Taylor& b) const;
  Taylor negate(const Taylor& a) const;
  Taylor multiply(const Taylor& a, const Taylor& b) const;
  Taylor square(const Taylor& a) const;
  Taylor divide(const Taylor& a, const Taylor& b) const;
  Taylor power(const Taylor& a, int n) const;
  Taylor power(const Taylor& a, double p) const;
  Taylor square_root(const Taylor& a) const;
  Taylor exponential(const Taylor& a) const;
  Taylor logarithm(const Taylor& a) const;
  Taylor sine(const Taylor& a) const;
  Taylor cosine(const Taylor& a) const;
  /// With c' = a' / d and the range c.
  Taylor with_slope(const Taylor& a, const Taylor& d, const Interval& c) const;
  Taylor hyperbolic_tangent(const Taylor& a) const;
  /// (x y' - y x')/(x^2 + y^2).
  Taylor arc_tangent(const Taylor& y, const Taylor& x) const;

 private:
  void sine_and_cosine(const Taylor& a, Taylor& s, Taylor& c) const;
  int order_;
};

}  // namespace kerf
