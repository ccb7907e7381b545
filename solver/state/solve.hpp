#pragma once
// What the two ways to solve for the state share.

#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"

#include <limits>

namespace kerf {

/// Takes the rigid motions out that the supports leave free.
void remove_motions(const Model& m, Field& field);
/// The same with known shares of Inner::floating.
void remove_motions(const Model& m, const Eigen::VectorXd& share, Field& field);
/// int u . motion for each of them, over own triangles.
Eigen::VectorXd floating_moments(const Model& m, const Field& field);

/// An enclosed incompressible body: throws Error(Numerics) when what is prescribed changes its area beyond quadrature
/// and the rounding of displacements and of the strains that other loads cause.
void check_volume(const Model& m, double change, double largest_strain);
/// The same of a body with this area whose largest prescribed displacement is known.
void check_volume(double change, double largest_strain, double displacement, double area);

/// The force of a row that the last digit of the prescribed displacements, at most `largest`, makes: what a body that
/// they move as a whole shows instead of none. `stiffest`: diagonal entry of K.
inline double force_of_rounding(double stiffest, double largest) {
  return std::numeric_limits<double>::epsilon() * stiffest * largest;
}

/// Why an enclosed incompressible body whose cracks are all closed has no solution.
inline constexpr const char* open_level =
    "the body is incompressible (poisson = 0.5) and wholly enclosed by its supports: the level of pressure on its "
    "cracks is open; free a part of the boundary";

}  // namespace kerf
