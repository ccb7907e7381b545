#pragma once
// Interval arithmetic, rounded outwards: the result holds every value that its operands allow.

#include "kerf/field.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

inline constexpr Interval whole_line{-infinity, infinity};

/// A number beyond the rounding error of one operation; `ulps` of them.
inline double below(double v, double ulps = 1) {
  constexpr double eps = std::numeric_limits<double>::epsilon(), least = std::numeric_limits<double>::denorm_min();
  if (v == infinity) return std::numeric_limits<double>::max();
  return v - ulps * (std::abs(v) * eps + least);
}
inline double above(double v, double ulps = 1) {
  return -below(-v, ulps);
}
inline Interval widened(double low, double high, double ulps = 1) {
  if (std::isnan(low) || std::isnan(high)) return whole_line;
  return {below(low, ulps), above(high, ulps)};
}

inline Interval exactly(double v) {
  return {v, v};
}
inline bool is(const Interval& a, double v) {
  return a.low == v && a.high == v;
}
inline bool contains(const Interval& a, double v) {
  return a.low <= v && v <= a.high;
}
inline bool is_bounded(const Interval& a) {
  return a.low > -infinity && a.high < infinity;
}
inline double width(const Interval& a) {
  return a.high - a.low;
}
inline double middle(const Interval& a) {
  return 0.5 * a.low + 0.5 * a.high;
}
/// Largest magnitude.
inline double magnitude(const Interval& a) {
  return std::max(std::abs(a.low), std::abs(a.high));
}
inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}
/// Two enclosures of the same numbers.
inline Interval common(const Interval& a, const Interval& b) {
  const Interval c{std::max(a.low, b.low), std::min(a.high, b.high)};
  return c.low <= c.high ? c : a;
}

// Zeros and ones are exact, so that the derivatives of polynomials vanish exactly.
inline Interval operator-(const Interval& a) {
  return {-a.high, -a.low};
}
inline Interval operator+(const Interval& a, const Interval& b) {
  if (is(a, 0)) return b;
  if (is(b, 0)) return a;
  return widened(a.low + b.low, a.high + b.high);
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return a + -b;
}
inline Interval operator*(const Interval& a, const Interval& b) {
  if (is(a, 0) || is(b, 0)) return exactly(0);
  if (is(a, 1)) return b;
  if (is(b, 1)) return a;
  const auto product = [](double p, double q) { return p == 0 || q == 0 ? 0.0 : p * q; };
  const double ll = product(a.low, b.low), lh = product(a.low, b.high), hl = product(a.high, b.low),
               hh = product(a.high, b.high);
  return widened(std::min(std::min(ll, lh), std::min(hl, hh)), std::max(std::max(ll, lh), std::max(hl, hh)));
}
inline Interval operator/(const Interval& a, const Interval& b) {
  if (is(b, 1)) return a;
  if (b.low <= 0 && b.high >= 0) {
    if (is(b, 0) || (b.low < 0 && b.high > 0)) return whole_line;
    // The divisor touches 0 from one side.
    if (a.low > 0)
      return b.low == 0 ? Interval{below(a.low / b.high), infinity} : Interval{-infinity, above(a.low / b.low)};
    if (a.high < 0) return -(-a / b);
    return whole_line;
  }
  if (is(a, 0)) return a;
  // Of two infinite ends the quotient may be any number between 0 and what the other end of b gives.
  const auto quotient = [](double p, double q) { return std::isinf(q) ? 0.0 : p / q; };
  const double ll = quotient(a.low, b.low), lh = quotient(a.low, b.high), hl = quotient(a.high, b.low),
               hh = quotient(a.high, b.high);
  return widened(std::min(std::min(ll, lh), std::min(hl, hh)), std::max(std::max(ll, lh), std::max(hl, hh)));
}

inline Interval absolute(const Interval& a) {
  if (a.low >= 0) return a;
  if (a.high <= 0) return -a;
  return {0, std::max(-a.low, a.high)};
}

// Functions of the C library are trusted to a few units in the last place.
inline constexpr double library_ulps = 4;

/// Of a function that grows everywhere.
template <typename Function>
Interval growing(const Interval& a, Function&& f) {
  return widened(f(a.low), f(a.high), library_ulps);
}
Interval square_root(const Interval& a);
Interval exponential(const Interval& a);
Interval logarithm(const Interval& a);
Interval sine(const Interval& a);
Interval cosine(const Interval& a);
Interval arc_tangent(const Interval& a);
/// The whole line where the cut along the negative axis is in reach.
Interval arc_tangent(const Interval& y, const Interval& x);
/// a^n.
Interval power(const Interval& a, int n);
/// a^p for a >= 0; of what lies below 0 nothing is said but where it is a rounding error.
Interval power(const Interval& a, double p);

}  // namespace kerf
