#pragma once
// A short crack on the bisector of a reentrant corner: exponents of the wedge, its fields, and K of the crack per
// generalised stress intensity [theory: M.9, M.10].
//
// The wedge has the half angle alpha on both sides of its bisector, theta = 0, and free sides. Of mode 0 the stress
// across the bisector is N (2 pi r)^(lambda - 1), of mode 1 the shear along it.

#include "kerf/material.hpp"

#include <array>
#include <complex>

namespace kerf::inspect {

struct Wedge {
  double half_angle = 0;           // radians, more than 90 degrees, 180 at most
  std::array<double, 2> lambda{};  // per mode
  std::array<double, 2> factor{};  // K_I/N_0, K_II/N_1 = factor length^(lambda - 1/2)
};
/// By Mellin's transform and a density of dislocations on `points` graded points. Throws Error(Usage) for other angles.
Wedge wedge(double half_angle, int points = 60);

/// K/sqrt(pi length) of faces that bear (r/length)^power of that mode; any half angle from 90 to 180 degrees.
double wedge_intensity(int mode, double half_angle, double power, int points = 60);

/// The eigenfunction of a mode for the exponent lambda of the displacement, with N = 1, or the one for -lambda (of any
/// scale) that is dual to it.
struct PolarField {
  double rr = 0, tt = 0, rt = 0;  // stresses
  double u_r = 0, u_t = 0;
};
PolarField wedge_field(int mode, const Wedge& of, bool dual, const Material& material, double r, double theta);

}  // namespace kerf::inspect
