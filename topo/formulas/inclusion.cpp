// A small circle of another material: form(s, t) = -(Ph tr s tr t + Pd dev s:dev t), and the multipliers of the uniform
// stress inside it [Ammari, Kang 2007; theory: T.9, T.11].

#include "topo/formulas/kind.hpp"
#include "topo/formulas/parts.hpp"
#include "topo/mutation.hpp"

namespace kerf {

namespace {

// kappa/(kappa + 1) with kappa = 1 + 8 mu c.
double eshelby(const Material& m) {
  return (1 + 8 * m.mu * m.c) / (2 + 8 * m.mu * m.c);
}

}  // namespace

// Ph = (c - c*) (1 + 4 mu c)/(1 + 4 mu c*), Pd = (r - 1)/(2 mu (1 + beta (r - 1))), r = mu*/mu; each divided by the
// larger of the pair, which may be infinite.
double inclusion_form(const Material& matrix, const Material& inside, const Mat2& s, const Mat2& t) {
  const double mu = matrix.mu, c = matrix.c, beta = eshelby(matrix), r = inside.mu / mu;
  const double contrast =
      inside.c > c ? (c / inside.c - 1) / (1 / inside.c + 4 * mu) : (c - inside.c) / (1 + 4 * mu * inside.c);
  const double hydrostatic = contrast * (1 + 4 * mu * c);
  const double deviatoric = (r > 1 ? (1 - 1 / r) / ((1 - beta) / r + beta) : (r - 1) / (1 + beta * (r - 1))) / (2 * mu);
  const PlaneParts a = split(s), b = split(t);
  return -4 * mutant(FormulaPart::InclusionTrace) * hydrostatic * a.mean * b.mean -
         2 * mutant(FormulaPart::InclusionDeviator) * deviatoric * (a.x * b.x + a.y * b.y);
}

namespace {

std::string inclusion_in_words(const Perturbation&) {
  return "an inclusion of radius \u03b5";
}
double of_inclusion(const Perturbation& p, const Material& m, double, const Mat2& s, const Mat2& t) {
  return inclusion_form(m, p.inclusion, s, t);
}
// gamma_h and gamma_d of the stress inside, gamma_h s I + gamma_d dev s.
Transmission transmitted(const Perturbation& p, const Material& m) {
  const double beta = eshelby(m);
  return {(1 + 4 * m.mu * m.c) / (1 + 4 * m.mu * p.inclusion.c), 1 / ((1 - beta) * (m.mu / p.inclusion.mu) + beta)};
}

}  // namespace

constinit const PerturbationKind kinds::inclusion{.word = "inclusion",
                                                  .description = inclusion_in_words,
                                                  .becomes = Becomes::Material,
                                                  .form = of_inclusion,
                                                  .inside = transmitted};

}  // namespace kerf
