#include "solver/anisotropic.hpp"

#include <fmt/core.h>

#include <Eigen/LU>

#include <cmath>

namespace kerf {

namespace {

using Complex = std::complex<double>;

/// Along the material's own axes, where b16 = b26 = 0.
PlaneCompliances own_compliances(const Material& m) {
  const double mean = 1 / (4 * m.mu);
  return {m.c + mean + 2 * m.coupling + m.split,
          m.c + mean - 2 * m.coupling + m.split,
          m.c - mean - m.split,
          4 * (mean - m.split),
          0,
          0};
}

/// Directions of the material's axes.
Mat2 own_axes(const Material& m) {
  const double angle = 0.5 * std::arg(m.axis), c = std::cos(angle), s = std::sin(angle);
  return (Mat2() << c, -s, s, c).finished();
}

}  // namespace

Material orthotropic(const Orthotropy& given) {
  const auto [first, second] = given.young;
  const double nu = given.poisson;
  const auto refuse = [](const std::string& why) {
    throw Error(Fault::Usage, "these constants belong to no material: " + why);
  };
  if (!(first > 0) || !(second > 0)) refuse("young = [E1, E2] must be positive");
  if (!(given.shear > 0)) refuse("shear must be positive");
  constexpr double rounding = 1e-12;
  if (!(nu * nu < (1 - rounding) * first / second))
    refuse(
        fmt::format("poisson^2 must be less than E1/E2, or some stress would do no work; it is {:.6g}, E1/E2 is {:.6g}",
                    nu * nu, first / second));
  const double s11 = 1 / first, s22 = 1 / second, s12 = -nu / first, s66 = 1 / given.shear;
  const double normal = s11 + s22 - 2 * s12, shears = normal + s66;
  Material m{2 / shears, (s11 + s22 + 2 * s12) / 4, (s11 - s22) / 4, (normal - s66) / 8};
  if (std::abs(m.coupling) < rounding * shears && std::abs(m.split) < rounding * shears) return {m.mu, m.c};
  m.axis = std::polar(1.0, 2 * given.angle);
  return m;
}

Material seen_from(Material m, double angle) {
  m.axis *= std::polar(1.0, -2 * angle);
  return m;
}

Eigen::Vector3d orthotropic_strain(const Material& m, double s11, double s22, double s12) {
  const Complex k = m.coupling * m.axis, l = m.split * m.axis * m.axis, D(s11 - s22, 2 * s12);
  const double trace = 2 * (k.real() * D.real() + k.imag() * D.imag());
  const Complex difference = 2.0 * (k * (s11 + s22) + l * std::conj(D));
  return {0.5 * (trace + difference.real()), 0.5 * (trace - difference.real()), 0.5 * difference.imag()};
}

PlaneCompliances compliances(const Material& m) {
  const Complex k = m.coupling * m.axis, l = m.split * m.axis * m.axis;
  const double mean = 1 / (4 * m.mu);
  return {m.c + mean + 2 * k.real() + l.real(),
          m.c + mean - 2 * k.real() + l.real(),
          m.c - mean - l.real(),
          4 * (mean - l.real()),
          2 * (k.imag() + l.imag()),
          2 * (k.imag() - l.imag())};
}

Eigen::Matrix3d strain_matrix(const Material& m) {
  const PlaneCompliances b = compliances(m);
  Eigen::Matrix3d a;
  a << b.b11, b.b12, b.b16,  //
      b.b12, b.b22, b.b26,   //
      b.b16, b.b26, b.b66;
  return a;
}

Eigen::Matrix3d stress_matrix(const Material& m) {
  return strain_matrix(m).inverse();
}

ShearModuli shear_moduli(const Material& m) {
  if (isotropic(m)) return {m.mu, m.mu};
  // Strains per stress of the size 1: of shear along the axes, and of the pressure with the other shear.
  const double shear = 1 / (2 * m.mu) - 2 * m.split;
  const double pressure = 2 * m.c, deviator = 1 / (2 * m.mu) + 2 * m.split;
  const double mean = 0.5 * (pressure + deviator), radius = std::hypot(0.5 * (pressure - deviator), 2 * m.coupling);
  const double largest = std::max(shear, mean + radius);
  const double least = std::min(shear, (pressure * deviator - 4 * m.coupling * m.coupling) / (mean + radius));
  return {0.5 / largest, 0.5 / least};
}

Roots roots(const Material& m) {
  // Along the material's axes the product is -sqrt(b22/b11), the sum i r; then turned.
  const PlaneCompliances b = own_compliances(m);
  const double ratio = std::sqrt(b.b22 / b.b11), r = std::sqrt((2 * b.b12 + b.b66) / b.b11 + 2 * ratio);
  const Complex apart = std::sqrt(Complex(4 * ratio - r * r, 0));
  const double angle = 0.5 * std::arg(m.axis), c = std::cos(angle), s = std::sin(angle);
  Roots p;
  for (int i = 0; i < 2; ++i) {
    const Complex own = 0.5 * (Complex(0, r) + (i == 0 ? apart : -apart));
    p[static_cast<std::size_t>(i)] = (s + own * c) / (c - own * s);
  }
  return p;
}

std::vector<Mat2> smooth_images(const std::vector<Material>& materials) {
  std::vector<Mat2> images;
  for (const Material& m : materials) {
    if (isotropic(m)) continue;
    for (const std::complex<double>& p : roots(m)) images.push_back((Mat2() << 1, p.real(), 0, p.imag()).finished());
  }
  return images;
}

Surface surface(const Material& m) {
  const PlaneCompliances b = own_compliances(m);
  const double ratio = std::sqrt(b.b22 / b.b11), r = std::sqrt((2 * b.b12 + b.b66) / b.b11 + 2 * ratio);
  const Mat2 axes = own_axes(m);
  return {b.b11 * r * axes * Vec2(1, ratio).asDiagonal() * axes.transpose(), b.b12 + b.b11 * ratio};
}

}  // namespace kerf
