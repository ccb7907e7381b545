#pragma once
// Rules exact for polynomials of a given degree on the unit triangle and on [0, 1].

#include "kerf/types.hpp"

namespace kerf {

struct TriangleRule {
  Points x;           // barycentric coordinates of the second and third vertex
  Eigen::VectorXd w;  // sum to 1: multiply by the area
};
struct EdgeRule {
  Eigen::VectorXd s;  // in (0, 1), increasing
  Eigen::VectorXd w;  // sum to 1: multiply by the length
};

/// [Dunavant 1985] up to degree 5, collapsed Gauss above.
TriangleRule triangle_rule(int degree);
/// Gauss-Legendre, exact to degree 2 points - 1.
EdgeRule gauss(int points);
/// Values at s in [0, 1] of the polynomials that are 1 at one Gauss point of the edge and 0 at the others.
Eigen::VectorXd trace_basis(const EdgeRule& trace, double s);

}  // namespace kerf
