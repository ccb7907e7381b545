// Singular fields of a tip in an orthotropic material by divided differences of the two roots, which hold for equal
// roots [theory: O.8, O.9, O.10, O.11; Sih, Paris, Irwin 1965], and K, G, T from the integrals with them [theory:
// O.12].

#include "solver/post/orthotropic_tip.hpp"

#include "solver/element/local.hpp"
#include "solver/recovery.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Complex = std::complex<double>;

/// sqrt(cos + p sin), continuous in the angle past the crack on either side.
/// The argument of cos + p sin passes the negative axis behind the tip; there the root is that of the opposite
/// direction times +-i, so that each face has its own sign.
Complex root_at(const Complex& p, double angle) {
  constexpr double behind = pi / 2;
  if (std::abs(angle) <= behind) return std::sqrt(std::cos(angle) + p * std::sin(angle));
  const double side = angle > 0 ? 1 : -1, back = angle - side * pi;
  return Complex(0, side) * std::sqrt(std::cos(back) + p * std::sin(back));
}

LocalState state_from_stress(const Material& m, const Eigen::Vector3d& s, double rotation) {
  const Eigen::Vector4d stress(s[0], s[2], s[2], s[1]);
  return {tensor(stress), tensor(displacement_gradient(m, stress, rotation))};
}

/// The stress s_rr = e . L^-1 e_1/(-2 pi r S(angle)), S the compliance along the ray e: every ray is free.
/// The displacement goes like -a ln r: its derivative across the ray gives the rotation [theory: O.11].
LocalState under_force(const Material& m, const Vec2& e, double r) {
  const Vec2 a = -surface(m).inverse_L.col(0) / (2 * pi), across(-e.y(), e.x());
  const Mat2 ray = e * e.transpose(), own = strain(m, ray);
  const double stress = a.dot(e) / (own.cwiseProduct(ray).sum() * r);
  const double rotation = stress * e.dot(own * across) - across.dot(a) / r;
  return state_from_stress(m, stress * Eigen::Vector3d(ray(0, 0), ray(1, 1), ray(0, 1)), rotation);
}

}  // namespace

/// D is the divided difference of z^-1/2 between the roots, by a quotient that does not cancel when they are equal.
std::array<LocalState, 3> orthotropic_tip_fields(const Material& m, const Vec2& x, double angle) {
  const double r = x.norm(), size = 1 / std::sqrt(2 * pi * r);
  const Vec2 e(std::cos(angle), std::sin(angle));
  const auto [p, q] = roots(m);
  const Complex at_p = root_at(p, angle), at_q = root_at(q, angle);
  const Complex G = size / at_p, H = size / at_q;                        // z^-1/2 at both roots
  const Complex D = -size * e.y() / (at_p * at_q * (at_p + at_q));       // (G - H)/(p - q)
  const Complex E = p * D + H, F = p * p * D + (p + q) * H, pq = p * q;  // those of p G, p^2 G
  // (t - conj p)(t - conj q) at both roots
  const Complex at_first = (p - std::conj(p)) * (p - std::conj(q)), at_second = (q - std::conj(p)) * (q - std::conj(q));
  const double turn = -compliances(m).b11 / 4;
  const Eigen::Vector3d s_I(-(pq * E).real(), (G - p * D).real(), (pq * D).real());
  const Eigen::Vector3d s_II(-F.real(), -D.real(), E.real());
  return {state_from_stress(m, s_I, turn * (q * at_first * G + p * at_second * H).real()),
          state_from_stress(m, s_II, turn * (at_first * G + at_second * H).real()), under_force(m, e, r)};
}

/// The opening (L^-1 K)_2 is not below `least`; where it would be, K_I follows from it and from K_II.
Vec2 orthotropic_factors(const Material& m, const Vec2& integrals, double least) {
  const Mat2 inverse_L = surface(m).inverse_L;
  const Vec2 K = inverse_L.inverse() * Vec2(integrals[1], integrals[0]);  // K_II, K_I
  const double sliding = (least - inverse_L(1, 0) * K[0]) / inverse_L(1, 1);
  return {std::max(K[1], sliding), K[0]};
}

double orthotropic_release(const Material& m, const Vec2& K) {
  const Vec2 k(K[1], K[0]);
  return 0.5 * k.dot(surface(m).inverse_L * k);
}

/// Solves I = b11 s11 + b16 s12 + (b12 - w) s22 for s11; `traction` has s12 and s22 of the faces.
double orthotropic_t_stress(const Material& m, double integral, const Vec2& traction) {
  const PlaneCompliances b = compliances(m);
  return (integral - b.b16 * traction[0] - (b.b12 - surface(m).w) * traction[1]) / b.b11 - traction[1];
}

}  // namespace kerf
