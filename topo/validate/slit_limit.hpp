#pragma once
// What a slit does to J where its tips make J converge slowly.

#include "kerf/analysis.hpp"

#include <vector>

namespace kerf {

/// Per term, with its factor, what J of the body with the slit is beyond that of the bonded one on the same mesh.
std::vector<double> changes_of_terms(const Functional& j, const Analysis& bonded, const Analysis& slit);

/// Whether J has powers of the stress above 2: at a tip sigma^p ~ r^(-p/2), so that its integral converges like
/// h^(2 - p/2) on elements of any degree. [theory: V.12]
bool slow_at_tips(const Functional& j);

/// The change of J from those on balls of n and of n/2 sides, whose edges at the tips are as 1 to 4: slow terms
/// extrapolated. [theory: V.12]
double limit_of_changes(const Functional& j, const std::vector<double>& fine, const std::vector<double>& coarse);

}  // namespace kerf
