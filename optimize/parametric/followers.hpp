#pragma once
// How meshes follow what numbers draw: vertices on it, where they go, forces on them carried back to the variables.

#include "kerf/mesh.hpp"
#include "optimize/parametric/shapes/shape.hpp"

namespace kerf {

Eigen::Index variable_count(const Design& d);
/// Where the variables of drawn[k] begin.
std::vector<Eigen::Index> first_variables(const Design& d);
/// x cut into the variables of each drawn thing.
std::vector<Eigen::VectorXd> parts(const Design& d, const Eigen::VectorXd& x);

/// A vertex of a mesh that lies on something drawn, and where there.
struct Follower {
  Index vertex, drawn;
  Spot spot;
};
/// Of a mesh of body_of(d, at, p).
std::vector<Follower> followers(const Design& d, const Eigen::VectorXd& at, const Problem& p, const Mesh& mesh);

/// Where the followers lie in the design x: 2 x followers. At `at` they lie where the mesh has them, up to rounding.
Points positions(const Design& d, const std::vector<Follower>& f, const Eigen::VectorXd& x);
/// sum over followers k of force(k) . d positions(k) / dx.
Eigen::VectorXd pull_back(const Design& d, const std::vector<Follower>& f, const Eigen::VectorXd& x,
                          const Points& force);

/// Area of the holes drawn, and its derivative unless null. Splines exactly, not as polygons.
double area_of_holes(const Design& d, const Eigen::VectorXd& x, Eigen::VectorXd* gradient);

}  // namespace kerf
