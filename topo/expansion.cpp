#include "topo/expansion.hpp"

namespace kerf {

double hole_form(const Material& m, const Mat2& s, const Mat2& t) {
  const Mat2 a = 0.5 * (s + s.transpose()), b = 0.5 * (t + t.transpose());
  return (4 * a.cwiseProduct(b).sum() - a.trace() * b.trace()) / plane_modulus(m);
}

double hole_energy(const Material& m, const Mat2& s, const Vec2& body, const Vec2& u) {
  return -0.5 * hole_form(m, s, s) + body.dot(u);
}

}  // namespace kerf
