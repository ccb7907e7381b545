#pragma once
// What a body with curved sides loses when the mesh draws them by chords.

#include "kerf/adaptive.hpp"

namespace kerf {

/// Adds to the indicator what the stress of the polygon lacks near the chords of curved sides [theory: R.10].
void add_chords(const Shape& shape, const Model& model, const State& state, Indicator& indicator);

}  // namespace kerf
