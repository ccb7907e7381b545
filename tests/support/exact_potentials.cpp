// Fields from Goursat's functions phi and psi [Muskhelishvili 1953], in a turned frame:
//   2 mu u = kappa phi - z conj(phi') - conj(psi),
//   sxx + syy = 4 Re phi',  syy - sxx + 2i sxy = 2 (conj(z) phi'' + psi').

#include "tests/support/exact_families.hpp"

#include <cmath>

namespace kerf::exact {

namespace {

struct Frame {
  Material material;
  Vec2 center;
  double angle;
  std::function<Potentials(const Complex& z, int side)> potentials;
};

Complex local(const Frame& f, const Vec2& x) {
  const Vec2 d = x - f.center;
  return Complex(d.x(), d.y()) * std::polar(1.0, -f.angle);
}

}  // namespace

double kolosov(const Material& m) {
  return 1 + 8 * m.mu * m.c;
}

ExactField from_potentials(std::string name, const Material& material, const Vec2& center, double angle,
                           const std::function<Potentials(const Complex& z, int side)>& potentials) {
  ExactField field{.name = std::move(name), .material = material};
  const Frame frame{material, center, angle, potentials};
  field.displacement = [frame](const Vec2& x, int side) -> Vec2 {
    const Complex z = local(frame, x);
    const Potentials p = frame.potentials(z, side);
    const Complex u = std::polar(1 / (2 * frame.material.mu), frame.angle) *
                      (kolosov(frame.material) * p.phi - z * std::conj(p.dphi) - std::conj(p.psi));
    return {u.real(), u.imag()};
  };
  field.stress = [frame](const Vec2& x, int side) -> Mat2 {
    const Complex z = local(frame, x);
    const Potentials p = frame.potentials(z, side);
    const double sum = 4 * p.dphi.real();
    const Complex d = 2.0 * (std::conj(z) * p.ddphi + p.dpsi) * std::polar(1.0, -2 * frame.angle);
    return (Mat2() << (sum - d.real()) / 2, d.imag() / 2, d.imag() / 2, (sum + d.real()) / 2).finished();
  };
  field.rotation = [frame](const Vec2& x, int side) {
    const Potentials p = frame.potentials(local(frame, x), side);
    return -(kolosov(frame.material) + 1) / (2 * frame.material.mu) * p.dphi.imag();
  };
  return field;
}

}  // namespace kerf::exact
