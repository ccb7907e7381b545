#pragma once
// Penalized densities on a lattice [Bendsoe 1989; Sigmund 2001].

#include "optimize/density/filter.hpp"
#include "optimize/density/stiffness.hpp"

namespace kerf {

/// How stiff a density is: least + (1 - least) times a power of it [theory: P.2]; with a rational law instead, whose
/// stiffness falls no faster than the weight where there is little material [Stolpe, Svanberg 2001; theory: P.3].
struct Stiffening {
  double exponent = 3;
  bool rational = false;  // density / (1 + exponent (1 - density))
  double least = 1e-9;    // stiffness of the void
  double stiffness(double density) const;
  double derivative(double density) const;
};

/// Compliances per load case of a density per cell, in the lattice's units, and their derivatives [theory: P.4].
/// What a density makes of a lattice: stiffness per cell and its slope, nodal forces per load case. Body force goes to
/// the corners of its cell in equal parts, in proportion to the density.
struct LoadedLattice {
  Eigen::VectorXd stiffness, slope;
  Eigen::MatrixXd force;
};
LoadedLattice loaded(const Lattice& lattice, const Stiffening& law, const Eigen::VectorXd& density);

struct Compliances {
  Eigen::VectorXd value;
  Eigen::MatrixXd by_density;  // per cell and load case
};
Compliances compliances(const Lattice& lattice, LatticeStiffness& stiffness, const Stiffening& law,
                        const Eigen::VectorXd& density);

/// sum of weights * compliances + price * area to be made small; areas in cells, solid ones included.
struct LatticeGoal {
  Eigen::VectorXd weights;  // per load case
  double price = 0;
  std::optional<double> area;  // at most
  Eigen::VectorXd most;        // of the compliance per load case; infinity: any
  /// Nothing but a sum of compliances under an area: optimality criteria do.
  bool plain() const {
    return area && price == 0 && !(most.array() < infinity).any();
  }
};

/// From blurred and mild to sharp and penalized: radius (in cells) and exponent go evenly from their first to their
/// last value.
struct Schedule {
  double first_radius = 1.4, radius = 1.4;
  double first_exponent = 3, exponent = 3;
  int change_steps = 30;
  int most_steps = 60;
  double move = 0.2;           // of a density in a step
  double least_change = 0.01;  // of all densities: the end
  Eigen::VectorXd start = {};  // density per cell; empty: even
};

struct Densities {
  Eigen::VectorXd density;
  int steps = 0;
};
/// For plain goals without body force, with derivatives smoothed [theory: P.5, P.6].
Densities optimality_criteria(const Lattice& lattice, const LatticePattern& pattern, const LatticeGoal& goal,
                              const Schedule& how);
/// For all goals, by moving asymptotes [theory: P.7].
Densities moving_asymptotes(const Lattice& lattice, const LatticePattern& pattern, const LatticeGoal& goal,
                            const Schedule& how);

/// Densities as multiples of 2^-24: the rounding of the solver rarely changes one.
void round_off(Eigen::VectorXd& x);

/// Black and white at an area: the set where the bilinear density exceeds a level, as the share of every cell
/// [theory: P.8].
Eigen::VectorXd black_and_white(const Lattice& lattice, const Eigen::VectorXd& density, double area);

}  // namespace kerf
