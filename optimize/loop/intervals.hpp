#pragma once
// Intervals of the release rates and stresses that a design is bound by, from two-sided bounds of energies.

#include "optimize/loop/evaluate.hpp"

namespace kerf {

/// Per bound of a design that was solved: what it lies in under the worst of the load cases [theory: B.11, B.25]. A
/// release rate along its crack has an interval, the integral of the squared von Mises stress an upper bound; sums of
/// them and of volumes, too. Of others that count stress: a note. Of all else: nothing, not even a note.
std::vector<Bounded> intervals_of(const Evaluated& e, int threads);

}  // namespace kerf
