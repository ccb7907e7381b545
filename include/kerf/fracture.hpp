#pragma once
// Stress intensity factors, T-stress and energy release rate at crack tips, by interaction integrals around the tips
// [theory: F.5].

#include "kerf/state.hpp"

namespace kerf {

/// One end of a crack that lies inside the body. K in stress x sqrt(length): ahead of the tip s_yy = K_I/sqrt(2 pi r),
/// s_xy = K_II/sqrt(2 pi r) in the frame whose x axis extends the crack and whose y axis is x turned by +90 degrees.
/// T = s_xx - s_yy of the constant terms there, in stress; at an open tip s_yy has none, or minus the pressure in the
/// crack. G, J in stress x length. All but crack, at_start and at are NaN, radius 0, where no domain fits (see
/// crack_tips). T is NaN at a closed tip in an orthotropic material.
struct TipIntensity {
  Index crack = 0;
  bool at_start = false;  // of the crack's path
  Vec2 at = Vec2::Zero();
  double K_I = 0, K_II = 0, T = 0, G = 0;
  double J = 0;  // the domain J integral less the work of friction and of a fluid: equals G up to the discretization
  double radius = 0;  // outer radius of the domain used
  // Largest differences between rings of different radius: of K relative to its norm or, if that is more, the mean
  // stress of the body times sqrt(pi radius); of T relative to |T| or that stress. `spread` is the larger one of K.
  // With Coulomb's friction spread_K_II holds, besides, what false pressure beside the tip may have done to all rings,
  // and the difference between J and G [theory: F.8]: an estimate of the error.
  double spread = 0, spread_K_I = 0, spread_K_II = 0, spread_T = 0;
  bool on_border = false;  // between materials, where stresses grow like another power of the distance: no values
  Index region = none;     // in which it lies; of crack_tips
};

/// Tips of all cracks, in the order of the cracks, start before end; ends on the boundary, on a hole or on another
/// crack are no tips. Right on faces in contact: the auxiliary opening works against the contact pressure and the
/// auxiliary slip against friction (face terms). Under unilateral contact K_I >= 0, and exactly 0 where contact closes
/// the tip; in orthotropic materials that holds for the opening L^-1 K instead [theory: O.12]. A gap before loading
/// lowers that bound [theory: F.9]: where it keeps the faces apart up to the tip, K_I may have any sign. Contact that
/// begins within the first edge from a tip that is open at the very end is not resolved: behind a gap it is in
/// spread_K_I.
///
/// Three rings with outer radii 1, 4/5 and 3/5 of R; K, T, G, J and radius are those of the middle one. R is 9/10 of
/// the distance to the nearest boundary, hole, other crack, other material, kink or other end of the same crack, and on
/// a curved crack to where it has turned by half a radian. A crack is curved where its edges are chords of a smooth
/// curve: then the frame is that of the curve. Where R spans fewer than 3/2 elements the values are NaN and radius 0.
/// The mesh should have five or more elements along R; the spreads tell: beyond 0.01 do not trust the value.
std::vector<TipIntensity> crack_tips(const Model& model, const Field& state);

}  // namespace kerf
