// States whose stress is a polynomial and in equilibrium, fitted to samples of a discrete state [theory: F.7].
// Isotropic:
//   s11 + s22 = 4 Re phi',  s22 - s11 + 2 i s12 = 2 (conj(z) phi'' + psi'),  rotation = -(kappa + 1)/(2 mu) Im phi',
//   phi' = sum a_n z^n, psi' = sum b_n z^n, n <= degree      [Muskhelishvili 1953];
// orthotropic with powers of both z_k = x + p_k y and their divided differences [theory: O.13]. A state under a uniform
// body force is linear. Rotations count as stresses, times 2 mu. Least squares over the samples of all processes;
// coefficients that the samples do not determine are 0 by the least norm. Interaction integrals of such a state are
// known, so that fracture.cpp takes it out before the quadrature. docs/theory/fracture.md, "Polynomial states".

#include "solver/post/polynomial_state.hpp"

#include "base/dense.hpp"
#include "solver/anisotropic.hpp"
#include "solver/element/local.hpp"
#include "solver/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace kerf {

namespace {

/// s11, s22, s12 and the rotation (d2 u1 - d1 u2)/2, times 2 mu: in the units of a stress.
using StateValues = Eigen::Vector4d;

/// s11 + s22 = 4 Re phi', s22 - s11 + 2i s12 = 2 (conj(z) phi'' + psi'), rotation = -(kappa + 1)/(2 mu) Im phi'.
/// `turning` is conj(z) phi'' + psi'.
StateValues of_potentials(const Material& m, std::complex<double> phi, std::complex<double> turning) {
  const double trace = 4 * phi.real(), kappa_plus_1 = 2 + 8 * m.mu * m.c;
  return {trace / 2 - turning.real(), trace / 2 + turning.real(), turning.imag(), -kappa_plus_1 * phi.imag()};
}

/// F'' = Re sum f_k(x + p_k y) with f_k' = A z^n for the first root and with the divided difference of both, B (z_1^n,
/// - z_2^n)/(p_1 - p_2), which stays for equal roots [theory: O.13].
/// Columns 4 n to 4 n + 3: real and imaginary part of A, then of B, of degree n.
Eigen::Matrix4Xd orthotropic_basis(const Material& m, int degree, const Vec2& x) {
  Eigen::Matrix4Xd values(4, 4 * (degree + 1));
  using Complex = std::complex<double>;
  const auto [p, q] = roots(m);
  const double half = 0.5 * compliances(m).b11, unit = 2 * m.mu;
  const Complex first = (p - std::conj(p)) * (p - std::conj(q)), second = (q - std::conj(p)) * (q - std::conj(q)),
                z = x.x() + p * x.y(), w = x.x() + q * x.y();
  Complex at_z = 1, at_w = 1, difference = 0;  // powers, and (z^n - w^n)/(p - q)
  for (int n = 0; n <= degree; ++n) {
    for (int k = 0; k < 2; ++k) {
      const Complex one = k == 0 ? 1 : Complex(0, 1), A = one * at_z, B = one * difference, C = one * at_w;
      values.col(4 * n + k) << (p * p * A).real(), A.real(), -(p * A).real(),
          unit * half * ((p - q) * first * A).real() * 0.5;
      values.col(4 * n + 2 + k) << (p * p * B + (p + q) * C).real(), B.real(), -(p * B + C).real(),
          unit * half * 0.5 * (one * (first * at_z + second * at_w)).real();
    }
    difference = z * difference + x.y() * at_w;  // z^(n+1) - w^(n+1) = z (z^n - w^n) + (z - w) w^n
    at_z *= z;
    at_w *= w;
  }
  return values;
}

/// Per coefficient the values at z.
Eigen::Matrix4Xd basis(const Material& m, int degree, std::complex<double> z) {
  if (!isotropic(m)) return orthotropic_basis(m, degree, {z.real(), z.imag()});
  Eigen::Matrix4Xd values(4, 4 * (degree + 1));
  std::complex<double> power = 1, slope = 0;  // z^n and its derivative
  for (int n = 0; n <= degree; ++n) {
    const std::complex<double> turn = std::conj(z) * slope, i(0, 1);
    values.col(4 * n) = of_potentials(m, power, turn);
    values.col(4 * n + 1) = of_potentials(m, i * power, i * turn);
    values.col(4 * n + 2) = of_potentials(m, 0, power);
    values.col(4 * n + 3) = of_potentials(m, 0, i * power);
    slope = double(n + 1) * power;
    power *= z;
  }
  return values;
}

/// s11 = -f1 x, s22 = -f2 y: in balance with f, and compatible because it is linear.
/// The rotation of an orthotropic material stands below (O.13) in docs/theory/orthotropic.md.
StateValues of_force(const Material& m, const Vec2& f, const Vec2& x) {
  if (!isotropic(m)) {
    const PlaneCompliances b = compliances(m);
    const double rotation =
        (0.5 * b.b16 * f.x() - b.b12 * f.y()) * x.x() + (b.b12 * f.x() - 0.5 * b.b26 * f.y()) * x.y();
    return {-f.x() * x.x(), -f.y() * x.y(), 0, 2 * m.mu * rotation};
  }
  const double turn = 1 / (4 * m.mu) - m.c;
  return {-f.x() * x.x(), -f.y() * x.y(), 0, 2 * m.mu * turn * (f.y() * x.x() - f.x() * x.y())};
}

LocalState state_from_values(const Material& m, const StateValues& v) {
  const Eigen::Vector4d stress(v[0], v[2], v[2], v[1]);
  return {tensor(stress), tensor(displacement_gradient(m, stress, v[3] / (2 * m.mu)))};
}

std::complex<double> scaled_point(const Vec2& x, double scale) {
  return {x.x() / scale, x.y() / scale};
}

}  // namespace

LocalState PolynomialState::at(const Vec2& x) const {
  const Eigen::Matrix4Xd b = basis(material, degree, scaled_point(x, scale));
  return state_from_values(material, b.leftCols(coefficients.size()) * coefficients + of_force(material, force, x));
}

/// s_xx - s_yy = -2 Re psi' at 0, and column 2 is Re b_0.
double PolynomialState::t_stress() const {
  if (!isotropic(material)) {
    const Mat2 s = at(Vec2::Zero()).stress;
    return s(0, 0) - s(1, 1);
  }
  return coefficients.size() > 2 ? -2 * coefficients[2] : 0;
}

/// Places are divided by the distance of the farthest sample: the powers stay below 1. The normal matrix is of size 4
/// (degree + 1); `sums` adds it over processes.
PolynomialState fit_state(const Material& material, int degree, const Vec2& force,
                          const std::vector<StateSample>& samples, const Sums& sums) {
  PolynomialState state{.material = material, .degree = degree, .force = force, .coefficients = {}};
  const Eigen::Index n = 4 * (degree + 1);
  double far = 0;
  for (const StateSample& s : samples) far = std::max(far, s.x.norm());
  if (sums.most) sums.most({&far, 1});
  state.scale = far > 0 ? far : 1;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const StateSample& s : samples) {
    const Eigen::Matrix4Xd b = basis(material, degree, scaled_point(s.x, state.scale));
    const StateValues value(s.stress(0, 0), s.stress(1, 1), s.stress(0, 1), 2 * material.mu * s.rotation);
    normal += s.weight * b.transpose() * b;
    right += s.weight * b.transpose() * (value - of_force(material, force, s.x));
  }
  if (sums.add) {
    sums.add({normal.data(), static_cast<std::size_t>(normal.size())});
    sums.add({right.data(), static_cast<std::size_t>(right.size())});
  }
  state.coefficients = solve_least_norm(normal, right);
  return state;
}

/// Isotropic: s11 = s22 = 2 Re a_0.
PolynomialState uniform_pressure(const Material& material, double stress) {
  if (!isotropic(material)) {
    const Eigen::Matrix4d constant = orthotropic_basis(material, 0, Vec2::Zero());
    return {.material = material, .coefficients = constant.inverse() * StateValues(stress, stress, 0, 0)};
  }
  return {.material = material, .coefficients = Eigen::VectorXd::Constant(1, stress / 2)};
}

}  // namespace kerf
