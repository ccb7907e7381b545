// H(s, t) = A s:t + tr(t L^-1 s R) + w (s:t - tr s tr t) of a free ellipse in an orthotropic plane, with the tensors of
// its surface [Tsukrov, Kachanov 2000; theory: O.7, O.16].

#include "topo/formulas/orthotropic_hole.hpp"

#include "solver/anisotropic.hpp"

namespace kerf {

double orthotropic_hole_form(const Material& m, const Mat2& shape, const Mat2& s, const Mat2& t) {
  const Surface rim = surface(m);
  return strain(m, s).cwiseProduct(t).sum() + (t * rim.inverse_L * s * shape).trace() +
         rim.w * (s.cwiseProduct(t).sum() - s.trace() * t.trace());
}

PlaneParts orthotropic_squares(const Material& m, std::span<const Product> products) {
  const Mat2 inverse_L = surface(m).inverse_L;
  Mat2 sum = Mat2::Zero();
  for (const Product& q : products) sum += q.factor * symmetric_part(q.s) * inverse_L * symmetric_part(q.t);
  return split(sum);
}

}  // namespace kerf
