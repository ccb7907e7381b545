#include "solver/post/polynomial_state.hpp"

#include "solver/element/local.hpp"
#include "solver/recovery.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <complex>

namespace kerf {

namespace {

/// s11, s22, s12 and the rotation (d2 u1 - d1 u2)/2, times 2 mu: in the units of a stress.
using Values = Eigen::Vector4d;

/// s11 + s22 = 4 Re phi', s22 - s11 + 2i s12 = 2 (conj(z) phi'' + psi'), rotation = -(kappa + 1)/(2 mu) Im phi'.
Values of_potentials(const Material& m, std::complex<double> phi, std::complex<double> turning) {
  const double trace = 4 * phi.real(), kappa_plus_1 = 2 + 8 * m.mu * m.c;
  return {trace / 2 - turning.real(), trace / 2 + turning.real(), turning.imag(), -kappa_plus_1 * phi.imag()};
}

/// Per coefficient the values at z.
Eigen::Matrix4Xd basis(const Material& m, int degree, std::complex<double> z) {
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
Values of_force(const Material& m, const Vec2& f, const Vec2& x) {
  const double turn = 1 / (4 * m.mu) - m.c;
  return {-f.x() * x.x(), -f.y() * x.y(), 0, 2 * m.mu * turn * (f.y() * x.x() - f.x() * x.y())};
}

LocalState state_of(const Material& m, const Values& v) {
  const Eigen::Vector4d stress(v[0], v[2], v[2], v[1]);
  return {tensor(stress), tensor(displacement_gradient(m, stress, v[3] / (2 * m.mu)))};
}

std::complex<double> place(const Vec2& x, double scale) {
  return {x.x() / scale, x.y() / scale};
}

}  // namespace

LocalState PolynomialState::at(const Vec2& x) const {
  const Eigen::Matrix4Xd b = basis(material, degree, place(x, scale));
  return state_of(material, b.leftCols(coefficients.size()) * coefficients + of_force(material, force, x));
}

double PolynomialState::t_stress() const {
  return coefficients.size() > 2 ? -2 * coefficients[2] : 0;
}

PolynomialState fit_state(const Material& material, int degree, const Vec2& force,
                          const std::vector<StateSample>& samples) {
  PolynomialState state{.material = material, .degree = degree, .force = force, .coefficients = {}};
  const Eigen::Index n = 4 * (degree + 1);
  double far = 0;
  for (const StateSample& s : samples) far = std::max(far, s.x.norm());
  state.scale = far > 0 ? far : 1;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const StateSample& s : samples) {
    const Eigen::Matrix4Xd b = basis(material, degree, place(s.x, state.scale));
    const Values value(s.stress(0, 0), s.stress(1, 1), s.stress(0, 1), 2 * material.mu * s.rotation);
    normal += s.weight * b.transpose() * b;
    right += s.weight * b.transpose() * (value - of_force(material, force, s.x));
  }
  state.coefficients = normal.completeOrthogonalDecomposition().solve(right);
  return state;
}

PolynomialState uniform_pressure(const Material& material, double stress) {
  return {.material = material, .coefficients = Eigen::VectorXd::Constant(1, stress / 2)};
}

}  // namespace kerf
