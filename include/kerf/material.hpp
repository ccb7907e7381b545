#pragma once
// What the body is made of.

#include "kerf/types.hpp"

namespace kerf {

/// Plane isotropic elasticity in two numbers: strain = A s = dev(s)/(2 mu) + c tr(s) I, traces in 2D.
/// c = 0 is the incompressible limit of plane strain.
struct Material {
  double mu = 1;
  double c = 0.1;  // nu = 0.3 in plane strain
};

constexpr Material plane_strain(double young, double poisson) {
  const double mu = young / (2 * (1 + poisson));
  return {mu, (1 - 2 * poisson) / (4 * mu)};
}
constexpr Material plane_stress(double young, double poisson) {
  const double mu = young / (2 * (1 + poisson));
  return {mu, (1 - poisson) / (4 * mu * (1 + poisson))};
}

/// 1/E' = (kappa + 1)/(8 mu): E' = E in plane stress, E/(1 - nu^2) in plane strain.
constexpr double plane_modulus(const Material& m) {
  return 1 / (1 / (4 * m.mu) + m.c);
}

inline Mat2 strain(const Material& m, const Mat2& s) {
  const double t = s.trace();
  return (s - 0.5 * t * Mat2::Identity()) / (2 * m.mu) + m.c * t * Mat2::Identity();
}

}  // namespace kerf
