#pragma once
// Up to which radius the first term of the expansion is good.

#include "kerf/map.hpp"
#include "kerf/second_order.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

/// What is known of the series at a point: T, c2 with its error, the sum |.| of the parts of c2, and the distance to
/// the next feature (what bounds the body, cracks, materials, jumps of the data).
struct SeriesKnown {
  double T, c2, unsure, parts, clear;
};

/// The radius up to which what follows T is at most 5 % of it [theory: Q.14]: (|c2| + unsure) r^2 + parts^2/|T| r^4 =
/// share |T|, and no more than a quarter of the way to the next feature. The parts of c2 may cancel, those of the next
/// term need not: their size is what the parts say. 0 where T vanishes; NaN where c2 is not known.
inline double valid_radius_of(const SeriesKnown& k) {
  constexpr double share = 0.05;
  if (!std::isfinite(k.c2) || !std::isfinite(k.T)) return nan;
  if (k.parts == 0 && k.T != 0) return k.clear;  // the series ends with its first term
  const double T = std::abs(k.T);
  if (T == 0) return 0;
  const double a = (std::abs(k.c2) + k.unsure) / T, b = std::pow(k.parts / T, 2);
  const double square = 2 * share / (a + std::sqrt(a * a + 4 * b * share));
  return std::min(std::sqrt(square), k.clear / clear_radii);
}

inline double parts_of(const SecondOrder& s) {
  return std::abs(s.mean_gradient) + std::abs(s.deviator_gradient) + std::abs(s.curvature) + std::abs(s.reply);
}

}  // namespace kerf
