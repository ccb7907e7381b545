#pragma once
// Two-sided bounds of the potential energy [theory: B.1].

#include "kerf/state.hpp"

namespace kerf {

/// lower <= J(u) <= upper for the exact u [Prager, Synge 1947], J(v) = 1/2 a(v, v) - l(v). Lower: the stress of the
/// solution made exactly symmetric, in equilibrium, and without tension anywhere on unilateral cracks. Upper: a
/// displacement that takes the prescribed values, with [v].n >= 0 all along unilateral cracks. The data enter as
/// polynomials (body force of degree trace + 1 per triangle, tractions of degree 5 and displacements of degree 7 per
/// edge). What these leave out widens the bounds by at most `oscillation`: of forces by inequalities with known
/// constants, of prescribed displacements by an estimate. Not available where data are not resolved by any rule.
struct EnergyBounds {
  double lower = 0, upper = 0;  // nan: not available
  double oscillation = 0;
  bool guaranteed = false;  // up to rounding, black boxes as sampled; estimates are below 1 % of upper - lower
  std::string note;         // why not available, or not guaranteed
  // Rounding, of the equilibrated stress: the largest |s12 - s21| relative to its largest component; the work of what
  // its tractions lack in balance, of tension on cracks and of penetration, relative to the works that make up the
  // energy.
  double asymmetry = 0, imbalance = 0;
};

/// For mixed elements with a rotation that is discontinuous between triangles, and cracks without friction.
EnergyBounds energy_bounds(const Model& model, const Field& state);

}  // namespace kerf
