#pragma once
// Functionals of states that are known by energies and by loads alone.

#include "kerf/functional.hpp"
#include "kerf/model.hpp"

#include <optional>
#include <vector>

namespace kerf {

/// J = energy_share times the potential energy + measured_share times that of the body with measured displacements
/// + dual_share times the work of `loads` on the displacement + what no displacement changes.
struct LinearParts {
  double energy_share = 0, measured_share = 0, dual_share = 0;
  std::optional<Scene> loads;  // of the body at rest: its solution is the adjoint
  std::optional<Support> measured;
  std::string why;  // J is not of that form; empty: it is
};
LinearParts linear_parts(const Functional& j, const Model& model);

}  // namespace kerf
