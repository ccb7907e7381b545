#pragma once
// A map for loops.

#include "kerf/analysis.hpp"

namespace kerf {

/// T at the centroid of every triangle from the element's own stress there, without recovery and without a mask: for
/// loops that look at T in every step. `change`: the perturbation in each triangle.
Eigen::VectorXd map_at_centroids(const Analysis& a, const Functional& j,
                                 const std::function<const Perturbation&(Index triangle)>& change);

}  // namespace kerf
