// What the mixed elements do in matrices whose sizes are known at run time only. The coordinates of the local problem
// (E.6); the compliance on the components 11, 12, 21, 22, and the orthotropic share; stress spaces that are cut by
// conditions on the edges (E.11); and the rotation of symmetric elements, which have no multiplier for it. With e = A s
// it follows in the mean of squares from
//   d1 r = d2 e11 - d1 e12,   d2 r = d2 e12 - d1 e22   [theory: E.15],
// and its constant from the moment int x^perp . u_h. Spaces and rotation: docs/theory/elements.md.

#include "solver/element/interior_fields.hpp"

#include "base/dense.hpp"

#include <cmath>

namespace kerf {

// xi = (x - centroid)/h with h^2 = 2 |T|: twice the area is 1 in xi, so that gradients of barycentric coordinates need
// no division.
Scaled scale(const Triangle& t) {
  Scaled s;
  s.center = centroid(t);
  s.h = std::sqrt(2 * area(t));
  for (int i = 0; i < 3; ++i) s.x[i] = (t.x[i] - s.center) / s.h;
  for (int i = 0; i < 3; ++i) {
    const Vec2 e = s.x[(i + 2) % 3] - s.x[(i + 1) % 3];
    s.gradient[i] = Vec2(-e.y(), e.x());  // inward normal times length over twice the area, which is 1
  }
  return s;
}

namespace {

// On the symmetric part of the stress.
void add_orthotropic(const Material& material, Eigen::Matrix4d& A) {
  for (int j = 0; j < 4; ++j) {
    const Eigen::Vector3d e = orthotropic_strain(material, j == 0, j == 3, j == 1 || j == 2 ? 0.5 : 0);
    A.col(j) += Eigen::Vector4d(e[0], e[2], e[2], e[1]);
  }
}

}  // namespace

// (N.4) with dev s = s - 1/2 tr(s) I: the skew part of s is in dev s and counts with 1/(2 mu).
Eigen::Matrix4d compliance(const Material& material) {
  const double half = 1 / (4 * material.mu), full = 1 / (2 * material.mu), c = material.c;
  Eigen::Matrix4d A;
  A << half + c, 0, 0, c - half,  //
      0, full, 0, 0,              //
      0, 0, full, 0,              //
      c - half, 0, 0, half + c;
  if (!isotropic(material)) add_orthotropic(material, A);
  return A;
}

namespace {
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
}  // namespace

Eigen::MatrixXd by_columns(const double* a, int rows, int columns) {
  return Eigen::Map<const RowMajor>(a, rows, columns);
}

// The constant cut, and for LinearNormal its part on which the three edge conditions of (E.11) vanish: these depend on
// the triangle.
Eigen::MatrixXd span_of(const Kernel& k, const Scaled& s) {
  if (k.element.cut != Cut::LinearNormal) return k.cut;
  // n.s n is linear on an edge when its second derivative along the edge vanishes.
  Eigen::MatrixXd conditions = Eigen::MatrixXd::Zero(k.cut.rows(), 3);
  for (int e = 0; e < 3; ++e) {
    const Vec2 tau = (s.x[(e + 2) % 3] - s.x[(e + 1) % 3]).normalized(), n(tau.y(), -tau.x());
    const double second[3] = {tau.x() * tau.x(), tau.x() * tau.y(), tau.y() * tau.y()};
    for (int j = 0; j < 3; ++j)
      for (int c = 0; c < 4; ++c) conditions(4 * place(2 - j, j) + c, e) = second[j] * n[c / 2] * n[c % 2];
  }
  return multiply(k.cut, orthogonal_complement(transposed_multiply(k.cut, conditions)));
}

void restrict_to(const Eigen::MatrixXd& n, const Rows<const double>& full, const Rows<double>& cut) {
  const auto map = [](double* a, int rows, int columns) { return Eigen::Map<RowMajor>(a, rows, columns); };
  const int N = cut.functions;
  map(cut.M, N, N) = transposed_multiply(n, multiply(by_columns(full.M, full.functions, full.functions), n));
  map(cut.Bt, N, cut.constraints) = transposed_multiply(n, by_columns(full.Bt, full.functions, full.constraints));
  map(cut.Ct, N, cut.traces) = transposed_multiply(n, by_columns(full.Ct, full.functions, full.traces));
  const Eigen::Map<const Eigen::VectorXd> trace(full.trace, full.functions);
  Eigen::Map<Eigen::VectorXd>(cut.trace, N) = transposed_multiply(n, trace);
}

namespace {

// Of the monomials up to a degree with each other, over the triangle.
Eigen::MatrixXd moments(const Kernel& k, const Scaled& s, int degree) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(dim(degree), dim(degree));
  for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) {
    const Points xi = point(s, k.rule.x(0, q), k.rule.x(1, q));
    const Eigen::VectorXd v = monomials(degree, xi);
    sum += k.rule.w[q] * v * v.transpose();
  }
  return sum;
}

// Per monomial the strain 11, 12, 22.
Eigen::MatrixXd strain_of(const Material& material, int monomials, const Eigen::VectorXd& all) {
  Eigen::MatrixXd strain(monomials, 3);
  for (int m = 0; m < monomials; ++m) {
    const double s11 = all[4 * m], s22 = all[4 * m + 3], mean = material.c * (s11 + s22);
    strain.row(m) << (s11 - s22) / (4 * material.mu) + mean, (all[4 * m + 1] + all[4 * m + 2]) / (4 * material.mu),
        (s22 - s11) / (4 * material.mu) + mean;
    if (isotropic(material)) continue;
    const Eigen::Vector3d more = orthotropic_strain(material, s11, s22, 0.5 * (all[4 * m + 1] + all[4 * m + 2]));
    strain.row(m) += Eigen::RowVector3d(more[0], more[2], more[1]);
  }
  return strain;
}

// The constant of the rotation from the moment of u, which u_h has more exactly than its gradient: u* with this
// gradient (columns d1 u1, d2 u1, d1 u2, d2 u2), then the rest of its moment int xi^perp . (u_h - u*) as a rigid
// rotation. `u` are the displacement coefficients.
double mean_rotation(const Kernel& k, const Scaled& s, const Eigen::MatrixXd& gradient,
                     const Eigen::Ref<const Eigen::VectorXd>& u) {
  const int D = k.element.rotation + 1, n = dim(D) - 1;
  const Eigen::MatrixXd d1 = derivative(D, 0), d2 = derivative(D, 1), product = moments(k, s, D);
  const Eigen::MatrixXd laplace =
      multiply(transposed_multiply(d1, product), d1) + multiply(transposed_multiply(d2, product), d2);
  const Eigen::LLT<Eigen::MatrixXd> llt = cholesky(laplace.bottomRightCorner(n, n));
  double left = 0;
  for (int row = 0; row < 2; ++row) {
    const Eigen::VectorXd right = transposed_multiply(d1, multiply(product, gradient.col(2 * row))) +
                                  transposed_multiply(d2, multiply(product, gradient.col(2 * row + 1)));
    const Eigen::VectorXd star = solve(llt, right.tail(n));
    Eigen::VectorXd rest = -star;
    for (int b = 1; b < u.size() / 2; ++b) rest[b - 1] += u[2 * b + row] / s.h;
    left += row == 0 ? -product.row(2).tail(n).dot(rest) : product.row(1).tail(n).dot(rest);
  }
  return -left / (product(1, 1) + product(2, 2));
}

}  // namespace

// Normal equations of the two derivatives; the constant is not seen by them and is set afterwards. The gradient of u,
// 11, 12, 21, 22, is e + Gamma(r) with the sign of (N.1).
Eigen::VectorXd rotation_of(const Kernel& k, const Scaled& s, const Material& material, const Eigen::VectorXd& all) {
  const Element& e = k.element;
  const int N = rotation_count(e);
  const Eigen::MatrixXd moment = moments(k, s, e.rotation), strain = strain_of(material, N, all);
  const Eigen::MatrixXd d1 = derivative(e.rotation, 0), d2 = derivative(e.rotation, 1);
  const Eigen::VectorXd along1 = multiply(d2, strain.col(0)) - multiply(d1, strain.col(1)),
                        along2 = multiply(d2, strain.col(1)) - multiply(d1, strain.col(2));
  const Eigen::MatrixXd stiffness =
      multiply(transposed_multiply(d1, moment), d1) + multiply(transposed_multiply(d2, moment), d2);
  const Eigen::VectorXd load =
      transposed_multiply(d1, multiply(moment, along1)) + transposed_multiply(d2, multiply(moment, along2));
  Eigen::VectorXd r(N);
  r.tail(N - 1) = solve_spd(stiffness.bottomRightCorner(N - 1, N - 1), load.tail(N - 1));
  r[0] = 0;
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(dim(e.rotation + 1), 4);
  gradient.topRows(N) << strain.col(0), strain.col(1) + r, strain.col(1) - r, strain.col(2);
  r[0] = mean_rotation(k, s, gradient, all.segment(stress_count(e), displacement_count(e)));
  return r;
}

}  // namespace kerf
