#pragma once
// What polynomials leave of a field that is known by enclosures.

#include "kerf/field.hpp"

namespace kerf {

struct LeftOut {
  Vec2 of;  // of each component
  /// Nothing is known of a derivative: a finer look may not settle f.
  bool rough = false;
};
/// Over a box at most: twice the distance of each component from a polynomial of degree 7 in the place, or the width of
/// its range, which is `range`; no better than `enough`, and only roughly where it would be more than `useless` in any
/// case. What a rule makes of the rest, and the rest itself, are together at most this times the sum of the weights
/// [theory: D.4].
LeftOut left_by_polynomial(const Enclosure& f, const Interval& x, const Interval& y,
                           const std::array<Interval, 2>& range, double enough, double useless = infinity);

/// A polynomial of degree 7 differs on a piece of this length from f by at most this, |f^(8)|/8! <= eighth: its values
/// at Chebyshev's points [theory: D.2].
double left_by_interpolation(double eighth, double length);

}  // namespace kerf
