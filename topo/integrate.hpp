#pragma once
// Integrals of a Term over body, boundary and crack, their derivative and their change. Internal to this room.

#include "topo/functional.hpp"

namespace kerf {

/// The integral itself, before power and factor.
double integral(const Term& term, const Model& model, const State& state);

/// Its derivative by the state, exact for the quadrature that `integral` uses. Empty for energies, misfits, volumes.
Sensitivity derivative(const Term& term, const Model& model, const State& state);

/// Change of the domain integral over the triangles with use[t] when the state changes, density by density, so that
/// small changes keep their digits.
double domain_difference(const Term& term, const Model& model, const State& state, const State& change,
                         const std::vector<bool>& use);

/// The integral over t of phi(z + w) - phi(z) - phi'(z) w for changes w (interior coefficients, a column each): what is
/// left of the domain integral after its derivative. With the rule of the element: one point would cost 1 % of D.
Eigen::VectorXd second_order(const Term& term, const Model& model, const State& state, Index t,
                             const Eigen::MatrixXd& changes);

/// Change of the integrals over boundary and crack.
double surface_difference(const Term& term, const Model& model, const State& state, const State& change);

/// The part of the integral over the triangles with use[t].
double integral_over(const Term& term, const Model& model, const State& state, const std::vector<bool>& use);

/// d(factor integral^power)/d integral.
double slope(const Term& term, double integral);

}  // namespace kerf
