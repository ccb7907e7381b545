// Functions orthonormal in the mean over a triangle that span polynomials and what the right inverse of the divergence
// makes of them [theory: B.42]: a QR factorization of their values at the points of the rule, times the roots of its
// weights.

#include "solver/bounds/modes.hpp"

#include "base/dense.hpp"
#include "base/polynomial.hpp"

#include <algorithm>

namespace kerf {

namespace {

/// Monomials about the middle, a row per point.
/// About the centroid and scaled, monomials are far from dependent.
Eigen::MatrixXd centred(int degree, const Points& l) {
  return monomials(degree, 2 * (l.array() - 1.0 / 3).matrix()).transpose();
}

}  // namespace

/// A triangular R keeps the polynomials of lower degree before the others. The gradients of right inverses are made
/// orthogonal to the polynomials twice, for rounding, and what is left has the rank of a pivoted QR, 1e-10 of its
/// largest pivot. The rule must be exact for products of two of these functions.
Modes::Modes(const TriangleReference& r, const Element& e, int degree_of)
    : degree(degree_of), polynomials(dim(degree_of)), nodes(lattice(degree_of)), weights(r.rule.w) {
  const Eigen::VectorXd root = weights.cwiseSqrt();
  const Eigen::MatrixXd weighted = root.asDiagonal() * centred(degree, r.rule.x);
  const auto [Q, R] = thin_qr(weighted);
  const Eigen::MatrixXd by = inverse(R);
  const auto polynomials_at = [&](int up_to, const Points& l) -> Eigen::MatrixXd {
    return multiply(centred(up_to, l), by.topLeftCorner(dim(up_to), dim(up_to)));
  };
  const Eigen::MatrixXd at_nodes = polynomials_at(degree, nodes);
  to_modes = inverse(at_nodes);

  const Eigen::MatrixXd raise = multiply(interpolation(degree, r.nodes), at_nodes);  // polynomials -> lattice(n)
  const Eigen::MatrixXd all = multiply(r.inverse.derivative, raise), moved = multiply(r.inverse.value, raise);
  const Eigen::Index points = weights.size();
  Eigen::MatrixXd slopes(points, 4 * polynomials);
  for (Eigen::Index q = 0; q < points; ++q)
    for (int k = 0; k < 4; ++k) slopes.row(q).segment(k * polynomials, polynomials) = root[q] * all.row(4 * q + k);
  Eigen::MatrixXd beyond = slopes - multiply(Q, transposed_multiply(Q, slopes));
  beyond -= multiply(Q, transposed_multiply(Q, beyond));
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> rest = pivoted_qr(beyond, 1e-10);
  const Eigen::MatrixXd more = orthonormal(rest, rest.rank());
  count = polynomials + rest.rank();
  Eigen::MatrixXd whole(points, count);
  whole << Q, more;
  values = root.cwiseInverse().asDiagonal() * whole;
  peak = values.cwiseAbs().colwise().maxCoeff().transpose();
  derivative.resize(4 * count, polynomials);
  for (int k = 0; k < 4; ++k)
    derivative.middleRows(k * count, count) =
        transposed_multiply(whole, slopes.middleCols(k * polynomials, polynomials));

  const int conforming = e.trace + 1;
  const Points lattice_of = lattice(conforming);
  displacement = inverse(polynomials_at(conforming, lattice_of));
  value.resize(2 * dim(conforming), polynomials);
  Eigen::MatrixXd component(points, polynomials);
  for (int k = 0; k < 2; ++k) {
    for (Eigen::Index q = 0; q < points; ++q) component.row(q) = root[q] * moved.row(2 * q + k);
    value.middleRows(k * dim(conforming), dim(conforming)) =
        transposed_multiply(Q.leftCols(dim(conforming)), component);
  }
  const auto d = differentiation(conforming, lattice(e.trace));
  const Eigen::MatrixXd to_traces = inverse(polynomials_at(e.trace, lattice(e.trace)));
  for (int axis = 0; axis < 2; ++axis) slope[axis] = multiply(to_traces, d[axis]);

  if (r.force.cols() == dim(conforming) && degree == r.n) {
    const Eigen::MatrixXd field = multiply(r.normal_free, r.mean_force - r.force);
    unseen_force.resize(2 * polynomials, r.force.cols());
    Eigen::MatrixXd at(polynomials, r.force.cols());
    for (int k = 0; k < 2; ++k) {
      for (Eigen::Index q = 0; q < polynomials; ++q) at.row(q) = field.row(2 * q + k);
      unseen_force.middleRows(k * polynomials, polynomials) = multiply(to_modes, at);
    }
  }
  if (degree >= strain_degree)
    strain = multiply_transposed(to_modes.topRows(dim(strain_degree)), monomials(strain_degree, nodes));

  const EdgeRule trace = gauss(points_per_edge(e));
  for (int side = 0; side < 3; ++side)
    for (const bool forward : {false, true})
      at_edge[side][forward] = interpolation(degree, points_on_side(trace, side, forward));
}

}  // namespace kerf
