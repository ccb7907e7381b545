#pragma once
// A small clamped hole: u = 0 on a circle of radius eps. J changes like 1/ln(1/eps), too slowly for a leading term to
// be of use; the formula renormalized by the body's own Green tensor has an error O(eps^2) [theory: T.29].

#include "kerf/scene.hpp"

namespace kerf {

/// kappa = 1 + 8 mu c, 3 - 4 nu in plane strain.
double kolosov(const Material& m);
/// 1/(2 pi mu (1 + kappa)), what multiplies Kelvin's solution.
double flexibility(const Material& m);

/// Kelvin's G at r from a unit force, displacement per force [theory: T.26]:
/// G_ij = (kappa ln(1/|r|) d_ij + r_i r_j/|r|^2)/(2 pi mu (1 + kappa)); column j belongs to the force e_j.
Mat2 kelvin(const Material& m, const Vec2& r);
/// The stress of G e_j, symmetric; its tractions on a circle around the force sum to -e_j [theory: T.27].
Mat2 kelvin_stress(const Material& m, const Vec2& r, int j);

/// M(eps): the mean displacement of the rim is u0 - M F, F the force of the body on the clamp. hreg is the regular
/// part of the body's Green tensor at the center (its w: div s(w_j) = 0, w_j = -G e_j on supports, s(w_j) n =
/// -s(G e_j) n on free sides; column j is w_j at the center).
Mat2 clamped_matrix(const Material& m, double eps, const Mat2& hreg);

/// Whether the symmetric part of M is positive definite: eps is not too large.
bool admits_clamp(const Mat2& clamped_matrix);

/// F = M^-1 u0, u0 the displacement of the undisturbed body at the center. Then u_eps ~ u - G(. - x) F, the energy
/// changes by 1/2 u0.F, a J that is linear in u by -p0.F (mixed sign). Throws (Numerics) where M is not positive
/// definite: eps is too large.
Vec2 clamped_force(const Material& m, double eps, const Mat2& hreg, const Vec2& u0);

}  // namespace kerf
