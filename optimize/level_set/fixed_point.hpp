#pragma once
// The topological derivative as a level set: a design is best where T exceeds the price of its area exactly in the
// material [Amstutz, Andrae 2006].

#include "optimize/level_set/regularize.hpp"

namespace kerf {

struct FixedPoint {
  Eigen::VectorXd psi;  // of norm 1 in L2, of the wanted area
  double angle = 0;     // radians, between the old psi and the generalized topological derivative
  double multiplier = 0;
};

/// T per triangle of a mesh of the material (0 outside) becomes a function on the background mesh by the Helmholtz
/// filter, which lets material grow where it would be used; psi turns by `turn` of the angle towards multiplier - T on
/// the sphere, and is shifted to the area. `price`: a multiplier that is given, and no area.
FixedPoint fixed_point(const BackgroundMesh& background, const Helmholtz& filter, const Mesh& mesh,
                       const Eigen::VectorXd& T, const Eigen::VectorXd& psi, double turn, std::optional<double> price,
                       double area);

}  // namespace kerf
