#pragma once
// A displacement that is continuous, takes the prescribed values, and does not let crack faces penetrate [theory: B.6].

#include "solver/bounds/lane_states.hpp"
#include "solver/bounds/polynomial_data.hpp"

namespace kerf {

/// Continuous displacement of degree trace + 1, two-valued at cracks that may open, [v].n >= 0 on unilateral ones:
/// averages of the recovered displacement. Its mean over every edge (and side) is that of the multiplier, so that the
/// mean of its divergence over each triangle is that of 2 c tr s. On supported edges it takes the prescribed values
/// only with l_a l_b p((1 + l_b - l_a)/2) on top, p of degree 5, l_a and l_b the barycentric coordinates of the edge's
/// ends.
struct Conforming {
  int degree = 0;
  Eigen::MatrixXd nodal;               // per triangle x, y at each point of lattice(degree)
  std::vector<EdgePolynomial> bubble;  // p per edge of the data; x, y
  std::vector<EdgePolynomial> value;   // what results on these edges, in their frames
  std::vector<double> penetration;     // per edge, of unilateral cracks: rounding
  double mismatch = 0;                 // energy of what polynomials of degree 7 do not see of the prescribed values
};
Conforming conforming_displacement(const Model& model, const Field& state, const std::vector<EdgeData>& data);

/// What the averages need of the mesh, for fields side by side on straight triangles without contact.
struct Averaging {
  int degree = 0, per_triangle = 0;
  Index count = 0;             // nodes, those inside triangles behind all others
  std::vector<Index> of;       // per triangle its nodes at lattice(degree)
  std::vector<Index> on;       // per edge and side the nodes along it; none where that side has no values of its own
  Eigen::VectorXd share;       // per triangle its weight
  Eigen::VectorXd reciprocal;  // per node, of the sum of the weights
};
Averaging averaging(const Model& model);

/// As conforming_displacement, `values` per node x and y; of each field in `of` what its data edges have.
struct LaneConforming {
  LaneArray values;
  std::vector<Conforming> of;
};
void conforming_lanes(const Averaging& by, const Model& model, const LaneStates& states,
                      std::span<const std::vector<EdgeData>> data, LaneConforming& result);

}  // namespace kerf
