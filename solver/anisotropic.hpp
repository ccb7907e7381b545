#pragma once
// Orthotropic materials: matrices of their elasticity, and what a straight surface or a crack sees of it
// [theory: O.2, O.5, O.7].

#include "kerf/material.hpp"

#include <vector>

namespace kerf {

/// e11, e22, 2 e12 from s11, s22, s12; and its inverse. The latter needs c > 0.
Eigen::Matrix3d strain_matrix(const Material& m);
Eigen::Matrix3d stress_matrix(const Material& m);

/// Half the least and half the largest stress of a strain of size 1: 2 least |e|^2 <= C e : e <= 2 largest |e|^2.
/// Where isotropic both are mu, the modulus of shear.
struct ShearModuli {
  double least, largest;
};
ShearModuli shear_moduli(const Material& m);

/// The compliances b_ij of Lekhnitskii along x, y.
struct PlaneCompliances {
  double b11, b22, b12, b66, b16, b26;
};
PlaneCompliances compliances(const Material& m);

/// Roots with a positive imaginary part of b11 p^4 - 2 b16 p^3 + (2 b12 + b66) p^2 - 2 b26 p + b22: functions of
/// x + p y solve the equations. Equal in isotropic bodies; sum and product are exact to rounding however near they are.
using Roots = std::array<std::complex<double>, 2>;
Roots roots(const Material& m);

/// (x, y) -> x + p y of the roots p of all orthotropic materials: maps after which their fields are as smooth as those
/// of isotropic bodies.
std::vector<Mat2> smooth_images(const std::vector<Material>& materials);

/// Barnett's and Lothe's L^-1 and S L^-1 = w (0, -1; 1, 0). A crack with the factors K = (K_II, K_I) opens by
/// sqrt(8 r/pi) L^-1 K and releases G = K . L^-1 K/2; the rim of a free hole moves by a linear function of x.
struct Surface {
  Mat2 inverse_L;
  double w;
};
Surface surface(const Material& m);

}  // namespace kerf
