// The two intervals of -J'(0) from bounds of the energies J(-k), J(0), J(k): by concavity [theory: B.15] and by crossed
// works [theory: B.16]. Every energy enters on the side that makes the interval wider.

#include "solver/bounds/load_steps.hpp"

#include <algorithm>

namespace kerf {

Interval intersection(const Interval& a, const Interval& b) {
  return {std::max(a.low, b.low), std::min(a.high, b.high)};
}

/// Three pairs: two chords to 0 with the curvature of one side each, and the central difference with half of the
/// difference.
Interval by_concavity(const LoadSteps& s, const Enclosed& zero, const Curvature& c) {
  const double k = s.k;
  // The tangent of J(k) - k^2 tied at 0 lies above it, that of J(k) - k^2 open below.
  const Interval above{(s.less.lower - zero.upper) / k - k * c.tied, (zero.upper - s.more.lower) / k + k * c.tied},
      below{(zero.lower - s.more.upper) / k + k * c.open, (s.less.upper - zero.lower) / k - k * c.open};
  const double bend = 0.5 * k * (c.tied - c.open);
  const Interval middle{(s.less.lower - s.more.upper) / (2 * k) - bend, (s.less.upper - s.more.lower) / (2 * k) + bend};
  return intersection(intersection(above, below), middle);
}

Interval by_crossed_works(const LoadSteps& s) {
  return {(s.less.lower - s.more.upper - s.less_on_more) / (2 * s.k),
          (s.less.upper - s.more.lower + s.more_on_less) / (2 * s.k)};
}

}  // namespace kerf
