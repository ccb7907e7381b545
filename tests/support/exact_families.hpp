#pragma once
// Exact fields beside those of exact.hpp: collinear cracks, friction, a crack along an arc, corners, holes, an
// inclusion. Each sets `ExactField::side`.

#include "tests/support/exact_field.hpp"

#include <complex>

namespace kerf::exact {

using Complex = std::complex<double>;

/// kappa: plane strain 3 - 4 nu, plane stress (3 - nu)/(1 + nu).
double kolosov(const Material& material);

/// Goursat's functions and their derivatives: sxx + syy = 4 Re dphi, syy - sxx + 2i sxy = 2 (conj(z) ddphi + dpsi),
/// 2 mu u = kappa phi - z conj(dphi) - conj(psi).
struct Potentials {
  Complex phi, dphi, ddphi, psi, dpsi;
};
/// In the frame at `center` whose x axis is turned by `angle`; side as in ExactField.
ExactField from_potentials(std::string name, const Material& material, const Vec2& center, double angle,
                           const std::function<Potentials(const Complex& z, int side)>& potentials);

/// Open cracks inner < |x| < outer on the x axis under the far stress s_yy = tension, s_xx = along. `opening` takes x;
/// tips from left to right.
struct TwoCracks {
  double inner = 0.3, outer = 1.3, tension = 1, along = 0;
};
ExactField two_cracks(std::string name, const Material& material, const TwoCracks& cracks);

/// Closed crack, center at the origin, whose faces carry shear up to `limit`: Coulomb with limit = friction times
/// pressure, or Tresca. Throws std::invalid_argument where the far stress opens it.
struct FrictionCrack {
  Mat2 far_stress;
  double angle = 0, half = 1, limit = 0;
};
/// `shear`: n.sigma t on the crack.
struct FrictionField {
  ExactField field;
  double shear;
};
FrictionField friction_crack(std::string name, const Material& material, const FrictionCrack& crack);

/// Open crack |x| = radius, |arg x - middle| < half_angle < pi; its path turns clockwise, so that n points outwards.
/// Not closer than 1e-4 radius to the origin.
struct ArcCrack {
  Mat2 far_stress;
  double radius = 1, half_angle = 0.5, middle = 0;
};
ExactField arc_crack(std::string name, const Material& material, const ArcCrack& crack);

/// Leading terms at the corner of a body that fills |arg x - bisector| < opening/2, faces free, at the origin:
/// s_tt = k1 (2 pi r)^(l1 - 1), s_rt = k2 (2 pi r)^(l2 - 1) on the bisector. T stress for opening = 2 pi only. One tip.
struct Corner {
  double opening, bisector = 0, k1 = 0, k2 = 0, t_stress = 0;
};
ExactField corner(std::string name, const Material& material, const Corner& corner);
/// The exponent l of r^l in (1/2, 1): mode 1 (symmetric) or 2. Throws std::invalid_argument where there is none.
double corner_exponent(double opening, int mode);

/// Free elliptic hole at the origin, the first semi-axis turned by `angle` and not the shorter one.
struct EllipticHole {
  Mat2 far_stress;
  Vec2 semi_axes;
  double angle = 0;
};
ExactField inglis(std::string name, const Material& material, const EllipticHole& hole);

/// Disc |x| < outer under the traction `stress` n on its rim, no rotation, with a hole |x| < inner under a pressure or
/// a bonded inclusion there.
struct Annulus {
  Mat2 stress;
  double inner, outer, pressure = 0;
};
ExactField annulus(std::string name, const Material& material, const Annulus& ring);
struct TwoPhases {
  ExactField outside, inside;
};
TwoPhases inclusion(std::string name, const Material& matrix, const Material& inside, const Annulus& ring);

/// The field of a table of data/exact by the name of its file, E = 1000, nu = 0.3: c06, c07, c08b, c09, c11, c13.
FrictionField friction_table(const std::string& id);
ExactField family_field(const std::string& id);

}  // namespace kerf::exact
