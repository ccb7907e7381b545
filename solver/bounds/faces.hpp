#pragma once
// The admissible fields behind two-sided bounds of the energy, on the faces in contact [theory: B.2].

#include "kerf/bounds.hpp"

namespace kerf {

/// Per edge of the unilateral cracks, in the order of their paths, at the Gauss points of the trace: the pressure of
/// contact p >= 0 of the stress in equilibrium, a polynomial of the degree of the trace, and the opening [v].n >= 0 of
/// the conforming displacement, one degree higher. Their product is integrated exactly.
struct FaceFields {
  Eigen::VectorXd lengths;            // per edge
  Eigen::VectorXd weights;            // of the points, of sum 1
  Eigen::MatrixXd pressure, opening;  // a column per edge
  Eigen::VectorXd overlap;            // per edge: rounding
};

/// As energy_bounds, with these fields; without cracks in contact they are empty.
EnergyBounds energy_bounds(const Model& model, const Field& state, FaceFields& faces);

/// The work of the pressure of one on the opening of the other, on the same mesh.
double crossed_work(const FaceFields& pressing, const FaceFields& opening);

}  // namespace kerf
