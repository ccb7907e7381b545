// Orthotropic materials of the plane problem. With t = tr s, D = s11 - s22 + 2i s12 and phi the angle of the first
// axis,
//   tr e = 2 c t + 2 Re(conj(k) D),   e11 - e22 + 2i e12 = D/(2 mu) + 2 k t + 2 l conj(D)   [theory: O.2],
// k = coupling e^(2i phi), l = split e^(4i phi): mu and c alone are the isotropic mean over all directions. From it
// follow Lekhnitskii's compliances b_ij, the roots p with Im p > 0 of
//   b11 p^4 - 2 b16 p^3 + (2 b12 + b66) p^2 - 2 b26 p + b22 = 0   [Lekhnitskii 1968; theory: O.4, O.5],
// of which the stresses are functions of x + p y, and the tensors of Barnett and Lothe along a straight line [Ting
// 1996; theory: O.7]. Roots and tensors are found along the material's axes and turned, so that sum and product of
// nearly equal roots stay exact to rounding. Derived in docs/theory/orthotropic.md.

#include "solver/anisotropic.hpp"

#include <fmt/core.h>

#include <Eigen/LU>

#include <cmath>

namespace kerf {

namespace {

using Complex = std::complex<double>;

/// Along the material's own axes, where b16 = b26 = 0.
/// (O.3) solved for the b_ij: s11 = b11, s22 = b22, s12 = b12, s66 = b66.
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

// (O.3). A coupling and a split below the rounding of the compliances leave an isotropic material, whose formulas are
// shorter and whose roots are i, i.
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

// The axis is e^(2i phi): a frame turned by `angle` sees phi - angle.
Material seen_from(Material m, double angle) {
  m.axis *= std::polar(1.0, -2 * angle);
  return m;
}

// What k and l add to the strain: e11, e22, e12 (not 2 e12).
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

// The eigenvalues of A on symmetric stresses in an orthonormal basis: the shear along the axes is one eigenvector, the
// pressure and the other shear span a 2 x 2 block. The smaller root of the block comes from its determinant, because
// the difference mean - radius cancels as c goes to 0.
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

// [theory: O.5]
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

// x + p y as a real map: (x + Re(p) y, Im(p) y).
std::vector<Mat2> smooth_images(const std::vector<Material>& materials) {
  std::vector<Mat2> images;
  for (const Material& m : materials) {
    if (isotropic(m)) continue;
    for (const std::complex<double>& p : roots(m)) images.push_back((Mat2() << 1, p.real(), 0, p.imag()).finished());
  }
  return images;
}

// [theory: O.7]
Surface surface(const Material& m) {
  const PlaneCompliances b = own_compliances(m);
  const double ratio = std::sqrt(b.b22 / b.b11), r = std::sqrt((2 * b.b12 + b.b66) / b.b11 + 2 * ratio);
  const Mat2 axes = own_axes(m);
  return {b.b11 * r * axes * Vec2(1, ratio).asDiagonal() * axes.transpose(), b.b12 + b.b11 * ratio};
}

}  // namespace kerf
