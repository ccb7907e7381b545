// A small free circular hole: form(s, t) = (4 s:t - tr s tr t)/E' [Garreau, Guillaume, Masmoudi 2001; theory: T.3]; in
// an orthotropic body by (O.16).

#include "topo/formulas/kind.hpp"
#include "topo/formulas/orthotropic_hole.hpp"
#include "topo/formulas/parts.hpp"
#include "topo/mutation.hpp"

namespace kerf {

double hole_form(const Material& m, const Mat2& s, const Mat2& t) {
  const Mat2 a = symmetric_part(s), b = symmetric_part(t);
  if (!isotropic(m)) return orthotropic_hole_form(m, Mat2::Identity(), a, b);
  return (4 * mutant(FormulaPart::HoleProduct) * a.cwiseProduct(b).sum() -
          mutant(FormulaPart::HoleTrace) * a.trace() * b.trace()) /
         plane_modulus(m);
}

double hole_energy(const Material& m, const Mat2& s, const Vec2& body, const Vec2& u) {
  return -0.5 * hole_form(m, s, s) + body.dot(u);
}

namespace {

std::string hole_in_words(const Perturbation&) {
  return "a hole of radius \u03b5";
}
double of_hole(const Perturbation&, const Material& m, double, const Mat2& s, const Mat2& t) {
  return hole_form(m, s, t);
}
Transmission no_stress(const Perturbation&, const Material&) {
  return {};
}

}  // namespace

constinit const PerturbationKind kinds::hole{
    .word = "hole", .description = hole_in_words, .form = of_hole, .inside = no_stress};

}  // namespace kerf
