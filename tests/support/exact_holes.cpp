// Elliptic hole under a far stress [Inglis 1913]; disc with a concentric hole or inclusion under S n on its rim.
#include "tests/support/exact_families.hpp"

#include <Eigen/LU>

#include <cmath>

namespace kerf::exact {

namespace {

Complex deviator(const Mat2& s) {
  return {(s(1, 1) - s(0, 0)) / 2, s(0, 1)};
}

struct Ellipse {
  double R, m, G;  // z = R (zeta + m/zeta)
  Complex A;       // phi = R (G zeta - A/zeta)
};

Potentials evaluate(const Ellipse& e, const Complex& w) {
  const auto& [R, m, G, A] = e;
  const double focus = 2 * R * std::sqrt(m);
  Complex q = std::sqrt(w - focus) * std::sqrt(w + focus);
  if ((w * std::conj(q)).real() < 0) q = -q;
  const Complex z = (w + q) / (2 * R), inverse = 1.0 / z;
  const Complex dw = R * (1.0 - m * inverse * inverse), ddw = 2 * R * m * inverse * inverse * inverse;
  const Complex f1 = R * (G + A * inverse * inverse), f2 = -2 * R * A * inverse * inverse * inverse;
  const Complex dphi = f1 / dw, ddphi = (f2 * dw - f1 * ddw) / (dw * dw * dw);
  // psi = -conj(phi)(1/zeta) - h phi', h = conj(z)(1/zeta)
  const Complex h = R * (inverse + m * z), h1 = R * (m - inverse * inverse), C = std::conj(A);
  const Complex dpsi = R * (G * inverse * inverse + C) - h1 * dphi - h * ddphi * dw;
  return {R * (G * z - A * inverse), dphi, ddphi, -R * (G * inverse - C * z) - h * dphi, dpsi / dw};
}

/// phi = A z + B z^3 + C/z, psi = D z + F/z + H/z^3
struct Laurent {
  Complex A, B, C, D, F, H;
};

Potentials evaluate(const Laurent& l, const Complex& z) {
  const Complex q = z == 0.0 ? Complex(0) : 1.0 / z, q2 = q * q, z2 = z * z;
  return {l.A * z + l.B * z2 * z + l.C * q, l.A + 3.0 * l.B * z2 - l.C * q2, 6.0 * l.B * z + 2.0 * l.C * q2 * q,
          l.D * z + l.F * q + l.H * q2 * q, l.D - l.F * q2 - 3.0 * l.H * q2 * q2};
}

}  // namespace

ExactField inglis(std::string name, const Material& m, const EllipticHole& hole) {
  const double a = hole.semi_axes.x(), b = hole.semi_axes.y(), G = hole.far_stress.trace() / 4;
  const Complex D = deviator(hole.far_stress) * std::polar(1.0, 2 * hole.angle);
  const double flat = (a - b) / (a + b);
  const Ellipse e{(a + b) / 2, flat, G, std::conj(D) + flat * G};
  ExactField field = from_potentials(std::move(name), m, Vec2::Zero(), hole.angle,
                                     [e](const Complex& z, int) { return evaluate(e, z); });
  field.side = [](const Vec2&) { return 0; };
  return field;
}

ExactField annulus(std::string name, const Material& m, const Annulus& ring) {
  const double a = ring.inner, R = ring.outer, p = ring.pressure, P = ring.stress.trace() / 2;
  const Complex D = deviator(ring.stress);
  const double A = (P * R * R + p * a * a) / (2 * (R * R - a * a));
  // b, c, d, h of B = b D, C = c conj(D), ...: tractions of the powers -3 and 1 on both rims
  Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
  M.row(0) << R * R * R, -1 / R, 0, 1 / (R * R * R);
  M.row(1) << 3 * R * R * R, 1 / R, R, 0;
  M.row(2) << a * a * a, -1 / a, 0, 1 / (a * a * a);
  M.row(3) << 3 * a * a * a, 1 / a, a, 0;
  const Eigen::Vector4d x = M.lu().solve(Eigen::Vector4d(0, R, 0, 0));
  const Laurent l{A, x[0] * D, x[1] * std::conj(D), x[2] * D, -(p + 2 * A) * a * a, x[3] * std::conj(D)};
  ExactField field =
      from_potentials(std::move(name), m, Vec2::Zero(), 0, [l](const Complex& z, int) { return evaluate(l, z); });
  field.side = [](const Vec2&) { return 0; };
  return field;
}

TwoPhases inclusion(std::string name, const Material& matrix, const Material& inside, const Annulus& ring) {
  const double a = ring.inner, R = ring.outer, P = ring.stress.trace() / 2, a3 = a * a * a, R3 = R * R * R;
  const double k1 = kolosov(matrix), m1 = matrix.mu, k0 = kolosov(inside), m0 = inside.mu;
  const Complex D = deviator(ring.stress);
  Eigen::Matrix3d mean;  // A, F outside, A inside: traction on the rim, traction and displacement on the interface
  mean << 2 * R, 1 / R, 0, 2 * a, 1 / a, -2 * a, (k1 - 1) * a / m1, -1 / (a * m1), -(k0 - 1) * a / m0;
  const Eigen::Vector3d y = mean.lu().solve(Eigen::Vector3d(P * R, 0, 0));
  // b, c, d, h outside, b, d inside
  Eigen::Matrix<double, 6, 6> M;
  M << R3, -1 / R, 0, 1 / R3, 0, 0,                                 //
      3 * R3, 1 / R, R, 0, 0, 0,                                    //
      a3, -1 / a, 0, 1 / a3, -a3, 0,                                //
      3 * a3, 1 / a, a, 0, -3 * a3, -a,                             //
      k1 * a3 / m1, 1 / a / m1, 0, -1 / a3 / m1, -k0 * a3 / m0, 0,  //
      -3 * a3 / m1, k1 / a / m1, -a / m1, 0, 3 * a3 / m0, a / m0;
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  right[1] = R;
  const Eigen::Matrix<double, 6, 1> x = M.lu().solve(right);
  const Laurent out{y[0], x[0] * D, x[1] * std::conj(D), x[2] * D, y[1], x[3] * std::conj(D)};
  const Laurent in{y[2], x[4] * D, 0, x[5] * D, 0, 0};
  const auto field = [&](const Material& m, const Laurent& l) {
    ExactField f = from_potentials(name, m, Vec2::Zero(), 0, [l](const Complex& z, int) { return evaluate(l, z); });
    f.side = [](const Vec2&) { return 0; };
    return f;
  };
  return {field(matrix, out), field(inside, in)};
}

}  // namespace kerf::exact
