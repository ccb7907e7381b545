#pragma once
// Derivative of J by the stiffness of a region [theory: S.6].

#include "kerf/analysis.hpp"

namespace kerf {

/// dJ/dE of a region with Young's modulus E and fixed Poisson's ratio, from the adjoint already there: compliances are
/// A = A_1/E, so that dJ = d_E j - (A sigma, zeta)/E over the region, +1/(2E) (A sigma, sigma) for each energy; exact
/// for the discrete J. d_E j: what densities see of the material itself (strains, displacements recovered from them),
/// by central differences at fixed coefficients.
/// `model`: that of the analysis; its material is varied and put back.
/// Throws Error(Usage) as require_supports.
double young_gradient(const Analysis& a, const Functional& j, Model& model, Index region, double young);

}  // namespace kerf
