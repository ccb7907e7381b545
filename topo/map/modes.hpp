#pragma once
// What the parts of the formula give to T at a point.

#include "kerf/validate.hpp"
#include "topo/map/point.hpp"

namespace kerf {

/// Sums to T. None for a clamped hole.
std::vector<Mode> modes_of(const Expansion& e, const PointValues& v, const Oriented& whole);

}  // namespace kerf
