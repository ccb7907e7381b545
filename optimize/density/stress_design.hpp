#pragma once
// The density stage of designs with a bound on their largest stress.

#include "optimize/density/density.hpp"

namespace kerf {

/// Whether a bound of the request is one on a largest stress.
bool bounds_largest_stress(const OptimizeRequest& r);

/// From the full body to a density of least J (area and compliance, as far as the lattice knows J) under the bounds on
/// largest stresses, compliances and area. One design; the same bits for any number of threads. Throws Error(Usage)
/// where there is no density stage, Error(Numerics) when the lattice cannot be solved.
DensityDesign stress_design(const Problem& p, const OptimizeRequest& r);

}  // namespace kerf
