#pragma once
// Penalized densities on a lattice [Bendsoe 1989; Sigmund 2001].

#include "optimize/density/filter.hpp"
#include "optimize/density/stiffness.hpp"

namespace kerf {

/// How stiff a density is.
struct Stiffening {
  double exponent = 3;
  double least = 1e-9;  // stiffness of the void
  double stiffness(double density) const;
  double derivative(double density) const;
};

/// Compliances per load case of a density per cell, in the lattice's units, and their derivatives.
struct Compliances {
  Eigen::VectorXd value;
  Eigen::MatrixXd by_density;  // per cell and load case
};
Compliances compliances(const Lattice& lattice, LatticeStiffness& stiffness, const Stiffening& law,
                        const Eigen::VectorXd& density);

struct Criteria {
  double radius = 1.4;      // of the filter, in cells
  double area = 0;          // in cells, the solid ones included
  Eigen::VectorXd weights;  // of the load cases
  int most_steps = 60;
  double move = 0.2;           // of a density in a step
  double least_change = 0.01;  // of all densities: the end
};
struct Densities {
  Eigen::VectorXd density;
  int steps = 0;
};
/// The weighted sum of compliances made small under an area by optimality criteria.
Densities optimality_criteria(const Lattice& lattice, const LatticePattern& pattern, const Criteria& how);

/// Black and white at an area: the set where the bilinear density exceeds a level, as the share of every cell.
Eigen::VectorXd black_and_white(const Lattice& lattice, const Eigen::VectorXd& density, double area);

}  // namespace kerf
