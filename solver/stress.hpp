#pragma once
// The stress as engineers ask for it: scalars of it, and where it may be infinite.

#include "kerf/model.hpp"

#include <array>

namespace kerf {

/// (s11, s22, (s12 + s21)/2) of (s11, s12, s21, s22).
Eigen::Vector3d symmetric_part(const Eigen::Vector4d& stress);

/// Von Mises stress, with s33 = nu (s11 + s22) - E e33 in plane strain and 0 in plane stress; e33: the eigenstrain.
double von_mises(const Material& material, bool plane_strain, const Eigen::Vector4d& stress, double e33 = 0);

/// Of the symmetric part, first >= second.
struct PrincipalStresses {
  double first, second;
};
PrincipalStresses principal_stresses(const Eigen::Vector4d& stress);

/// Crack tips, kinks and junctions, ends of cracks, reentrant corners, corners between materials and the ends of
/// supports: where the stress, and with it the map, may be infinite. Not where a crack meets a straight side on rollers
/// squarely: its mirror image goes on behind them. By increasing vertex.
std::vector<Index> singular_vertices(const Model& model);
/// Where they are.
std::vector<Vec2> singular_points(const Model& model);

/// Per crack: whether its start and its end are tips, inside the body and on no other crack.
std::vector<std::array<bool, 2>> ends_inside(const Mesh& mesh);

}  // namespace kerf
