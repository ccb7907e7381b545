#pragma once
// What the two ways to solve for the state share.

#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"

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

}  // namespace kerf
