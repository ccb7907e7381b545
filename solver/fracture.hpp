#pragma once
// Stress intensity factors and energy release rate at crack tips, by interaction integrals around the tips.

#include "solver/model.hpp"

namespace kerf {

/// One end of a crack that lies inside the body. K in stress x sqrt(length): ahead of the tip s_yy = K_I/sqrt(2 pi r),
/// s_xy = K_II/sqrt(2 pi r) in the frame whose x axis extends the crack and whose y axis is x turned by +90 degrees.
/// G, J in stress x length. K_I, K_II, G, J and spread are NaN where no domain fits: see crack_tips.
struct TipIntensity {
  Index crack = 0;
  bool at_start = false;  // of the crack's path
  Vec2 at = Vec2::Zero();
  double K_I = 0, K_II = 0, G = 0;
  double J = 0;       // the domain J integral: equals G up to the discretisation, computed without K
  double radius = 0;  // outer radius of the domain used
  double spread = 0;  // largest difference of K between rings of different radius, relative to the largest |K|
};

/// Tips of all cracks, in the order of the cracks, start before end; ends on the boundary or on a hole are no tips.
/// Right on faces in contact: the auxiliary opening works against the contact pressure (face term). Under unilateral
/// contact K_I >= 0, and exactly 0 where contact closes the tip. Contact that begins within the first edge from a tip
/// that is open at the very end is not resolved.
///
/// Three rings with outer radii 1, 4/5 and 3/5 of R; K, G, J and radius are those of the middle one. R is 9/10 of the
/// distance to the nearest boundary, hole, other crack, kink or other end of the same crack: the field is that of one
/// straight crack inside. Where R spans fewer than 3/2 elements the values are NaN and radius 0. The mesh should have
/// five or more elements along R; `spread` tells.
std::vector<TipIntensity> crack_tips(const Model& model, const State& state);

}  // namespace kerf
