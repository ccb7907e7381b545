#pragma once
// What a step of growth decides: how far each tip goes, and which way the load goes [theory: G.22, G.23].

#include "kerf/types.hpp"

#include <span>
#include <vector>

namespace kerf::growth {

/// Fatigue: how far tips go that compete.
struct Advances {
  std::vector<double> lengths;  // per tip, the fastest one's is the longest; 0 where it rests
  bool all_rest = false;        // no tip is above its threshold
  bool runs = false;            // a rate is infinite: those tips go, all others stay
};
/// da_i = longest rate_i/max rate. Throws Error (Usage) for a negative rate or one that is no number.
Advances advance(std::span<const double> rates, double longest);

/// Where quasi-static growth stands: the load factor at which the crack moves, and the displacement of the loads there
/// (their work over the load; 2 |potential energy|/load_factor where loads alone act).
struct LoadPoint {
  double load_factor = 0, displacement = 0;
};
enum class Course {
  Stable,     // the load has to grow
  LoadFalls,  // unstable under given loads, stable under given displacements
  SnapBack    // unstable under both
};
/// From one length of a crack to the next.
Course course(const LoadPoint& before, const LoadPoint& after);

/// int G da along a path, the energy that growth takes, with the difference to that by every second point (not a number
/// for two points) [theory: G.25].
struct ReleasedEnergy {
  double energy = 0, error = 0;
};
ReleasedEnergy released_energy(std::span<const double> a, std::span<const double> G);
/// Bounds of it by bounds of G at the points, if G is between its values at the ends of each step: a theorem then.
struct ReleasedBounds {
  double lower = 0, upper = 0;
};
ReleasedBounds bound_released_energy(std::span<const double> a, std::span<const double> G_lower,
                                     std::span<const double> G_upper);

}  // namespace kerf::growth
