// Collinear cracks b < |x| < c [Willmore 1949]: Z = s (lam2 - z^2)/(R(b) R(c)), R(q) = sqrt(q^2 - z^2) in Im z > 0;
// its primitive in Legendre's elliptic integrals, those in Carlson's [Carlson 1979].
#include "tests/support/exact_families.hpp"

#include <cmath>

namespace kerf::exact {

namespace {

struct Carlson {
  Complex F, D;  // R_F(x, y, 1), R_D(x, y, 1)
};

Carlson carlson(Complex x, Complex y) {
  Complex z = 1, sum = 0;
  double power = 1;
  // The relative differences of x, y, z fall by 4 per step, the error with their squares.
  for (int step = 0; step < 16; ++step) {
    const Complex rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z), shift = rx * (ry + rz) + ry * rz;
    sum += power / (rz * (z + shift));
    power /= 4;
    x = (x + shift) / 4.0;
    y = (y + shift) / 4.0;
    z = (z + shift) / 4.0;
  }
  const Complex mean = (x + y + z) / 3.0, weighted = (x + y + 3.0 * z) / 5.0;
  return {1.0 / std::sqrt(mean), 3.0 * sum + power / (weighted * std::sqrt(weighted))};
}

struct PairLine {
  double b, c, s, lam2;
};

struct PairWestergaard {
  Complex P, Z, dZ;
};

/// In the closed upper half plane.
PairWestergaard upper(const PairLine& line, const Complex& z) {
  const auto& [b, c, s, lam2] = line;
  const Complex i(0, 1);
  const Complex rb = -i * std::sqrt(z - b) * std::sqrt(z + b), rc = -i * std::sqrt(z - c) * std::sqrt(z + c);
  const Complex Z = s * (lam2 - z * z) / (rb * rc);
  const Complex dZ =
      s * (-2.0 * z / (rb * rc) + (lam2 - z * z) * z * (1.0 / (rb * rb * rb * rc) + 1.0 / (rb * rc * rc * rc)));
  const Complex t = z / b;
  const double m = b * b / (c * c);
  Complex x = 1.0 - t * t, y = 1.0 - m * t * t;
  if (z.imag() == 0) {  // seen from above: below the cut of the square root for t > 0
    x.imag(t.real() > 0 ? -0.0 : 0.0);
    y.imag(t.real() > 0 ? -0.0 : 0.0);
  }
  const Carlson r = carlson(x, y);
  const Complex F = t * r.F, E = F - m * t * t * t * r.D / 3.0;
  return {s * (c * E - (c - lam2 / c) * F), Z, dZ};
}

Potentials evaluate(const PairLine& line, double uniform, const Complex& z, int side) {
  const bool lower = z.imag() < 0 || (z.imag() == 0 && side < 0);
  PairWestergaard f = upper(line, {z.real(), std::abs(z.imag())});
  if (lower) f = {std::conj(f.P), std::conj(f.Z), std::conj(f.dZ)};
  const double a = uniform / 4, b = -uniform / 2;
  return {f.P / 2.0 + a * z, f.Z / 2.0 + a, f.dZ / 2.0, (f.P - z * f.Z) / 2.0 + b * z, -z * f.dZ / 2.0 + b};
}

}  // namespace

ExactField two_cracks(std::string name, const Material& m, const TwoCracks& cracks) {
  const double b = cracks.inner, c = cracks.outer, s = cracks.tension, ratio = b * b / (c * c);
  // E/K, complete, of parameter 1 - ratio
  const Carlson complete = carlson(0, ratio);
  const PairLine line{b, c, s, c * c * (1 - (1 - ratio) / 3 * complete.D.real() / complete.F.real())};
  const double uniform = cracks.along - s, width = std::sqrt(c * c - b * b);
  ExactField field = from_potentials(std::move(name), m, Vec2::Zero(), 0, [line, uniform](const Complex& z, int side) {
    return evaluate(line, uniform, z, side);
  });
  field.opening = [line, modulus = plane_modulus(m)](double x) { return 4 / modulus * upper(line, x).P.imag(); };
  const double k_in = s * std::sqrt(pi / b) * (line.lam2 - b * b) / width,
               k_out = s * std::sqrt(pi / c) * (c * c - line.lam2) / width;
  field.tips = {{{-c, 0}, k_out}, {{-b, 0}, k_in}, {{b, 0}, k_in}, {{c, 0}, k_out}};
  field.side = [](const Vec2& x) { return (x.y() > 0) - (x.y() < 0); };
  return field;
}

}  // namespace kerf::exact
