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

struct MapFields;  // see fields.hpp

struct Analysis {
  const Model* model;
  const Field* state;
  double value = 0;                // J
  std::vector<double> term_value;  // of each term, its factor left out
  std::vector<double> slope;       // dJ/d(integral of the term)
  // Weight of -1/2 form(s, s) + b.u: energies; compliances under homogeneous supports (-2), whose adjoint is the state.
  double energy_share = 0;
  std::optional<Field> adjoint = {};  // of all other terms
  Sensitivity derivative = {};        // of these
  // With a misfit: the body with measured displacements.
  std::shared_ptr<const Model> measured_model = {};
  std::shared_ptr<const Field> measured = {};
  double measured_share = 0;
  std::shared_ptr<const Biactive> biactive = {};  // where it matters: with an adjoint
  double biactive_length = 0;
  std::shared_ptr<const MapFields> fields =
      {};  // recovered stresses, for maps: recover_fields; made anew where missing
};

/// `value_only`: no adjoint. Throws Error(Usage) for what the element or the scene cannot do (friction),
/// Error(Numerics) when the measured body cannot be solved.
Analysis analyze(const Functional& j, const Model& model, const Field& state, bool value_only = false);

/// The recovered stresses of the state, the adjoint and the others: once for several maps.
/// `corners`: those of split_for_stress, where they are known already.
std::shared_ptr<const MapFields> recover_fields(const Analysis& a, Corners corners = {});

/// Throws Error(Usage) where J sees rigid motions that the supports leave free: the solver takes them out of the mean,
/// which a change of the body moves.
void require_supports(const Functional& j, const Model& model);

/// No prescribed displacement but 0: then the compliance is -2 times the potential energy.
bool has_rigid_supports(const Model& model);

/// The scene with the measured displacements instead of the tractions on their label.
Scene measured_scene(const Scene& scene, const Support& measured);

}  // namespace kerf
