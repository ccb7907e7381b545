// The singular field of a tip of a crack along an arc.

#include "solver/nucleus.hpp"

#include <cmath>
#include <complex>

namespace kerf {

namespace {

using Complex = std::complex<double>;

Complex complex_of(const Vec2& x) {
  return {x.x(), x.y()};
}

/// phi = C (z - b)^1/2/(z - a)^1/2 + D ((z - a)(z - b))^1/2 with the cut along the arc, z from the center, and its
/// derivatives.
struct ArcPotential {
  Complex a, b, turn, C = 1, D = 0;  // turn: the root of the direction that (z - b)/(z - a) has across the arc

  struct Value {
    Complex f, d, dd;
  };
  /// The root has its cut where (z - b)/(z - a) lies on the ray opposite `turn`^2, which is the arc.
  Value operator()(const Complex& z) const {
    const Complex from = z - a, m = (z - b) / from, root = std::sqrt(m / (turn * turn)) * turn,
                  dm = (b - a) / (from * from), ddm = -2.0 * dm / from;
    const Complex d = dm / (2.0 * root), dd = ddm / (2.0 * root) - dm * dm / (4.0 * root * m);
    return {C * root + D * from * root, C * d + D * (root + from * d), C * dd + D * (2.0 * d + from * dd)};
  }
};

/// Of unit amplitude at the tip as tip_nucleus has it; psi has no pole at the center.
ArcPotential potential_of(const ArcTip& tip, const Complex& amplitude) {
  const Complex a = complex_of(tip.tip - tip.center), b = complex_of(tip.other - tip.center),
                mid = complex_of(tip.inside - tip.center);
  const Complex across = -(mid - b) / (mid - a);
  ArcPotential p{a, b, std::sqrt(across / std::abs(across))};
  const Complex ahead = complex_of(tip.frame.col(0)), root = std::sqrt((a - b) / ahead / (p.turn * p.turn)) * p.turn;
  const Complex first = -2.0 * amplitude * ahead / root;
  // conj(D) = phi'(0)
  // phi = C Q + D (z - a) Q with |((z - a) Q)'(0)| < 1: with s = C Q'(0) and o that derivative, conj(D) = s + o D gives
  // D.
  const Complex slope = p(0).d * first, other = ArcPotential{a, b, p.turn, 0, 1}(0).d;
  p.D = (std::conj(slope) + std::conj(other) * slope) / (1 - std::norm(other));
  p.C = first;
  return p;
}

}  // namespace

// Faces are free when phi is continued as itself across the circle: 2 mu u = kappa phi(z) - phi(R^2/conj(z))
// - (z - R^2/conj(z)) conj(phi'(z)) [Muskhelishvili 1953].
Nucleus arc_tip_nucleus(const Material& m, const ArcTip& tip, int mode) {
  const double size = plane_modulus(m) / (8 * std::sqrt(2 * pi)), mu = m.mu, k = 8 * m.mu / plane_modulus(m) - 1,
               square = (tip.tip - tip.center).squaredNorm();
  const ArcPotential potential = potential_of(tip, mode == 1 ? Complex(size) : Complex(0, -size));
  const Vec2 center = tip.center;
  return {[=](const Vec2& at) -> Vec2 {
            const Complex z = complex_of(at - center), mirrored = square / std::conj(z);
            const ArcPotential::Value here = potential(z), there = potential(mirrored);
            const Complex u = (k * here.f - there.f - (z - mirrored) * std::conj(here.d)) / (2 * mu);
            return {u.real(), u.imag()};
          },
          [=](const Vec2& at) -> Mat2 {
            const Complex z = complex_of(at - center), part = square / z;
            const ArcPotential::Value here = potential(z), there = potential(std::conj(part));
            const Complex apart = 2.0 * ((std::conj(z) - part) * here.dd + part / z * (here.d - std::conj(there.d)));
            const double mean = 2 * here.d.real();
            return (Mat2() << mean - 0.5 * apart.real(), 0.5 * apart.imag(), 0.5 * apart.imag(),
                    mean + 0.5 * apart.real())
                .finished();
          }};
}

}  // namespace kerf
