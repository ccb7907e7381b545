#pragma once
// Derivative of J when the body itself moves, from the same adjoint as its topological derivative.

#include "kerf/analysis.hpp"

namespace kerf {

/// Distributed form: dJ(theta) = sum_v column(v) . theta(x_v) for every theta that is linear on the triangles of the
/// model's mesh; 2 x vertices. With the mixed fields sigma, D_u = A sigma + Gamma(omega) in place of grad u, the same
/// of the adjoint (zeta, p, rho; mixed sign), G = grad theta and a density j [theory: S.3]:
///   dJ(theta) = int j div theta + d_x j.theta + j_sigma:(sigma G' - sigma div theta)
///             + int D_u:(zeta G') + (A zeta + Gamma(rho)):(sigma G') - (A sigma:zeta) div theta + p.f div theta + ...
///   dPi(theta) = - int [D_u:(sigma G') - 1/2 (A sigma:sigma) div theta + u.f div theta + u.(grad f theta)]
/// It is the derivative of the discrete J when the vertices of the mesh move (to rounding), because the Piola
/// transformation maps the spaces of these elements onto themselves; finite at nu = 1/2. Regions, labels and cracks
/// move with their vertices. Data are functions of the place and stay where they are: a moved edge meets the traction,
/// the displacement, the target that stand at its new place, and its own new normal. So do the normal of a curved crack
/// (CrackLaw::normal), the body force, weights, and the ring of an energy release rate, whose place does not matter to
/// G as long as it surrounds the tip, moving or not. Where contact is about to change (Analysis::biactive) J has
/// one-sided derivatives only; this is the one of a crack that opens there. Throws Error(Usage) for elements other than
/// bdms, bdms-c, peers, afw, and as require_supports; Error(Numerics) where the derivative is not finite because data
/// are not.
Points shape_gradient(const Analysis& a, const Functional& j);

/// Boundary form: dJ(theta) = int g theta.n over the edges of the boundary that carry no traction, where only the
/// tangential stress is left: s = sigma_tt, z = zeta_tt, 1/E' of material.hpp [theory: S.4, S.5],
///   g = j - s j_sigma,tt - s z/E' + f.p,   energies: s^2/(2 E') - f.u,   compliance: 2 f.u - s^2/E',
/// with the recovered stresses (Analysis::fields, made anew where missing) and u*. An approximation, better the
/// smoother the stress: in corners of less than pi inside the body, at ends of supports and loads it is not integrable
/// by this. Edges that a support, a traction, a boundary functional or measured data name are left out: there the
/// derivative has more than this; use shape_gradient.
struct BoundaryGradient {
  struct Point {
    Index edge;
    Vec2 at, normal;  // out of the body
    double weight;    // length that the point stands for
    double density;   // g
  };
  std::vector<Point> points;  // two per edge, in the order of the edges
};
BoundaryGradient boundary_gradient(const Analysis& a, const Functional& j);

}  // namespace kerf
