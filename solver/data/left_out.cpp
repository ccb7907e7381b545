#include "solver/left_out.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// From the middle to all of it.
Interval steps(const Interval& of) {
  constexpr double rounding = 1e-14;
  const double half = 0.5 * (of.high - of.low) * (1 + rounding);
  return {-half, half};
}

}  // namespace

LeftOut left_by_polynomial(const Enclosure& f, const Interval& x, const Interval& y,
                           const std::array<Interval, 2>& range, double enough) {
  LeftOut left{{range[0].high - range[0].low, range[1].high - range[1].low}};
  for (const int order : {4, 8}) {  // the lower one is three times as fast
    if (left.of.maxCoeff() <= enough) break;
    const std::array<double, 2> rest = f.remainder(x, y, steps(x), steps(y), order);
    left.of = left.of.cwiseMin(Vec2(2 * rest[0], 2 * rest[1]));
    left.rough = !(std::isfinite(rest[0]) && std::isfinite(rest[1]));
  }
  return left;
}

double left_by_interpolation(double eighth, double length) {
  return eighth * std::pow(0.5 * length, 8) / 128;
}

}  // namespace kerf
