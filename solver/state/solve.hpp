#pragma once
// What the two ways to solve for the state share.

#include "base/sums.hpp"
#include "solver/system.hpp"
#include "solver/system/elementwise.hpp"
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
/// The same of a body with this area whose largest prescribed displacement is known.
void check_volume(double change, double largest_strain, double displacement, double area);

/// What drives a body: of all processes the largest force, never 0, the largest prescribed value, and the force of its
/// rounding, which a body that is moved as a whole shows instead of none; of this process the work of loads and of
/// prescribed values, to which that of contact is added.
struct Driven {
  double largest = 0, prescribed = 0, rounding = 0, work = 0;
};
/// `stiffest`: diagonal entry of K on all processes.
Driven driven_by(const Model& m, const Balance& balance, const DoubleDouble& values, double stiffest, const Sums& sums);

/// How far the work of all processes is from the energy [theory: E.20], relative to its size. `previous`: what the slip
/// of the steps before would store. `state` has its interior.
struct JudgedWork {
  double error = 0, size = 0;
};
JudgedWork judge_work(const Model& m, const Balance& balance, const Driven& driven, double previous, const Field& state,
                      const Sums& sums);

/// Why an enclosed incompressible body whose cracks are all closed has no solution.
inline constexpr const char* open_level =
    "the body is incompressible (poisson = 0.5) and wholly enclosed by its supports: the level of pressure on its "
    "cracks is open; free a part of the boundary";

}  // namespace kerf
