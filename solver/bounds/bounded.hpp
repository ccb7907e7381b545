#pragma once
// Intervals of quantities: none, sums, and those of the stress at a point.

#include "kerf/bounds.hpp"

namespace kerf {

/// No interval, and why.
Bounded lost(std::string why);

/// Minus twice an energy.
Bounded twice_energy(const EnergyBounds& e);

/// fa a + fb b.
Bounded combined(const Bounded& a, double fa, const Bounded& b, double fb);

}  // namespace kerf
