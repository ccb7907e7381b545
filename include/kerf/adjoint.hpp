#pragma once
// Derivatives of a quantity of interest by the discrete state, and the adjoint field, with the model's own factor.

#include "kerf/state.hpp"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace kerf {

/// dJ: members of no size are zero. `force` is the derivative by Field::force, per skeleton unknown.
struct Sensitivity {
  Eigen::MatrixXd interior;  // like Field::interior
  Eigen::VectorXd skeleton;  // like Field::skeleton
  Eigen::VectorXd force;
};
Sensitivity& operator+=(Sensitivity& a, const Sensitivity& b);
bool empty(const Sensitivity& s);

/// The transpose of `evaluate`: derivatives by the interior coefficients of sum_q weights_q . fields(x_q).
Eigen::VectorXd weigh(const Model& model, Index t, const Points& x, const Fields& weights);

/// What a row in contact does to small changes of the load. Biactive: neither gap nor pressure, so that the state has
/// one-sided derivatives only.
enum class ContactStatus : signed char { Open, Closed, Biactive };
/// Per row in contact, in the order of the cracks' paths; with crack_profile's idea of no gap and no pressure.
std::vector<ContactStatus> contact_status(const Model& model, const Field& state);

/// What a linear solve with the factor of a model gives.
struct TangentField : Field {
  double residual = 0;  // relative
  int linear_solves = 0;
};

/// The dual field (zeta, p, rho; mu on the skeleton) in mixed sign: the saddle matrix of the state, right-hand side
/// -dJ, homogeneous supports, on the tangent cone of the contact [Mignot 1976; theory: A.2, A.9]:
/// `held` rows keep their jump 0 (closed), the others their force. A derivative by the force of a held row prescribes
/// minus its value as the dual jump. With it dJ = dJ_explicit + mu . dF for loads, + (dA sigma, zeta) for compliances:
/// exact for the discrete problem off the kinks. Throws Error(Usage) for elements that are not mixed or have stresses
/// at vertices.
TangentField solve_adjoint(const Model& model, const Sensitivity& dJ, const std::vector<bool>& held);
/// Held: closed rows; biactive ones move.
std::vector<bool> tied(const std::vector<ContactStatus>& status);

/// Less the rigid motions that the supports leave free, as far as it makes them in the mean of squares: as in a State.
Field without_motions(const Model& model, Field dual);

/// Linear solves on the tangent cone of the contact with the model's factor: `held` rows (as for solve_adjoint) keep
/// their jump 0, the others move without change of force.
class TangentSolver {
 public:
  static constexpr double to_rounding = 1e-15;
  /// The model must outlive the solver.
  TangentSolver(const Model& model, std::vector<bool> held);
  ~TangentSolver();

  /// The body without body force under `load` (force per skeleton unknown; what it says on held rows shows in
  /// Field::force alone, K x - load there) and the values `prescribed` where supports fix an unknown (per skeleton
  /// unknown, 0 elsewhere). Iterates until the relative residual is `enough`; fills in the interior of the triangles
  /// `only` (0 elsewhere), of all when it is empty.
  TangentField solve(const Eigen::VectorXd& load, const std::vector<double>& prescribed, double enough = to_rounding,
                     std::span<const Index> only = {});

  /// The same under `count` loads with all supports at rest. One elimination per triangle serves many of them.
  std::vector<TangentField> solve_all(std::size_t count, const std::function<Eigen::VectorXd(std::size_t)>& load);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
/// One of these.
TangentField solve_linear(const Model& model, const Eigen::VectorXd& load, const std::vector<double>& prescribed,
                          const std::vector<bool>& held);

}  // namespace kerf
