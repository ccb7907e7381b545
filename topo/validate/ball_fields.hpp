#pragma once
// What validation needs inside a ball: forces through contours, energies, fields.

#include "topo/validate/condense.hpp"

namespace kerf {

/// Compliances floored at 1e-8/mu, so that plain condensation serves for every nu: the change of a state loses no
/// digits that matter by it.
Material floored(Material m);
Scene floored(Scene scene);

/// Values of a skeleton vector on edges.
Eigen::VectorXd on_edges(const Skeleton& s, const std::vector<Index>& edges, const Eigen::VectorXd& values);

/// Such values less the rigid motion nearest to them.
Eigen::VectorXd strained(const Model& m, const std::vector<Index>& edges, const Eigen::VectorXd& values);

/// Moments of the tractions that the triangles of `inside` exert through the edges.
Eigen::VectorXd forces_from(const Model& m, const Field& s, const std::vector<Index>& edges,
                            const std::vector<bool>& inside);

/// 1/2 (A s, s) - (f, u) on a triangle, and (f, u).
double energy_of(const Model& m, const Eigen::MatrixXd& interior, Index t, const Material& material);
double work_inside(const Model& m, const Field& s, Index t);

/// What lies inside a contour, made of another material, between given displacements of the contour.
struct InnerState {
  Model model;
  Field state;
};
InnerState inner_state(const CondensedPiece& inner, const Kernel& kernel, const Scene& scene,
                       const Eigen::VectorXd& contour, bool body);
double energy_inside(const InnerState& inner);

/// The triangles of a ball: those that are changed, and the rest.
struct DiscAndRing {
  const std::vector<bool>&disc, &ring;
};
/// Change of the work of the body force inside a ball: it stays where the body stays.
double work_difference(const Model& m, const Field& s, const Field& change, const DiscAndRing& ball,
                       const InnerState* starred);

/// Interior fields of a piece into the columns of its triangles in the whole.
void add_fields(Field& s, const CondensedPiece& p, const Eigen::VectorXd& values, const Kernel& kernel,
                const Scene& scene);

}  // namespace kerf
