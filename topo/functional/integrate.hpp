#pragma once
// Integrals of a Term over body, boundary and crack, their derivative and their change.

#include "kerf/adjoint.hpp"
#include "kerf/functional.hpp"
#include "kerf/state.hpp"
#include "solver/system.hpp"

namespace kerf {

/// The integral itself, before power and factor; of a part of a body over own triangles (solver/system.hpp OwnShare).
double integral(const Term& term, const Model& model, const Field& state);

/// Its derivative by the state, by all triangles and unknowns that are here, exact for the quadrature that `integral`
/// uses. Empty for energies, misfits, volumes.
Sensitivity derivative(const Term& term, const Model& model, const Field& state);

/// Both, from one pass over the fields.
struct Differentiated {
  double value = 0;
  Sensitivity derivative = {};
};
Differentiated differentiated(const Term& term, const Model& model, const Field& state);

/// Change of the domain integral over the triangles with use[t] when the state changes, density by density, so that
/// small changes keep their digits.
double domain_difference(const Term& term, const Model& model, const Field& state, const Field& change,
                         const std::vector<bool>& use);

/// phi(z + w) - phi(z) - phi'(z) w at the centroid of t times its area, for changes w (interior coefficients, a column
/// each): what is left of the domain integral after its derivative, for changes that are small and smooth.
Eigen::VectorXd second_order(const Term& term, const Model& model, const Field& state, Index t,
                             const Eigen::MatrixXd& changes);

/// The change of the domain integral over t itself, exact for quintics.
Eigen::VectorXd changes_on(const Term& term, const Model& model, const Field& state, Index t,
                           const Eigen::MatrixXd& changes);

/// Change of the integrals over boundary and crack.
double surface_difference(const Term& term, const Model& model, const Field& state, const Field& change);

/// A field that is known in closed form, singular at a center: its displacement, stress and rotation at a point. The
/// disc around the center is no part of the body.
struct Singular {
  Vec2 center;
  double radius;
  std::function<FieldPoint(const Vec2& x)> at;
};
/// integral(state + change + added, without the disc) - integral(state). The crack's pressures of `change` are those of
/// change + added. Triangles near the center are divided until they are small against their distance from it, or
/// against the disc.
double difference(const Term& term, const Model& model, const Field& state, const Field& change, const Singular& added);

/// How many pieces of an edge an integral over it needs for a field that is singular at a point beside it.
int pieces_beside(const Vec2& singular, const Vec2& a, const Vec2& b);

/// The part of the integral over the triangles with use[t].
double integral_over(const Term& term, const Model& model, const Field& state, const std::vector<bool>& use);

/// d(factor integral^power)/d integral.
double slope(const Term& term, double integral);

}  // namespace kerf
