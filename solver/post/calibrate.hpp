#pragma once
// How much larger the error indicator is than the error, measured on the body at hand.

#include "kerf/state.hpp"

namespace kerf {

/// |eta| / |s* - s| over the triangles where the recovered stress s* is one [theory: R.6]; Element::efficiency where
/// these are too few, or the stress is exact there. `eta`: per triangle.
double efficiency(const Model& model, const State& state, const Eigen::VectorXd& eta);

}  // namespace kerf
