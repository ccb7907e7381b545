#pragma once
// The dual problem of a derivative, for one process and for many.

#include "kerf/adjoint.hpp"
#include "solver/contact/sliding.hpp"
#include "solver/system.hpp"

namespace kerf {

/// What the dual problem is loaded by.
struct DualLoads {
  Eigen::VectorXd forces;  // per skeleton unknown: derivatives by the skeleton, and those by the interior condensed
  Eigen::VectorXd own;     // per triangle Loads::own, with a penalty
};
DualLoads dual_loads(const Model& m, const Sensitivity& dJ);

/// What the derivative says about each of Inner::floating, over own triangles and unknowns.
Eigen::VectorXd work_on_motions(const Model& m, const Sensitivity& dJ);
/// The derivative less `share` of the derivatives of int u . motion.
Sensitivity without_moments(const Model& m, Sensitivity dJ, const Eigen::VectorXd& share);

/// Of these points those that are closed and slide. `held`, `jump`: by rows in contact.
std::vector<SlidingPoint> sliding_points(const std::vector<ContactPoint>& points, const std::vector<bool>& held,
                                         const Eigen::VectorXd& jump);

}  // namespace kerf
