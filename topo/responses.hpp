#pragma once
// What readings on the boundary answer to small changes of the body: topological derivatives of many linear functionals
// of the displacement there, with one factor and one recovery of each field.

#include "kerf/functional.hpp"
#include "kerf/perturbation.hpp"
#include "solver/recover_stress.hpp"

#include <span>

namespace kerf {

struct Responses {
  const Model* model;
  const Field* state;
  Locator locator;
  Corners corners;
  RecoveredStress stress;   // of the state
  Eigen::VectorXd value;    // of the readings
  std::vector<Field> dual;  // per reading
  std::vector<RecoveredStress> dual_stress;
};

/// Readings: terms on a part of the boundary whose `on_boundary` is affine in u. One linear solve each; faces of cracks
/// that touch stay in touch. Model and state must outlive the result. Throws Error(Usage) for other terms, elements
/// that are not mixed, friction.
Responses responses(const Model& model, const Field& state, std::span<const Term> readings);

/// The readings of another state alone.
Eigen::VectorXd read(const Model& model, const Field& state, std::span<const Term> readings);

/// Every field at one point, inside the body.
struct PointResponse {
  Material material;
  Mat2 stress;
  std::vector<Mat2> dual;   // per reading
  Eigen::VectorXd removed;  // b . p, per reading, or empty
};
std::optional<PointResponse> response_at(const Responses& r, const Vec2& x);

/// T of every reading: reading(eps) = reading + pi eps^2 T + o(eps^2). `angle` (radians) of a crack or an ellipse.
Eigen::VectorXd derivatives(const PointResponse& r, const Perturbation& p, double angle);

}  // namespace kerf
