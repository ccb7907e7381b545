#pragma once
// Intervals of -J'(0) from energies J(k) of a body whose cracks may be in contact, under the loads L + k l
// [theory: B.15, B.16]. Nothing is assumed about where the cracks are closed.

#include "kerf/field.hpp"

namespace kerf {

/// Bounds of an energy.
struct Enclosed {
  double lower = -infinity, upper = infinity;
};

/// J(-k) and J(k), k > 0, and the works of the pressure of the one's admissible stress on the opening of the other's
/// admissible displacement.
struct LoadSteps {
  double k = 0;
  Enclosed less, more;
  double less_on_more = infinity, more_on_less = infinity;
};

/// The energies of w, the solution under l alone: at least `open` with all faces free, at most `tied` with faces that
/// slide and neither open nor overlap. J(k) - k^2 open is convex, J(k) - k^2 tied is concave.
struct Curvature {
  double open = -infinity, tied = infinity;
};

/// Theorem 1, by chords of J and its curvature.
Interval by_concavity(const LoadSteps& steps, const Enclosed& zero, const Curvature& curvature);
/// Theorem 2, by the crossed works.
Interval by_crossed_works(const LoadSteps& steps);

Interval intersection(const Interval& a, const Interval& b);

}  // namespace kerf
