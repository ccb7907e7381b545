#pragma once
// Derivative of J when the body itself moves, from the same adjoint as its topological derivative.

#include "topo/analysis.hpp"

namespace kerf {

/// Distributed form: dJ(theta) = sum_v column(v) . theta(x_v) for every theta that is linear on the triangles of the
/// model's mesh; 2 x vertices. Mixed fields sigma, D = A sigma + Gamma(omega) in place of grad u, and the same of the
/// adjoint (mixed sign):
///   dJ(theta) = int D:(zeta grad theta') + (A zeta + Gamma(rho)):(sigma grad theta') - (A sigma:zeta) div theta + ...
/// It is the exact derivative of the discrete J when the vertices of the mesh move, for elements whose spaces the Piola
/// transformation maps onto themselves (peers, bdms, afw), and finite at nu = 1/2. Loads, supports and cracks move with
/// the body.
Points shape_gradient(const Analysis& a, const Functional& j);

/// Boundary form on free boundaries: dJ(theta) = int g theta.n, g = density + b.p - sigma:eps(p) from the recovered
/// tangential stresses, at the Gauss points of edges.
struct BoundaryGradient {
  struct Point {
    Index edge;
    Vec2 at, normal;
    double weight;  // length that the point stands for
    double density;
  };
  std::vector<Point> points;
};
BoundaryGradient boundary_gradient(const Analysis& a, const Functional& j);

}  // namespace kerf
