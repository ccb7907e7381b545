#pragma once
// What a series of finite radii says about an expansion.

#include "kerf/validate.hpp"

namespace kerf {

/// Orders, fit and verdict from rows with J and difference filled in (NaN: not computed). `clear` is the distance to
/// the next feature. [theory: V.7, V.8]
void judge(Validation& v, const Perturbation& p, const std::vector<double>& scale, double clear);

}  // namespace kerf
