#pragma once
// What is read off a solution: better displacements, values at corners for plots, crack profiles, error indicator.

#include "kerf/state.hpp"

namespace kerf {

/// u* in P2(T)^2 at points of triangle t (2 x n): (grad u*, grad v) = (A s + e + Gamma(omega), grad v) for v in P2, e
/// the eigenstrain, with the mean of u_h [Stenberg 1991; theory: R.1].
Points recovered_displacement(const Model& model, const Field& field, Index t, const Points& x);
/// Area-weighted averages over the triangles that meet at a corner, on one side of every crack.
struct CornerValues {
  Points displacement;      // of u*
  Eigen::Matrix4Xd stress;  // s11, s12, s21, s22
  Eigen::RowVectorXd rotation;
};
CornerValues corner_values(const Model& model, const Field& field, const Corners& corners);

/// Along a crack, in path order, at the Gauss points of its edges; n points to the left of the path, jump = left minus
/// right face. sigma_n, sigma_t: traction components on the faces, that of a fluid between them included.
struct CrackPoint {
  double s;  // arc length from the start of the path
  Vec2 at;
  double length;  // share of the edge that the point stands for
  double jump_n, jump_t, sigma_n, sigma_t;
  enum class Status { Open, Closed, Biactive } status;  // Biactive: neither gap nor pressure of contact
  double fluid_pressure = 0;                            // CrackLaw::pressure
  double gap = 0;                                       // CrackLaw::gap: the faces are jump_n + gap apart
  double distance() const {
    return jump_n + gap;
  }
  double contact_pressure() const {
    return -sigma_n - fluid_pressure;
  }
};
std::vector<CrackPoint> crack_profile(const Model& model, const Field& field, Index crack);

}  // namespace kerf
