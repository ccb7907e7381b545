#pragma once
// Derivatives of a quantity of interest by the discrete state, and the adjoint state, with the state's own factor.

#include "solver/model.hpp"

namespace kerf {

/// dJ: members of no size are zero. `force` is the derivative by State::force, per skeleton unknown.
struct Sensitivity {
  Eigen::MatrixXd interior;  // like State::interior
  Eigen::VectorXd skeleton;  // like State::skeleton
  Eigen::VectorXd force;
};
Sensitivity& operator+=(Sensitivity& a, const Sensitivity& b);
bool empty(const Sensitivity& s);

/// The transpose of `evaluate`: derivatives by the interior coefficients of sum_q weights_q . fields(x_q).
Eigen::VectorXd weigh(const Model& model, Index t, const Points& x, const Fields& weights);

/// What a row in contact does to small changes of the load. Biactive: neither gap nor pressure, so that the state has
/// one-sided derivatives only.
enum class ContactStatus : signed char { Open, Closed, Biactive };
/// Per row in contact, in the order of Ordering's trailing rows; with crack_profile's idea of no gap and no pressure.
std::vector<ContactStatus> contact_status(const Model& model, const State& state);

/// The dual state (zeta, p, rho; mu on the skeleton) in mixed sign: the saddle matrix of the state, right-hand side
/// -dJ, homogeneous supports, on the tangent cone of the contact [Mignot 1976; topological_derivatives.md, section 4]:
/// `held` rows keep their jump 0 (closed), the others their force. A derivative by the force of a held row prescribes
/// minus its value as the dual jump. With it dJ = dJ_explicit + mu . dF for loads, + (dA sigma, zeta) for compliances:
/// exact for the discrete problem off the kinks. Throws Error(Usage) for elements that are not mixed or have stresses
/// at vertices.
State solve_adjoint(const Model& model, const Sensitivity& dJ, const std::vector<bool>& held);
/// Held: closed rows; biactive ones move.
std::vector<bool> tied(const std::vector<ContactStatus>& status);

}  // namespace kerf
