#pragma once
// A posteriori error indicator of the stress.

#include "solver/model.hpp"

namespace kerf {

/// Residual indicator per triangle, in the norm of the stress [Carstensen, Dolzmann 1998; elements.md section 9]:
///   eta^2 = |as s|^2 + (2 mu)^2 (h^2 |curl D|^2 + sum_e w_e |e| |J_e|^2) + h^2 |f + div s|^2,  D = A s + Gamma(omega),
/// h the longest edge, J_e the jump of D tau (w = 1/2; D tau - d_tau u_D on supported components, w = 1; nothing on
/// free boundaries; on a crack less the slope of the discrete jump, its normal part where the faces touch, its
/// tangential part where they stick).
struct Indicator {
  Eigen::VectorXd eta;  // per triangle
  double relative = 0;  // sum over the body, divided by the efficiency index and by |s|: a relative L2 stress error
};
/// `relative` uses Element::efficiency, measured on smooth fields and a partly closed crack: right within a factor 2
/// there. An estimate, not a bound; not a number for displacement elements.
Indicator error_indicator(const Model& model, const State& state);

}  // namespace kerf
