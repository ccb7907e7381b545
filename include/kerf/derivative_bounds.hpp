#pragma once
// Guaranteed intervals of T at a point, from those of the stress there.

#include "kerf/analysis.hpp"
#include "kerf/bounds.hpp"
#include "kerf/perturbation.hpp"

namespace kerf {

/// T = -energy_share/2 form(s, s) [theory: T.3, T.10] of a circular hole or inclusion, for J that is the energy or the
/// compliance (Analysis::energy_share alone) of a body without body force. Otherwise `note` says why there is none.
Bounded derivative_bounds(const Analysis& analysis, const Perturbation& perturbation, const Vec2& x,
                          const StressBounds& stress);

}  // namespace kerf
