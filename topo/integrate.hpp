#pragma once
// Integrals of a Term over body, boundary and crack, their derivative and their change. Internal to this room.

#include "topo/functional.hpp"

namespace kerf {

/// The integral itself, before power and factor.
double integral(const Term& term, const Model& model, const State& state);

/// Its derivative by the state, exact for the quadrature that `integral` uses. Empty for energies, misfits, volumes.
Sensitivity derivative(const Term& term, const Model& model, const State& state);

/// integral(state + change) - integral(state), density by density, so that small changes keep their digits. Only
/// triangles with `use[t]`, if it is not empty, count.
double difference(const Term& term, const Model& model, const State& state, const State& change,
                  const std::vector<bool>& use = {});

/// The part of the integral over the triangles with use[t].
double integral_over(const Term& term, const Model& model, const State& state, const std::vector<bool>& use);

/// d(factor integral^power)/d integral.
double slope(const Term& term, double integral);

}  // namespace kerf
