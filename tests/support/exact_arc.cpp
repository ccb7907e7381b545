// Crack along a circular arc under a uniform far stress [Muskhelishvili 1953; Cotterell, Rice 1980 for K]. With R = 1,
// the middle of the arc at z = 1, p = cos(half_angle), X^2 = z^2 - 2 p z + 1 cut along the arc:
//   phi = (X h + D0 z - C/z)/2,   omega = (X h - D0 z + C/z)/2,   psi = conj(omega)(1/z) - phi'/z,   h = c + d/z.
#include "tests/support/exact_families.hpp"

#include <cmath>

namespace kerf::exact {

namespace {

struct Arc {
  double p, R;
  Complex tip;  // at +half_angle on the unit circle
  Complex c, d, D0, C;
};

/// Values on the arc itself: side +1 from outside.
Complex root(const Arc& arc, const Complex& z, bool on_arc, int side) {
  const Complex a = arc.tip, b = std::conj(arc.tip);
  const Complex turn = -(1.0 - a) / (1.0 - b);  // makes q < 0 on the arc
  const Complex q = (z - a) / (z - b) / turn;
  if (!on_arc) return (z - b) * std::sqrt(q) * std::sqrt(turn);
  const Complex outside = (1.0 + 1e-8 - a) / (1.0 + 1e-8 - b) / turn;
  const double sign = (outside.imag() >= 0 ? 1 : -1) * (side > 0 ? 1 : -1);
  return (z - b) * Complex(0, sign * std::sqrt(std::abs(q))) * std::sqrt(turn);
}

Potentials evaluate(const Arc& arc, const Complex& w, int side) {
  const Complex z = w / arc.R;
  const bool on_arc = side != 0 && std::abs(std::abs(z) - 1) < 1e-13 && z.real() > arc.p;
  const auto& [p, R, tip, c, d, D0, C] = arc;
  const Complex X = root(arc, z, on_arc, side);
  const Complex X1 = (z - p) / X, X2 = 1.0 / X - (z - p) * (z - p) / (X * X * X);
  const Complex h = c + d / z, h1 = -d / (z * z), h2 = 2.0 * d / (z * z * z);
  const Complex f = (X * h + D0 * z - C / z) / 2.0, f1 = (X1 * h + X * h1 + D0 + C / (z * z)) / 2.0,
                f2 = (X2 * h + 2.0 * X1 * h1 + X * h2 - 2.0 * C / (z * z * z)) / 2.0;
  // The image point; a point of the arc is its own image, seen from the other side.
  const Complex v = 1.0 / std::conj(z), V = on_arc ? -X : root(arc, v, false, 0);
  const Complex g = c + d / v, g1 = -d / (v * v);
  const Complex omega = (V * g - D0 * v + C / v) / 2.0, omega1 = ((v - p) / V * g + V * g1 - D0 - C / (v * v)) / 2.0;
  return {R * f, f1, f2 / R, R * (std::conj(omega) - f1 / z), -std::conj(omega1) / (z * z) - f2 / z + f1 / (z * z)};
}

/// Stress intensities at the end at +half_angle (sign = 1) or -half_angle.
ExactTip tip_of(const Arc& arc, double middle, int sign) {
  const Complex t = sign > 0 ? arc.tip : std::conj(arc.tip), along = t * Complex(0, sign);
  // Near t: X = sqrt(t - conj t) sqrt(z - t), on the branch that X has a little further on.
  const double step = 1e-6;
  Complex X = std::sqrt((t - std::conj(t)) * along);
  if ((X * std::conj(root(arc, t + step * along, false, 0))).real() < 0) X = -X;
  const Complex k = std::sqrt(2 * pi * arc.R) * (t - arc.p) * (arc.c + arc.d / t) / X;
  const Complex at = arc.R * t * std::polar(1.0, middle);
  return {{at.real(), at.imag()}, k.real(), -k.imag()};
}

}  // namespace

ExactField arc_crack(std::string name, const Material& m, const ArcCrack& crack) {
  const Mat2& s = crack.far_stress;
  const double p = std::cos(crack.half_angle), P = s.trace() / 2;
  const Complex D = Complex((s(1, 1) - s(0, 0)) / 2, s(0, 1)) * std::polar(1.0, 2 * crack.middle), d = -std::conj(D);
  const Complex right = 2 * P - (1 - p * p) / 2 * std::conj(d);
  const Complex c(right.real() / (3 - p), right.imag() / (1 + p));
  const Arc arc{p, crack.radius, std::polar(1.0, crack.half_angle), c, d, P - c, std::conj(D)};
  ExactField field = from_potentials(std::move(name), m, Vec2::Zero(), crack.middle,
                                     [arc](const Complex& z, int side) { return evaluate(arc, z, side); });
  field.tips = {tip_of(arc, crack.middle, 1), tip_of(arc, crack.middle, -1)};
  field.side = [radius = crack.radius](const Vec2& x) { return (x.norm() > radius) - (x.norm() < radius); };
  return field;
}

}  // namespace kerf::exact
