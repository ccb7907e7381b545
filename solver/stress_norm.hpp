#pragma once
// Bounds of the integral of a squared seminorm of the stress.

#include "kerf/bounds.hpp"

#include <functional>

namespace kerf {

/// A quadratic form of the symmetric stress that is at most 3 mu times A s : s, as the square of the von Mises stress
/// is in plane strain and in plane stress [theory: B.26].
using SquaredVonMises = std::function<double(const Material& material, const Mat2& stress)>;

/// Its integral over the body, from the gap of the bounds of the energy [theory: B.25]; cracks may be in contact
/// without friction. Not with orthotropic materials or an eigenstrain: `note` says so.
Bounded squared_stress_bounds(const Model& model, const Field& state, const SquaredVonMises& square);

}  // namespace kerf
