#pragma once
// The singular fields about a crack tip in closed form, which interaction integrals take as auxiliary ones.

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

}  // namespace kerf
