#pragma once
// A carved design as curves, and what these have to leave as it is.

#include "optimize/curves.hpp"
#include "optimize/curves/design_curves.hpp"

namespace kerf {

double curve_size(const Problem& p, const CurvesRequest& how);

/// What must stay solid inside the body: frozen loops, and the rings of functionals.
std::vector<Loop> solid_loops(const Problem& p, const OptimizeRequest& r);

/// Chains within the tolerance, or finer ones with a note, that make a shape. Throws Error(Geometry) when none do.
DesignCurves fitted_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how,
                           std::vector<std::string>& notes);

}  // namespace kerf
