#pragma once
// Guaranteed intervals along a path: of K and G at its tips, of the energy that growth releases, and of the life
// [theory: G.15, G.25]. The intervals of a state are those of kerf/bounds.hpp.

#include "growth/life.hpp"

namespace kerf::growth {

/// Of a state, for those of its tips that grow. K by rings is a witness: what lies outside makes an estimate. Of cracks
/// that may touch and do not, K and G are those of cracks that never do, and not guaranteed.
StateBounds bound_state(const Model& model, const State& state, std::span<const TipIntensity> tips, int threads);

/// The largest k_1 of a kink between K_I and K_II within the interval: it rises with K_I and with |K_II|.
Interval opening_bounds(const Interval& K_I, const Interval& K_II);

/// What one tip, the fastest at every step, has been through: K_I, K_II at both loads of a cycle.
struct BoundedCycles {
  double a = 0;
  TipIntervals top;
  double least = 0;  // K at the least load over that at the largest; 0 where contact closes the tip
};
/// Cycles until the last point.
LifeBounds bound_cycles(const GrowthLaw& law, std::span<const BoundedCycles> path, BetweenPoints between);

}  // namespace kerf::growth
