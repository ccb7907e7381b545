#pragma once
// Values found in another way as witnesses of bounds.

#include "kerf/bounds.hpp"

namespace kerf {

/// Where a witness lies outside, by more than it is unsure of itself, one of the two is wrong: the interval becomes an
/// estimate, and its note has both. `by`: what the witness was found from.
void confront(Bounded& b, double witness, double unsure, const char* by);

/// K by the rings about a tip, which is right to a hundredth or so on the meshes that are made for tips: unsure by 2 %
/// and the spread of the rings.
void confront(TipBounds& b, const TipIntensity& tip);

}  // namespace kerf
