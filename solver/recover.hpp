#pragma once
// What is read off a solution: better displacements, values at corners for plots, crack profiles, error indicator.

#include "solver/model.hpp"

namespace kerf {

/// u* in P2(T)^2 at points of triangle t (2 x n): (grad u*, grad v) = (A s + Gamma(omega), grad v) for v in P2, with
/// the mean of u_h [Stenberg 1991; rates: elements.md section 7].
Points recovered_displacement(const Model& model, const State& state, Index t, const Points& x);
/// The same from the interior coefficients of t.
Points recovered_displacement(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& interior, Index t,
                              const Points& x);

/// Its transpose: the derivative by the interior coefficients of t of sum_q weights_q . u*(x_q).
Eigen::VectorXd weigh_recovered(const Model& model, Index t, const Points& x, const Points& weights);

/// Area-weighted averages over the triangles that meet at a corner, on one side of every crack.
struct CornerValues {
  Points displacement;      // of u*
  Eigen::Matrix4Xd stress;  // s11, s12, s21, s22
  Eigen::RowVectorXd rotation;
};
CornerValues corner_values(const Model& model, const State& state, const Corners& corners);

/// Along a crack, in path order, at the Gauss points of its edges; n points to the left of the path, jump = left minus
/// right face. sigma_n, sigma_t: traction components transmitted through the crack.
struct CrackPoint {
  double s;  // arc length from the start of the path
  Vec2 at;
  double length;  // share of the edge that the point stands for
  double jump_n, jump_t, sigma_n, sigma_t;
  enum class Status { Open, Closed, Biactive } status;  // Biactive: neither gap nor pressure
};
std::vector<CrackPoint> crack_profile(const Model& model, const State& state, Index crack);

/// What the body is made of at corners that are split between materials, too: of the last triangle at each corner.
std::vector<Material> corner_materials(const Model& model, const Corners& corners);

/// Root mean square of the stress over the body: the scale of "no pressure".
double mean_stress(const Model& model, const State& state);

/// grad u = A s + Gamma(omega) of the mixed solution: d1 u1, d2 u1, d1 u2, d2 u2.
Eigen::Vector4d displacement_gradient(const Material& m, const Eigen::Vector4d& stress, double rotation);

}  // namespace kerf
