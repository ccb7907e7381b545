#pragma once
// Bounds of the energy of a body that several processes have in parts.

#include "base/sums.hpp"
#include "kerf/bounds.hpp"

namespace kerf {

/// As energy_bounds (kerf/bounds.hpp), of the whole body and the same on all processes, which call it together: each
/// adds what its own triangles contribute [theory: B.2]. `open`: asked where faces touch, and where a body force has
/// couples that the element does not see.
EnergyBounds energy_bounds(const Model& part, const Field& state, const Sums& sums, const OpenSolve& open);

}  // namespace kerf
