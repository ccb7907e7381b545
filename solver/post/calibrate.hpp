#pragma once
// How much larger the error indicator is than the error, measured on the body at hand.

#include "base/sums.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// |eta| / |s* - s| over the triangles where the recovered stress s* is one [theory: R.6], within a factor 2 of
/// Element::efficiency, and that where these are too few, or the stress is exact there. Elsewhere, at tips and corners,
/// the indicator shows less of the error than in smooth parts: the smaller of this and two thirds of
/// Element::efficiency.
struct Efficiency {
  double regular, singular;
  std::vector<bool> recovered;  // per triangle: which of them
};
/// `eta`: per triangle. `sums`: of a part, what the processes find out together; a body that one process has takes
/// none.
Efficiency efficiency(const Model& model, const State& state, const Eigen::VectorXd& eta, const Sums& sums = {});

}  // namespace kerf
