#include "solver/data/left_out.hpp"

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

Vec2 left_by_polynomial(const Enclosure& f, const Interval& x, const Interval& y, const std::array<Interval, 2>& range,
                        double enough) {
  Vec2 left(range[0].high - range[0].low, range[1].high - range[1].low);
  for (const int order : {4, 8}) {  // the lower one is three times as fast
    if (left.maxCoeff() <= enough) break;
    const std::array<double, 2> rest = f.remainder(x, y, steps(x), steps(y), order);
    left = left.cwiseMin(Vec2(2 * rest[0], 2 * rest[1]));
  }
  return left;
}

bool has_derivatives(const Enclosure& f, const Interval& x, const Interval& y) {
  const std::array<double, 2> rest = f.remainder(x, y, steps(x), steps(y), 8);
  return std::isfinite(rest[0]) && std::isfinite(rest[1]);
}

double left_by_interpolation(double eighth, double length) {
  return eighth * std::pow(0.5 * length, 8) / 128;
}

}  // namespace kerf
