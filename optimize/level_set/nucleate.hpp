#pragma once
// Where new holes lower J.

#include "optimize/level_set/background.hpp"

namespace kerf {

struct Nucleation {
  double multiplier = 0;       // price of area: holes where T < multiplier
  double area = 0;             // of all new holes
  double least = 0, most = 0;  // radius
};

/// Discs at the least T first, each with a radius of at most a third of the distance to the boundary, to what is frozen
/// and to the other discs, where the expansion still ranks points; `distance` as by signed_distance.
std::vector<Disc> places_to_nucleate(const BackgroundMesh& background, const Eigen::VectorXd& distance,
                                     const Mesh& mesh, const Eigen::VectorXd& T, const Nucleation& how);

}  // namespace kerf
