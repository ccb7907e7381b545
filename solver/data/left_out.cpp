// What a polynomial of degree 4 or 7 leaves of an enclosed field over a box, and what interpolation leaves on a piece
// of an edge [theory: D.2, D.4].

#include "solver/left_out.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

// The range itself is the remainder of degree 0: width, twice its half. Degree 7 is not tried where it would have to
// gain more than a thousandfold to be of use.
LeftOut left_by_polynomial(const Enclosure& f, const Interval& x, const Interval& y,
                           const std::array<Interval, 2>& range, double enough, double useless) {
  LeftOut left{{range[0].high - range[0].low, range[1].high - range[1].low}};
  constexpr double gain = 1e3;       // of the higher degree, at most, where the box is not small
  for (const int degree : {4, 7}) {  // the lower one is twice as fast
    const double now = left.of.maxCoeff();
    if (now <= enough || (degree == 7 && now > gain * useless)) break;
    const std::array<double, 2> rest = f.remainder(x, y, degree);
    left.of = left.of.cwiseMin(Vec2(2 * rest[0], 2 * rest[1]));
    left.rough = !(std::isfinite(rest[0]) && std::isfinite(rest[1]));
  }
  return left;
}

double left_by_interpolation(double eighth, double length) {
  return eighth * std::pow(0.5 * length, 8) / 128;
}

}  // namespace kerf
