// The second term of a circle in any field: Q(s, t) of the Taylor coefficients a_n, b_n of Kolosov's potentials, and
// the coefficients of eps^4 ln eps where the series has a logarithm [theory: Q.5, Q.7, Q.8, Q.9, Q.10].

#include "topo/formulas/second_term.hpp"

#include "topo/formulas/clamped_hole.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/mutation.hpp"

#include <cmath>

namespace kerf {

namespace {

using Complex = std::complex<double>;

//  Re a conj(b)
double product(const Complex& a, const Complex& b) {
  return (a * std::conj(b)).real();
}

// How much of a uniform mean stress, of a gradient of it and of a uniform deviator a circle answers: 1 for a hole.
// r1, r2, q of (Q.7): r1 = 1 - gamma_h, q = 1 - gamma_d of the stress inside.
struct Shares {
  double mean = 1, gradient = 1, deviator = 1;
};

// (s kappa_i - kappa)/(1 + s kappa_i), s = mu/mu_i: the rim under phi = z^2.
double gradient_share(const Material& m, const Material& inside) {
  // An infinitely soft inside is a hole.
  const double product = m.mu / inside.mu + 8 * m.mu * inside.c;
  if (std::isinf(product)) return 1;
  return mutant(FormulaPart::SecondInclusion) * (product - kolosov(m)) / (1 + product);
}

Shares shares(const Perturbation& p, const Material& m) {
  const Transmission through = inside(p, m);
  return {1 - through.hydrostatic, row(p).becomes == Becomes::Material ? gradient_share(m, p.inclusion) : 1,
          1 - through.deviatoric};
}

}  // namespace

Mat2 TaylorField::stress() const {
  // s22 - s11 + 2i s12 = 2 b1
  return (Mat2() << 2 * a1 - b1.real(), b1.imag(), b1.imag(), 2 * a1 + b1.real()).finished();
}
TaylorField operator+(const TaylorField& s, const TaylorField& t) {
  return {s.a1 + t.a1, s.a2 + t.a2, s.a3 + t.a3, s.b1 + t.b1, s.b2 + t.b2};
}
TaylorField operator*(double factor, const TaylorField& s) {
  return {factor * s.a1, factor * s.a2, factor * s.a3, factor * s.b1, factor * s.b2};
}

Dipoles dipoles(const Perturbation& p, const Material& m, const TaylorField& s) {
  const Shares share = shares(p, m);
  return {share.mean * s.a1, share.deviator * s.b1};
}

SecondForm operator+(const SecondForm& s, const SecondForm& t) {
  return {s.mean_gradient + t.mean_gradient, s.deviator_gradient + t.deviator_gradient, s.curvature + t.curvature,
          s.reply + t.reply};
}
SecondForm operator*(double factor, const SecondForm& s) {
  return {factor * s.mean_gradient, factor * s.deviator_gradient, factor * s.curvature, factor * s.reply};
}

SecondForm second_form(const Perturbation& p, const Material& m, const TaylorField& s, const TaylorField& t,
                       const TaylorField& reply) {
  const Shares share = shares(p, m);
  const Dipoles sent = dipoles(p, m, t);
  const double size = 8 / plane_modulus(m);
  return {
      .mean_gradient = size * 2 * mutant(FormulaPart::SecondMeanGradient) * share.gradient * product(s.a2, t.a2),
      .deviator_gradient =
          size * 2 * mutant(FormulaPart::SecondDeviatorGradient) * share.deviator * product(s.b2, t.b2),
      .curvature = size * 3 * mutant(FormulaPart::SecondCurvature) * share.deviator *
                   (product(s.b1, t.a3) + product(t.b1, s.a3)),
      .reply = size * (2 * mutant(FormulaPart::SecondReplyMean) * sent.a1 * reply.a1 +
                       mutant(FormulaPart::SecondReplyDeviator) * product(sent.b1, reply.b1)),
  };
}

double body_logarithm(const Material& m, const Vec2& force) {
  const double k = kolosov(m);
  return mutant(FormulaPart::SecondLogarithm) * k * force.squaredNorm() / (4 * m.mu * (1 + k));
}

double tracking_logarithm(const Perturbation& p, const Material& m, const TaylorField& s) {
  const double k = kolosov(m);
  const Dipoles sent = dipoles(p, m, s);
  return -mutant(FormulaPart::SecondLogarithm) * ((k * k + 1) * std::norm(sent.b1) + 4 * sent.a1 * sent.a1) /
         (4 * m.mu * m.mu);
}

}  // namespace kerf
