#pragma once
// The error indicator of a body that several processes have in parts.

#include "base/sums.hpp"
#include "kerf/adaptive.hpp"

namespace kerf {

/// As error_indicator (kerf/adaptive.hpp): `eta` per triangle here, `relative`, `error` and `stress` of the whole body
/// and the same on all processes, which call it together.
Indicator error_indicator(const Model& part, const State& state, const Sums& sums);

}  // namespace kerf
