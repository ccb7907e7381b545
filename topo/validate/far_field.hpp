#pragma once
// What changes in balls do outside them.

#include "topo/functional/integrate.hpp"
#include "topo/validate/ball_problem.hpp"

namespace kerf {

/// The whole that the balls belong to.
struct BallsInBody {
  const Analysis& a;
  const Functional& j;
  const Filled& filled;
};

struct FarField {
  std::vector<Sensitivity> derivative;  // of the terms, empty for energies and misfits
  /// The skeleton by rows of the ordering, a column per change (ChangedBall::column).
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows;
};

/// The skeleton by the factor of the whole, several columns at once; of the densities the derivative exactly, and at
/// the centroids what is left. `body` is that of the analysis. Fills in ChangedBall::column and ::far.
FarField far_field(const BallsInBody& in, const BodyOperator& body, std::vector<std::vector<ChangedBall>>& changed);

}  // namespace kerf
