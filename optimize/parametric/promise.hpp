#pragma once
// What the map of the objective promises of designs, before any of them is solved.

#include "kerf/optimize.hpp"

#include <vector>

namespace kerf {

/// For every design the mean of T over what it draws, per area: sum_i a_i T(x_i) / sum_i a_i with the areas a_i = pi
/// size_i^2 and the middles x_i of its things, T the topological derivative of the objective on the body without them
/// (under all load cases). The lower, the better; infinite where a thing lies where T is not known. Empty where there
/// is no such map: for functionals, elements and bodies that have none.
std::vector<double> promises(const Problem& problem, const OptimizeRequest& request,
                             const std::vector<Eigen::VectorXd>& designs);

}  // namespace kerf
