#pragma once
// Displacements of a lattice whose cells have given stiffnesses: bilinear elements.

#include "optimize/density/lattice.hpp"
#include "solver/factor.hpp"

#include <memory>

namespace kerf {

/// Which unknowns meet in the matrix, in the order of elimination: made once per lattice.
struct LatticePattern {
  std::vector<Index> unknown;             // per 2 node + component; none: of no cell of the body
  LowerTriangle empty;                    // without values
  std::vector<std::array<Index, 36>> at;  // per cell of the body: where its lower triangle goes
  std::vector<double> springs;            // values of the supports
};
LatticePattern lattice_pattern(const Lattice& lattice);

class LatticeStiffness {
 public:
  LatticeStiffness(const Lattice& lattice, const LatticePattern& pattern) : l_(lattice), pattern_(pattern) {}

  /// Displacements under forces (a column per load case; numbers as Lattice::force) with the relative stiffness given
  /// per cell. Throws Error(Numerics) when the matrix is not definite.
  Eigen::MatrixXd displacements(const Eigen::VectorXd& relative, const Eigen::MatrixXd& force);

 private:
  const Lattice& l_;
  const LatticePattern& pattern_;
  LowerTriangle matrix_;
  std::unique_ptr<Factor> factor_;
};

/// u'K u of every cell at relative stiffness 1, for one column of displacements.
Eigen::VectorXd cell_energies(const Lattice& lattice, const Eigen::Ref<const Eigen::VectorXd>& u);

}  // namespace kerf
