#pragma once
// The saddle point on the whole body (smooth-domain formulation) [theory: C.13]: the reference that the condensed
// systems are compared with.

#include "kerf/model.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// The same discrete solution as `solve`, from the mixed saddle-point problem itself: the stress in H(div) of the whole
/// body, a crack being a set of interior edges on which it lies in the cone of contact; displacement and rotation the
/// multipliers. UMFPACK factorizes the whole system, once per contact set, so that nothing degenerates at nu = 1/2 and
/// no penalty is needed: for small problems. The certificate is that of the whole system. The factor is not used.
/// Throws Error(Usage) for an element whose normal stress does not reach all its edge moments independently, and
/// Error(Numerics) for an enclosed incompressible body on whose pressure a crack in contact depends.
State solve_saddle_point(const Model& model);

}  // namespace kerf
