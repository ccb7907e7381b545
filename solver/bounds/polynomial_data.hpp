#pragma once
// Body force and boundary data as the bounds of the energy see them: polynomials per triangle and per edge.

#include "solver/system.hpp"

namespace kerf {

/// From values at the points of a rule to values on lattice(degree) of the L2 projection onto P_degree.
Eigen::MatrixXd projection(int degree, const TriangleRule& rule);
/// Values at the points s in [0, 1] of the polynomials carried by the points of a rule: a column per point.
Eigen::MatrixXd traces(const EdgeRule& carrier, const Eigen::VectorXd& s);
double diameter(const Triangle& t);

/// Body force as polynomials f_h of degree trace + 1, on curved triangles J f as polynomials in the coordinates that
/// the map takes to the place. A body held by nothing is in equilibrium with the forces that the element sees, which
/// are taken instead where displacements are constant.
struct Forces {
  int degree = 0;
  Eigen::MatrixXd nodal;   // x, y at lattice(degree), a column per triangle; no columns without a body force
  bool balanced = true;    // div s_h = -f already, so that no local correction is needed
  Eigen::VectorXd couple;  // per triangle, the mean asymmetry that its correction has; only with constant displacements
                           // and on curved triangles
  Eigen::VectorXd left_out;  // per triangle h/pi |f - its polynomial|
  Eigen::VectorXd moved;     // per triangle: at least the error of the integral of f.w, |w| <= 1
};

Forces forces(const Model& model);

/// Points per edge that carry boundary data as polynomials.
inline constexpr int data_carriers = 6;
using EdgePolynomial = Eigen::Matrix<double, 2, data_carriers>;  // values at gauss(data_carriers)

/// Data of one boundary edge that a support or a traction names, or of one side of a crack edge under pressure, in the
/// components of its frame. The sides of a crack come one after the other, the left one first.
struct EdgeData {
  Index edge = none;
  Index triangle = none;
  int side = 0;                            // number of the edge in the triangle
  std::array<bool, 2> held{false, false};  // prescribed components
  bool bent = false;  // a roller along a curve: the first component is along the normal there, and 0
  Eigen::Matrix<double, 2, data_points> displacement;  // prescribed values at gauss(data_points), else 0
  Mat2 ends = Mat2::Zero();                            // and at the two ends (columns)
  Vec2 rest = Vec2::Zero(), rough = Vec2::Zero();      // of them, as EdgeValues
  EdgePolynomial load = EdgePolynomial::Zero();        // tractions, projected onto P5
  EdgePolynomial unbalanced = EdgePolynomial::Zero();  // load minus its projection onto P_trace; 0 where held
  double left_out = 0;                                 // integral of the square of what P5 does not see of degree 7
  Vec2 unseen = Vec2::Zero();                          // root of the mean square of what degree 7 does not see
  Vec2 primitive = Vec2::Zero();                       // the same of its primitive, by s
  Vec2 moved = Vec2::Zero();                           // as EdgeValues::error
};
std::vector<EdgeData> edge_data(const Model& model);
/// Whether the edge is held along the normal of its curve, which turns.
bool rolls_along_curve(const Model& model, Index edge);

}  // namespace kerf
