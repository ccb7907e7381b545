#pragma once
// The order in which load cases are summed: that of their names, so that no sum, no gradient and no verdict hangs, not
// even by rounding, on how the tables of a case stand.

#include "kerf/optimize.hpp"

namespace kerf {

std::vector<LoadCase> by_name(std::vector<LoadCase> cases);
/// The one whose state a run shows where it shows one. There must be one.
const LoadCase& shown(const std::vector<LoadCase>& cases);

/// The request with its load cases by name.
OptimizeRequest in_order(OptimizeRequest request);

}  // namespace kerf
