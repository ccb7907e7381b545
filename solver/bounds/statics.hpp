#pragma once
// The solution made ready to become a statically admissible stress [theory: B.4].

#include "base/sums.hpp"
#include "solver/system.hpp"

namespace kerf {

/// The antisymmetric stress with s12 - s21 = asymmetry. It has no divergence.
Mat2 antisymmetric(double asymmetry);

/// Interior fields of the solution plus its response to two changes. On unilateral cracks the normal stress is nowhere
/// tension: its Bernstein coefficients on every edge are <= 0, which pressure at the Gauss points does not imply. And
/// with antisymmetric(couple[t]) on top of each triangle (no couples: empty) the tractions balance. Uses the factor of
/// the model and nothing else of how the state was found. `moved`: how far the multipliers go with it, or nothing.
Eigen::MatrixXd static_interior(const Model& model, const Field& state, const Eigen::VectorXd& couple,
                                Eigen::VectorXd* moved = nullptr);

/// The same of a part of a body: the pressures that there are, as far as they press.
Eigen::MatrixXd static_interior(const Model& part, const Field& state, const Eigen::VectorXd& couple,
                                const OpenSolve& open);

}  // namespace kerf
