#pragma once
// The singular fields about a crack tip in closed form, which interaction integrals take as auxiliary ones, and the
// cut-off of the rings that they are taken over.

#include "kerf/material.hpp"

#include <array>

namespace kerf {

/// A stress and the gradient d_j u_i of the displacement that belongs to it.
struct LocalState {
  Mat2 stress, gradient;
};

/// A tip under unit K_I, under unit K_II, under a unit force along x, at x in its frame (x extends the crack) and at
/// that angle, `m` as seen in that frame [Westergaard 1939; Sih, Paris, Irwin 1965; theory: F.1, F.2, O.9]. `angle` and
/// not x decides on which side of the cut the root is: at a face x is the same for both.
std::array<LocalState, 3> tip_fields(const Material& m, const Vec2& x, double angle);

/// q falls from 1 to 0 between the radii, twice continuously differentiable: q = 1 - t^3 (10 - 15 t + 6 t^2), t from
/// the inner to the outer radius.
struct TipRing {
  double inner, outer;
};
double cut_off(const TipRing& ring, double r);
double cut_off_slope(const TipRing& ring, double r);

}  // namespace kerf
