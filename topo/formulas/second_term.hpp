#pragma once
// The second term of the expansion of a free hole or an inclusion [theory: Q.5, Q.8].

#include "kerf/perturbation.hpp"

#include <complex>

namespace kerf {

/// A field around a point without body force: phi = sum a_n z^n, psi = sum b_n z^n, z from the point [Muskhelishvili
/// 1953]. A rotation, the imaginary part of a_1, is left out.
struct TaylorField {
  double a1 = 0;
  std::complex<double> a2, a3, b1, b2;

  Mat2 stress() const;  // at the point
};
TaylorField operator+(const TaylorField& s, const TaylorField& t);
TaylorField operator*(double factor, const TaylorField& s);

/// What a circle of radius 1 sends out under a uniform stress: phi = -conj(b_1)/z, psi = -2 a_1/z with these strengths.
struct Dipoles {
  double a1 = 0;
  std::complex<double> b1;
};
/// Of free holes and inclusions alone.
Dipoles dipoles(const Perturbation& p, const Material& m, const TaylorField& s);

/// Parts of the form Q(s, t): J changes by pi eps^2 (form(s, zeta) + Q(s, zeta) eps^2), energies by -1/2 Q(s, s).
struct SecondForm {
  double mean_gradient = 0, deviator_gradient = 0;  // of the mean stress and of the deviator, at the point
  double curvature = 0;                             // of the mean stress
  double reply = 0;                                 // of the body to the dipoles
  double value() const {
    return mean_gradient + deviator_gradient + curvature + reply;
  }
};
SecondForm operator+(const SecondForm& s, const SecondForm& t);
SecondForm operator*(double factor, const SecondForm& s);

/// Symmetric in s and t. `reply` of the body to the dipoles of s.
SecondForm second_form(const Perturbation& p, const Material& m, const TaylorField& s, const TaylorField& t,
                       const TaylorField& reply);

/// Coefficients of pi eps^4 ln eps: of the potential energy, where a hole removes the body force; and of half the
/// square of the displacement, integrated over the body [theory: Q.9, Q.10].
double body_logarithm(const Material& m, const Vec2& force);
double tracking_logarithm(const Perturbation& p, const Material& m, const TaylorField& s);

}  // namespace kerf
