// A small free ellipse of area pi eps^2 and aspect r: form(s, t) = (2 s:t - tr s tr t + 2r (s f).(t f) + 2/r (s e).(t
// e))/E', e along the longer axis, f across [Kachanov 1993; theory: T.12]; in an orthotropic body by (O.16).

#include "topo/formulas/axes.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/formulas/orthotropic_hole.hpp"
#include "topo/mutation.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

// A circle (r = 1) has f f' + e e' = I, and with it the form 4 s:t - tr s tr t of a round hole.
double ellipse_form(const Material& m, double aspect, double angle, const Mat2& s, const Mat2& t) {
  if (!(aspect >= 1))
    throw Error(Fault::Usage, "elliptic hole: the aspect is " + std::to_string(aspect) + ", it must be at least 1");
  const Mat2 a = symmetric_part(s), b = symmetric_part(t);
  const Vec2 longer(std::cos(angle), std::sin(angle)), shorter(-longer.y(), longer.x());
  if (!isotropic(m))
    return orthotropic_hole_form(m, longer * longer.transpose() / aspect + aspect * shorter * shorter.transpose(), a,
                                 b);
  return (2 * mutant(FormulaPart::EllipseProduct) * a.cwiseProduct(b).sum() -
          mutant(FormulaPart::EllipseTrace) * a.trace() * b.trace() +
          2 * mutant(FormulaPart::EllipseShorter) * aspect * (a * shorter).dot(b * shorter) +
          2 / aspect * mutant(FormulaPart::EllipseLonger) * (a * longer).dot(b * longer)) /
         plane_modulus(m);
}

namespace {

std::string ellipse_in_words(const Perturbation& p) {
  return fmt::format("an elliptic hole of area \u03c0 \u03b5\u00b2 and axis ratio {:g} in its best direction",
                     p.aspect);
}
double of_ellipse(const Perturbation& p, const Material& m, double angle, const Mat2& s, const Mat2& t) {
  return ellipse_form(m, p.aspect, angle, s, t);
}
Oriented best(const Perturbation& p, const Material& m, std::span<const Product> products) {
  Oriented best;
  // The least T has the longer axis where e.M e is largest; a circle has no axis [theory: T.14].
  if (p.aspect > 1) best.angle = axis(isotropic(m) ? squares(products) : orthotropic_squares(m, products));
  for (const Product& q : products) best.value += q.factor * ellipse_form(m, p.aspect, best.angle, q.s, q.t);
  return best;
}

}  // namespace

constinit const PerturbationKind kinds::ellipse{
    .word = "ellipse", .description = ellipse_in_words, .elliptic = true, .form = of_ellipse, .orient = best};

}  // namespace kerf
