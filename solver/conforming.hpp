#pragma once
// Boundary data as polynomials, and a displacement that obeys them, is continuous, and does not let crack faces
// penetrate.

#include "solver/model.hpp"

namespace kerf {

/// Points per edge that carry boundary data as polynomials, and that sample them.
inline constexpr int data_carriers = 6, data_samples = 8;
using EdgePolynomial = Eigen::Matrix<double, 2, data_carriers>;  // values at gauss(data_carriers)

/// Data of one boundary edge that a support or a traction names, in the components of its frame.
struct EdgeData {
  Index edge = none;
  Index triangle = none;
  int side = 0;                                         // number of the edge in the triangle
  std::array<bool, 2> held{false, false};               // prescribed components
  Eigen::Matrix<double, 2, data_samples> displacement;  // prescribed values at gauss(data_samples), else 0
  Mat2 ends = Mat2::Zero();                             // and at the two ends (columns)
  EdgePolynomial load = EdgePolynomial::Zero();         // tractions, projected onto P5
  EdgePolynomial unbalanced = EdgePolynomial::Zero();   // load minus its projection onto P_trace; 0 where held
  double left_out = 0;                                  // integral of the square of what P5 does not see
};
std::vector<EdgeData> edge_data(const Model& model);

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
  double mismatch = 0;                 // energy of what polynomials of degree 7 do not see of the prescribed values
};
Conforming conforming_displacement(const Model& model, const State& state, const std::vector<EdgeData>& data);

}  // namespace kerf
