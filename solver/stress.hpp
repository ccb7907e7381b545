#pragma once
// The stress as engineers ask for it: scalars of it, and where it may be infinite.

#include "kerf/model.hpp"

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

/// Crack tips, kinks and junctions, reentrant corners, corners between materials and the ends of supports: where the
/// stress, and with it the map, may be infinite. Every point once, by increasing vertex.
std::vector<Vec2> singular_points(const Model& model);

}  // namespace kerf
