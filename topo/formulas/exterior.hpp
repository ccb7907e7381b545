#pragma once
// What a small elliptic hole or crack does to a power of the von Mises stress in the plane around it [theory: T.34].

#include "topo/formulas/von_mises.hpp"

#include <array>

namespace kerf {

/// What the plane is cut by, along the axis 1: a free ellipse of area pi whose longer axis lies there, or a crack of
/// length 2, whose faces let no shear through, and pressure only where it is closed.
struct CutShape {
  enum class Kind { Ellipse, Open, Closed } kind = Kind::Ellipse;
  double aspect = 1;  // of the ellipse, at least 1
};

/// Psi(s) = (1/pi) int over the plane outside of Phi(s + w) - Phi(s) - Phi'(s):w, w the stress that the cut adds to the
/// uniform stress s, as a table: Psi is homogeneous of degree p in s, so that it is one of two angles, that between the
/// mean and the deviator and that of the principal axes, and periodic in both. Interpolated (8 points each way).
struct CutTable {
  VonMises law;
  double p = 2;
  double root = 1;         // the table holds Psi^root
  Eigen::MatrixXd values;  // row: first angle in [0, pi); column: second one in [0, 2 pi)
};

/// Relative error (of the largest value for cracks) about 1e-5 up to p = 5, 1e-4 above; 1e-2 for p = 16 and aspects
/// from 10 on. Throws (Usage) as `tabulate` of von_mises.hpp, and for cracks with p >= 4, where the stress is not
/// integrable at their tips.
CutTable tabulate(const VonMises& law, double p, const CutShape& cut);

/// Psi of the stress s around a cut along the angle (radians).
double exterior(const CutTable& table, const Mat2& s, double angle);

/// The integral itself, by quadrature: for s = mean I + [[x, y], [y, -x]] in the axes of the cut.
class Exterior {
 public:
  /// `more`: multiplies the numbers of points.
  Exterior(const VonMises& law, double p, const CutShape& cut, int more = 1);
  double operator()(double mean, double x, double y) const;

 private:
  using Parts = std::array<double, 3>;  // mean, x, y
  struct Node {
    double weight;
    std::array<Parts, 3> added;  // the parts of w, for a unit of each part of s
  };
  VonMises law_;
  double p_;
  std::vector<Node> nodes_;
};

}  // namespace kerf
