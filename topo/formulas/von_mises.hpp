#pragma once
// Powers of the von Mises stress, Phi = V^(p/2), and what a small hole or inclusion does to int w Phi by its own stress
// field [theory: T.18, T.19].

#include "kerf/perturbation.hpp"

#include <vector>

namespace kerf {

/// V = share sm^2 + 3 d^2 with sm, d half the sum and half the difference of the principal stresses in the plane.
struct VonMises {
  double share = 1;  // plane stress
};
/// share = (1 - 2 nu)^2 = (4 mu c)^2.
constexpr VonMises von_mises_plane_strain(const Material& m) {
  return {16 * m.mu * m.mu * m.c * m.c};
}

/// V(s), stress^2. In all functions here s is symmetrized.
double square(const VonMises& v, const Mat2& s);
/// Phi(s) = V^(p/2), p >= 1.
double power(const VonMises& v, double p, const Mat2& s);
/// Phi'(s) = (p/2) V^(p/2-1) (share sm I + 3 dev s); Phi'(s):s = p Phi. Where V = 0 the result is zero, which is the
/// limit for p > 1; for p = 1 the derivative jumps there and zero is one of its subgradients.
Mat2 power_derivative(const VonMises& v, double p, const Mat2& s);

/// ((1 + x)^h - 1 - h x)/x^2 for |x| below 0.1, to rounding.
double power_remainder(double h, double x);
/// Throws (Usage) for p outside [1, 100] or, with 1 <= p < 2, a share below 1e-3, where Psi has an infinite slope at
/// d = 0 or, for p = 1, is infinite.
void require_power(const VonMises& v, double p);

/// Psi(s) = (1/pi) int_{|y|>1} [Phi(s + w) - Phi(s) - Phi'(s):w] dy with w the stress that the perturbation of radius 1
/// adds outside. Psi = (sm^2 + d^2)^(p/2) psi(y), y = d^2/(sm^2 + d^2): Chebyshev sums of psi on pieces of [0, 1].
struct PowerTable {
  VonMises outer, inner;
  double p = 2;
  Transmission inside;
  std::vector<double> ends;  // of the pieces, from 0 to 1
  Eigen::MatrixXd sums;      // one column of coefficients per piece
};

/// Builds the table: exact up to rounding for even p, else relative error 1e-10 (measured for shares from 0.16 on).
/// `inner` is the von Mises stress of the material inside (a hole has none). Throws as
/// require_power [Amstutz, Novotny 2010; theory: T.20, T.22].
PowerTable tabulate(const VonMises& outer, double p, const Transmission& inside = {}, const VonMises& inner = {});

double exterior(const PowerTable& table, const Mat2& s);

/// The local term of T for int w Phi: w (Phi*(s_in) - Phi(s) - Phi'(s):(s_in - s) + Psi(s)), s_in the uniform stress
/// inside, Phi* that of the inner material. A hole has s_in = 0.
double local_term(const PowerTable& table, const Mat2& s, double weight = 1);

}  // namespace kerf
