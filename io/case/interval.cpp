// Ranges of elementary functions over an interval, rounded outwards: monotone pieces by their ends, sines and cosines
// with the extrema that lie between the ends.

#include "io/case/interval.hpp"

namespace kerf {

Interval square_root(const Interval& a) {
  if (a.high < 0) return whole_line;
  return {a.low > 0 ? std::max(0.0, below(std::sqrt(a.low))) : 0.0, above(std::sqrt(a.high))};
}

Interval exponential(const Interval& a) {
  const Interval e = growing(a, [](double v) { return std::exp(v); });
  return {std::max(0.0, e.low), e.high};
}

Interval logarithm(const Interval& a) {
  if (a.high <= 0) return whole_line;
  const double high = above(std::log(a.high), library_ulps);
  return {a.low > 0 ? below(std::log(a.low), library_ulps) : -infinity, high};
}

Interval cosine(const Interval& a) {
  constexpr double turn = 2 * pi;
  // Beyond, the place within a turn is not known well enough.
  constexpr double most = 1e8;
  if (!(magnitude(a) < most) || width(a) >= turn) return {-1, 1};
  // Extrema lie at multiples of pi; these are known to a few units in the last place.
  constexpr double margin = 1e-7;
  // A margin too wide only adds an extremum that is not there: the range grows, and stays an enclosure.
  const double first = std::ceil(a.low / pi - margin), last = std::floor(a.high / pi + margin);
  Interval c =
      widened(std::min(std::cos(a.low), std::cos(a.high)), std::max(std::cos(a.low), std::cos(a.high)), library_ulps);
  for (double k = first; k <= last; ++k) c = hull(c, exactly(std::fmod(k, 2) == 0 ? 1 : -1));
  return {std::max(c.low, -1.0), std::min(c.high, 1.0)};
}

Interval sine(const Interval& a) {
  constexpr double most = 1e8;
  if (!(magnitude(a) < most) || width(a) >= 2 * pi) return {-1, 1};
  constexpr double margin = 1e-7;
  const double first = std::ceil(a.low / pi - 0.5 - margin), last = std::floor(a.high / pi - 0.5 + margin);
  Interval s =
      widened(std::min(std::sin(a.low), std::sin(a.high)), std::max(std::sin(a.low), std::sin(a.high)), library_ulps);
  for (double k = first; k <= last; ++k) s = hull(s, exactly(std::fmod(k, 2) == 0 ? 1 : -1));
  return {std::max(s.low, -1.0), std::min(s.high, 1.0)};
}

Interval arc_tangent(const Interval& a) {
  return growing(a, [](double v) { return std::atan(v); });
}

Interval arc_tangent(const Interval& y, const Interval& x) {
  if (x.low <= 0 && contains(y, 0)) return {-above(pi), above(pi)};
  // Around a point left out, the angle is extreme at corners of the box.
  // The box does not meet the cut along the negative axis, so that the angle is continuous on it.
  Interval angle{infinity, -infinity};
  for (const double v : {y.low, y.high})
    for (const double u : {x.low, x.high}) angle = hull(angle, exactly(std::atan2(v, u)));
  return widened(angle.low, angle.high, library_ulps);
}

Interval power(const Interval& a, int n) {
  if (n == 0) return exactly(1);
  if (n < 0) return exactly(1) / power(a, -n);
  if (n == 1) return a;
  const auto raised = [n](double v) {
    Interval product = exactly(v);
    for (int k = 1; k < n; ++k) product = product * exactly(v);
    return product;
  };
  const Interval base = n % 2 == 0 ? absolute(a) : a;
  if (!is_bounded(base)) return n % 2 == 0 ? Interval{0, infinity} : whole_line;
  const Interval low = raised(base.low), high = raised(base.high);
  return {n % 2 == 0 ? std::max(0.0, low.low) : low.low, high.high};
}

Interval power(const Interval& a, double p) {
  if (a.high < 0 || (a.low < 0 && p == std::floor(p))) return whole_line;
  const auto raised = [p](double v) { return std::pow(std::max(v, 0.0), p); };
  const double left = raised(a.low), right = raised(a.high);
  const double low = std::min(left, right), high = std::max(left, right);
  return {std::max(0.0, below(low, library_ulps)), high == infinity ? infinity : above(high, library_ulps)};
}

}  // namespace kerf
