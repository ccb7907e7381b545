#pragma once
// Pieces of a body condensed onto some of their edges (Steklov-Poincare operators).

#include "geometry/part.hpp"
#include "solver/system.hpp"

namespace kerf {

/// K x = load on the kept edges' unknowns, everything else in the piece eliminated; no supports in it. The piece need
/// not be held: `K` has the rigid motions as its kernel.
struct CondensedPiece {
  Part part;
  SceneData data = {};
  Skeleton skeleton;
  Ordering ordering;
  System system;
  Factor factor = Factor(LowerTriangle{}, 0);
  double shift = 0;   // on the kept diagonal of the factorized matrix
  Eigen::MatrixXd K;  // per_edge rows per kept edge, in their order
  Eigen::VectorXd load;
};
/// Triangles of a mesh, and the edges of it whose unknowns are kept.
struct CutOut {
  const Mesh& whole;
  const std::vector<bool>& use;
  const std::vector<Index>& kept;
};
/// `body`: with the body force and the eigenstrain. Throws Error(Usage) for elements with unknowns at vertices.
CondensedPiece condense(const CutOut& piece, const Kernel& k, const Scene& scene, bool body);

/// All skeleton unknowns of the piece from those of its kept edges; `body` as in condense.
Eigen::VectorXd complete(const CondensedPiece& piece, const Eigen::VectorXd& kept, bool body);

}  // namespace kerf
