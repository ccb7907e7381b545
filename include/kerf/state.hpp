#pragma once
// The solution of a model.

#include "kerf/model.hpp"

namespace kerf {

/// How the contact on cracks is solved: the small dual problem, elimination of the constraint, projected iteration.
enum class ContactMethod { DualQp, ActiveSet, Uzawa };

/// Measured triangle by triangle, free of the rounding of the matrix that was factorized [theory: E.20, E.21].
struct Certificate {
  double residual = 0;  // |K x - F| on the unknowns that no contact holds, over the largest load (maximum norms)
  double kkt = 0;       // the largest of residual and Contact::kkt, relative
  double work = 0;      // |2 strain energy - work of loads, supports and friction|, relative: the error of the work
};

/// From here on a state has lost digits that the user must be told; from here on it is none.
inline constexpr double few_digits = 1e-8, no_digits = 1e-4;

struct StateSeconds {
  double solve = 0, contact = 0;
};

/// Coefficients of fields on a model: of the state, of an adjoint, of a change.
struct Field {
  Eigen::VectorXd skeleton;  // base and jump unknowns, prescribed ones included
  Eigen::MatrixXd interior;  // one column per triangle: stress, displacement, rotation coefficients
  Eigen::VectorXd force;     // per skeleton unknown: force of contact and friction on jumps, 0 elsewhere
  double eigenstrain = 0;    // grad u = A s + Gamma(omega) + this times the scene's: 1 in states, 0 in what is linear
};

/// The field that solves the model, and how well it does.
struct State : Field {
  int contact_iterations = 0, linear_solves = 0;
  bool converged = true;  // the active set settled
  Certificate certificate;
  StateSeconds seconds;
};
State solve(const Model& model, ContactMethod method = ContactMethod::DualQp);

/// What the faces do, for a finer mesh of the same body. Contact ends where pressures that fall like the root of the
/// distance have fallen to nothing.
ContactGuess contact_guess(const Model& model, const Field& state);

/// The contact set settled, and kkt and work are at most no_digits.
bool certified(const State& state);
/// Says how many digits are left, where kkt or work are above few_digits; else empty.
std::string lost_digits(const State& state);

/// Values of the interior fields at points of the triangle (2 x n, physical coordinates).
struct Fields {
  Eigen::Matrix4Xd stress;      // rows s11, s12, s21, s22: symmetric only weakly
  Points displacement;          // the element's own (piecewise constant for bdms); recover.hpp has a better one
  Eigen::RowVectorXd rotation;  // (d2 u1 - d1 u2)/2
};
Fields evaluate(const Model& model, const Field& field, Index t, const Points& x);

double strain_energy(const Model& model, const Field& field);     // 1/2 (A s, s): of the elastic strain
double work_of_loads(const Model& model, const Field& field);     // body force and tractions
double potential_energy(const Model& model, const Field& field);  // strain energy minus work of the loads

}  // namespace kerf
