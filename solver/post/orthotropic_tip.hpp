#pragma once
// Fields about a crack tip in an orthotropic material. Internal to this room.

#include "solver/anisotropic.hpp"
#include "solver/post/polynomial_state.hpp"

#include <array>

namespace kerf {

/// As tip_fields: of unit K_I, of unit K_II [Sih, Paris, Irwin 1965], of a unit force along
/// x, at x in the frame of the tip and at that angle. `m` as seen in that frame. Roots of the material may be equal
/// [theory: O.9, O.10, O.11].
std::array<LocalState, 3> orthotropic_tip_fields(const Material& m, const Vec2& x, double angle);

/// K_I, K_II from the integrals with the first two fields: K = L I. At a tip that contact may close the opening
/// (L^-1 K)_n is not below `least`, 0 without a gap; where it closes, K_I is what slides with K_II [theory: O.12].
Vec2 orthotropic_factors(const Material& m, const Vec2& integrals, double least);

/// K . L^-1 K/2 of K_I, K_II.
double orthotropic_release(const Material& m, const Vec2& K);

/// s_11 - s_22 of the constant state whose integral with the third field is `integral` and whose tractions s_12, s_22
/// on the faces are known.
double orthotropic_t_stress(const Material& m, double integral, const Vec2& traction);

}  // namespace kerf
