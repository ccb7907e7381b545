#pragma once
// Value of J, adjoint, and what else its expansion needs: solved once, evaluated anywhere.

#include "kerf/adjoint.hpp"
#include "kerf/functional.hpp"

#include <memory>

namespace kerf {

/// Where gap and pressure both vanish, J has one-sided derivatives: per such row the response to a unit pair of forces
/// that opens the crack there (closed rows tied), the openings that they cause, and dJ along each.
struct Biactive {
  std::vector<Field> response;
  Eigen::MatrixXd opening;  // symmetric positive definite
  Eigen::VectorXd slope;
};

struct MapFields;  // recovered stresses, which maps share: not for users

struct Analysis {
  const Model* model;
  const Field* state;
  double value = 0;                // J
  std::vector<double> term_value;  // of each term, its factor left out
  std::vector<double> slope;       // dJ/d(integral of the term)
  // Weight of -1/2 form(s, s) + b.u: energies; compliances under homogeneous supports (-2), whose adjoint is the state.
  double energy_share = 0;
  // Weight of the work of the loads in J, of compliances under other supports: their loads go with the body.
  double work_share = 0;
  std::optional<Field> adjoint = {};  // of all other terms
  Sensitivity derivative = {};        // of these
  // With a misfit: the body with measured displacements.
  std::shared_ptr<const Model> measured_model = {};
  std::shared_ptr<const Field> measured = {};
  double measured_share = 0;
  std::shared_ptr<const Biactive> biactive = {};  // where it matters: with an adjoint
  double biactive_length = 0;
  std::shared_ptr<const MapFields> fields = {};  // made anew where missing
};

/// `value_only`: no adjoint. Throws Error(Usage) for what the element or the scene cannot do,
/// Error(Numerics) when the measured body cannot be solved.
Analysis analyze(const Functional& j, const Model& model, const Field& state, bool value_only = false);

}  // namespace kerf
