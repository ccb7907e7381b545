// Corner with free faces [Williams 1952]: phi = A z^l, psi = A b z^l, in the frame of the bisector.
#include "tests/support/exact_families.hpp"

#include <cmath>
#include <stdexcept>

namespace kerf::exact {

namespace {

struct Term {
  double l;
  Complex A, B;
};

Potentials evaluate(const std::vector<Term>& terms, double t_stress, const Complex& z, int side) {
  double angle = std::arg(z);
  if (side < 0 && z.imag() == 0 && z.real() < 0) angle = -pi;  // the lower face of a slit
  Potentials p{t_stress / 4 * z, t_stress / 4, 0, -t_stress / 2 * z, -t_stress / 2};
  for (const auto& [l, A, B] : terms) {
    const Complex power = std::polar(std::pow(std::abs(z), l), l * angle);
    p.phi += A * power;
    p.dphi += l * A * power / z;
    p.ddphi += l * (l - 1) * A * power / (z * z);
    p.psi += B * power;
    p.dpsi += l * B * power / z;
  }
  return p;
}

}  // namespace

double corner_exponent(double opening, int mode) {
  if (opening == 2 * pi) return 0.5;
  const auto rest = [&](double l) { return std::sin(l * opening) + (mode == 1 ? l : -l) * std::sin(opening); };
  // l = 1 is a trivial root of mode 2.
  double low = 0.5, high = low;
  while (rest(low) * rest(high) > 0 && high < 0.999) low = high, high += 0.002;
  if (rest(low) * rest(high) > 0) throw std::invalid_argument("corner_exponent: no singular exponent");
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (rest(low) * rest(middle) <= 0 ? high : low) = middle;
  }
  return (low + high) / 2;
}

ExactField corner(std::string name, const Material& m, const Corner& corner) {
  const double w = corner.opening;
  std::vector<Term> terms;
  if (corner.k1 != 0) {
    const double l = corner_exponent(w, 1), b = -(std::cos(l * w) + l * std::cos(w));
    const double A = corner.k1 * std::pow(2 * pi, l - 1) / (l * (l + 1 + b));
    terms.push_back({l, A, A * b});
  }
  if (corner.k2 != 0) {
    const double l = corner_exponent(w, 2), b = std::cos(l * w) - l * std::cos(w);
    const Complex A(0, corner.k2 * std::pow(2 * pi, l - 1) / (l * (l - 1 + b)));
    terms.push_back({l, A, A * b});
  }
  ExactField field =
      from_potentials(std::move(name), m, Vec2::Zero(), corner.bisector,
                      [terms, t = corner.t_stress](const Complex& z, int s) { return evaluate(terms, t, z, s); });
  field.tips = {{Vec2::Zero(), corner.k1, corner.k2}};
  const Vec2 axis(std::cos(corner.bisector), std::sin(corner.bisector));
  field.side = [axis, slit = w == 2 * pi](const Vec2& x) {
    return slit ? (cross(axis, x) > 0) - (cross(axis, x) < 0) : 0;
  };
  return field;
}

}  // namespace kerf::exact
