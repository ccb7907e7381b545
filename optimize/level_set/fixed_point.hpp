#pragma once
// The topological derivative as a level set: a design is best where T exceeds the price of its area exactly in the
// material [Amstutz, Andrae 2006; theory: L.5].

#include "optimize/level_set/regularize.hpp"

namespace kerf {

struct FixedPoint {
  Eigen::VectorXd psi;  // of norm 1 in L2, of the wanted area
  double angle = 0;     // radians, between the old psi and the generalized topological derivative
  double multiplier = 0;
};

/// T per triangle of a mesh of the material, 0 outside.
struct TriangleDerivative {
  const Mesh& mesh;
  const Eigen::VectorXd& T;
};

struct Turn {
  double share = 0;             // of the angle towards multiplier - T on the sphere
  std::optional<double> price;  // a multiplier that is given, and no area
  double area = 0;              // otherwise: the area wanted
};

/// T becomes a function on the background mesh by the Helmholtz filter, which lets material grow where it would be
/// used; psi turns towards it, and is shifted to the area.
FixedPoint fixed_point(const BackgroundMesh& background, const Helmholtz& filter, const TriangleDerivative& derivative,
                       const Eigen::VectorXd& psi, const Turn& turn);

}  // namespace kerf
