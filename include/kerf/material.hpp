#pragma once
// What the body is made of.

#include "kerf/types.hpp"

#include <array>
#include <complex>

namespace kerf {

/// Plane elasticity, strain = A s. Isotropic in two numbers: A s = dev(s)/(2 mu) + c tr(s) I, traces in 2D. c = 0 is
/// the incompressible limit of plane strain. What an orthotropic material adds, with D = s11 - s22 + 2i s12, k =
/// coupling axis, l = split axis^2 [theory: O.2]:
///   tr e += 2 Re(conj(k) D),   e11 - e22 + 2i e12 += 2 k tr(s) + 2 l conj(D).
struct Material {
  double mu = 1;
  double c = 0.1;                      // nu = 0.3 in plane strain
  double coupling = 0, split = 0;      // per stress; 0: isotropic
  std::complex<double> axis = {1, 0};  // e^(2i angle) of material axis 1 from x
};

constexpr bool isotropic(const Material& m) {
  return m.coupling == 0 && m.split == 0;
}

constexpr Material plane_strain(double young, double poisson) {
  const double mu = young / (2 * (1 + poisson));
  return {mu, (1 - 2 * poisson) / (4 * mu)};
}
constexpr Material plane_stress(double young, double poisson) {
  const double mu = young / (2 * (1 + poisson));
  return {mu, (1 - poisson) / (4 * mu * (1 + poisson))};
}

/// Constants of the plane problem along the material's axes: e11 = s11/E1 - nu12 s22/E1, e22 = s22/E2 - nu12 s11/E1,
/// 2 e12 = s12/G12. `angle` of axis 1 from x, counter-clockwise, radians.
struct Orthotropy {
  std::array<double, 2> young = {1, 1};
  double poisson = 0.3;  // nu12
  double shear = 1 / 2.6;
  double angle = 0;
};
/// Isotropic where the constants are, up to rounding. Throws Error(Usage) where a strain would have no or a negative
/// energy: that needs E1, E2, G12 > 0 and nu12^2 < E1/E2.
Material orthotropic(const Orthotropy& constants);

/// The same material seen in a frame that is turned by `angle` (radians).
Material seen_from(Material m, double angle);

/// The compliances divided by `factor`.
constexpr Material stiffened(const Material& m, double factor) {
  return {m.mu * factor, m.c / factor, m.coupling / factor, m.split / factor, m.axis};
}

/// 1/E' = (kappa + 1)/(8 mu): E' = E in plane stress, E/(1 - nu^2) in plane strain. Of an orthotropic material that of
/// its isotropic part, which is a scale.
constexpr double plane_modulus(const Material& m) {
  return 1 / (1 / (4 * m.mu) + m.c);
}

/// What the strain 11, 22, 12 of a symmetric stress has beyond that of the isotropic part.
Eigen::Vector3d orthotropic_strain(const Material& m, double s11, double s22, double s12);

/// A s; of an s that is not symmetric the skew part over 2 mu.
inline Mat2 strain(const Material& m, const Mat2& s) {
  const double t = s.trace();
  Mat2 e = (s - 0.5 * t * Mat2::Identity()) / (2 * m.mu) + m.c * t * Mat2::Identity();
  if (isotropic(m)) return e;
  const Eigen::Vector3d more = orthotropic_strain(m, s(0, 0), s(1, 1), 0.5 * (s(0, 1) + s(1, 0)));
  e(0, 0) += more[0];
  e(1, 1) += more[1];
  e(0, 1) += more[2];
  e(1, 0) += more[2];
  return e;
}

}  // namespace kerf
