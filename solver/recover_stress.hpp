#pragma once
// A stress of higher order at points, from polynomials fitted to the discrete one on patches of triangles.

#include "kerf/model.hpp"
#include "kerf/state.hpp"

#include <span>
#include <vector>

namespace kerf {

/// The symmetric part (s11, s22, s12) of a recovered stress. Per corner a polynomial: the least squares fit to the
/// stress on the triangles around, not across cracks. At a point of a triangle: the polynomials of its three corners,
/// blended by its barycentric coordinates. Singular corners and those next to them have none: there the discrete stress
/// is kept, at the corners its average weighted by area.
struct RecoveredStress {
  Eigen::Matrix3Xd at_corners, at_centroids;
  int degree = 0;
  Eigen::MatrixXd coefficients;  // per corner: 3 x dim(degree), of the monomials in (x - corner) / reach
  Eigen::VectorXd reach;         // per corner, a length
  std::vector<bool> kept;        // per corner: no polynomial
};

/// Corners where the stress is not smooth: angles over reentrant_angle on the boundary or a crack (tips, corners),
/// and where a crack begins to touch. `state`: the one with the contact, for adjoint fields too.
std::vector<bool> singular_corners(const Model& model, const Field& state, const Corners& corners);

/// Of order 2: cubics fitted to the means over the triangles of two rings, more at boundaries; order 1: quadratics;
/// above: quartics, for order 5 quintics, fitted to point values in one ring [Zienkiewicz, Zhu 1992, with means for
/// point values; theory: R.2]. Any solved field will do: nothing is asked of its divergence or its strains. `load`: f
/// with div s + f = 0, where it is known and not constant; elements whose displacements are constant then get what they
/// do not see of it, which halves the error. Bits do not depend on model.threads. The order stays that of the element
/// on general meshes (one more where they are regular), the error falls by 3 to 10 for order 2 unless a rough load or a
/// coarse tip dominates it.
RecoveredStress recover_stress(const Model& model, const Field& field, const Corners& corners,
                               const std::vector<bool>& singular, const VectorField& load = {});

/// The same of several fields of one mesh and element, whose fits share their matrices: little more than one takes.
/// `wanted`: per triangle, all if empty. At points of others, their corners and centroids nothing is known then.
struct FieldToRecover {
  const Model& model;
  const Field& field;
  VectorField load = {};
};
std::vector<RecoveredStress> recover_stresses(std::span<const FieldToRecover> fields, const Corners& corners,
                                              const std::vector<bool>& singular, const std::vector<bool>& wanted = {});

/// At a point of a triangle.
struct PointIn {
  Index triangle;
  Vec2 x;
};
Eigen::Vector3d recovered_at(const Model& model, const Field& field, const Corners& corners,
                             const RecoveredStress& recovered, const PointIn& at);

}  // namespace kerf
