// The singular fields G whose reciprocal work with a state is a stress at a point, its mean over a disc or along a
// line, or K at a tip of a straight crack [theory: B.11; Bueckner 1970]; the table of amplitudes is in
// docs/theory/bounds.md, "Stresses at points, K and G", the means in "Means, displacements and forces" [theory: B.21,
// B.22]. Complex potentials [Muskhelishvili 1953], z the place from the point in the frame, kappa = 8 mu/E' - 1:
//   2 mu u = kappa phi - z conj(phi') - conj(psi),
//   s11 + s22 = 4 Re phi',   s22 - s11 + 2 i s12 = 2 (conj(z) phi'' + psi');
// about a straight crack with phi' = Phi and a second function Omega, here the same one:
//   2 mu u = kappa int Phi - int Omega(conj z) - (z - conj z) conj(Phi),
//   s11 + s22 = 4 Re Phi,   s22 - i s12 = Phi + Omega(conj z) + (z - conj z) conj(Phi').

#include "solver/nucleus.hpp"

#include <cmath>
#include <complex>

namespace kerf {

namespace {

using Complex = std::complex<double>;

/// From 1/E' = (kappa + 1)/(8 mu) [theory: N.6].
double kappa(const Material& m) {
  return 8 * m.mu / plane_modulus(m) - 1;
}

// From s11 + s22 and s22 - s11 + 2i s12.
Mat2 tensor(double sum, const Complex& difference) {
  const double half = 0.5 * difference.real(), shear = 0.5 * difference.imag();
  return (Mat2() << 0.5 * sum - half, shear, shear, 0.5 * sum + half).finished();
}

Vec2 vector(const Complex& z) {
  return {z.real(), z.imag()};
}

Complex complex_number(const Vec2& x) {
  return {x.x(), x.y()};
}

// F(z) of the field Phi = Omega = F, with its primitive and its derivative.
// With its other tip at distance l the field B sqrt(l)/(z sqrt(z (z + l))) has no dislocation: its primitive returns to
// itself around both tips. sqrt((z + l)/z) has its cut where (z + l)/z < 0, on the crack alone.
struct Potential {
  Complex F, P, D;
};
struct TipPotential {
  Complex B;
  double length;

  Potential operator()(const Complex& z) const {  // z from the tip
    if (std::isinf(length)) {
      const Complex root = std::sqrt(z);
      return {B / (z * root), -2.0 * B / root, -1.5 * B / (z * z * root)};
    }
    // B sqrt(2a)/((z - a) sqrt(z^2 - a^2)) with z from the middle; the cut runs between the tips.
    const Complex other = z + length, root = z * std::sqrt(other / z), F = B * std::sqrt(length) / (z * root);
    return {F, -2.0 * B / std::sqrt(length) * std::sqrt(other / z), -F * (1.5 / z + 0.5 / other)};
  }
};

}  // namespace

namespace {

/// Of phi = c/z, psi = d/z.
/// Amplitudes E'/(8 pi) and 4 times that make the reciprocal work 1 for a unit of each part of the stress.
struct Amplitudes {
  Complex c = 0;
  double d = 0;
};
Amplitudes amplitudes(const Material& m, PointStress part) {
  const double size = plane_modulus(m) / (8 * pi);
  switch (part) {
    case PointStress::Trace:
      return {0, -4 * size};
    case PointStress::Difference:
      return {-size, 0};
    case PointStress::Shear:
      return {Complex(0, size), 0};
  }
  return {};
}

}  // namespace

/// phi = c/z and psi = d/z in the formulas above; the stress falls like 1/r^2, the displacement like 1/r.
Nucleus point_nucleus(const Material& m, const Vec2& x, PointStress part) {
  const double mu = m.mu, k = kappa(m);
  const auto [c, d] = amplitudes(m, part);
  return {[=](const Vec2& at) -> Vec2 {
            const Complex z = complex_number(at - x);
            return vector(k * c / z + z * std::conj(c / (z * z)) - std::conj(d / z)) / (2 * mu);
          },
          [=](const Vec2& at) -> Mat2 {
            const Complex z = complex_number(at - x), square = z * z;
            return tensor(-4 * (c / square).real(), 2.0 * (std::conj(z) * 2.0 * c / (square * z) - d / square));
          }};
}

namespace {

// Faster than the operators, which look for infinities.
Complex times(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
Complex inverse(const Complex& z) {
  return std::conj(z) / std::norm(z);
}

}  // namespace

/// As point_nucleus, with the powers of 1/z computed once: a ring of triangles asks for all three at every point.
Nuclei point_nuclei(const Material& m, const Vec2& x) {
  const double mu = m.mu, k = kappa(m);
  std::array<Amplitudes, 3> all;
  for (int i = 0; i < 3; ++i) all[i] = amplitudes(m, static_cast<PointStress>(i));
  return {[=](const Vec2& at, std::array<NucleusValue, Nuclei::most>& values) {
    const Complex z = complex_number(at - x), first = inverse(z), second = times(first, first),
                  third = times(second, first);
    for (int i = 0; i < 3; ++i) {
      const auto& [c, d] = all[i];
      const Complex by_second = times(c, second);
      values[i].displacement =
          vector(k * times(c, first) + times(z, std::conj(by_second)) - std::conj(d * first)) / (2 * mu);
      values[i].stress = tensor(-4 * by_second.real(), 2.0 * (2.0 * times(std::conj(z), times(c, third)) - d * second));
    }
  }};
}

// As a point, and psi = c R^2/z^3 beside it: then the displacement on the circle is linear, and goes on so inside.
// The field of a uniform eigenstrain in the disc of an infinite body [Eshelby 1957]. Its stress inside is not made: G
// is asked for there for displacements only.
Nucleus disc_nucleus(const Material& m, const Vec2& center, double radius, PointStress part) {
  const double mu = m.mu, k = kappa(m), square = radius * radius;
  const auto [c, d] = amplitudes(m, part);
  const Nucleus point = point_nucleus(m, center, part);
  return {[=](const Vec2& at) -> Vec2 {
            const Complex z = complex_number(at - center);
            if (std::norm(z) < square) return vector((k * c * std::conj(z) - d * z) / square) / (2 * mu);
            return point.displacement(at) - vector(std::conj(c * square / (z * z * z))) / (2 * mu);
          },
          [=](const Vec2& at) -> Mat2 {
            const Complex z = complex_number(at - center), second = z * z;
            return point.stress(at) + tensor(0, -6.0 * c * square / (second * second));
          }};
}

// Means over 0 < t < l of 1/(z - t) to the first three powers; conj(z - t) = z - t - (z - conj(z)).
Nucleus line_nucleus(const Material& m, const Vec2& from, const Vec2& to, PointStress part) {
  const double mu = m.mu, k = kappa(m), l = (to - from).norm();
  const auto [c, d] = amplitudes(m, part);
  const Vec2 along = (to - from) / l;
  const Mat2 frame = (Mat2() << along.x(), -along.y(), along.y(), along.x()).finished();
  return {[=](const Vec2& at) -> Vec2 {
            const Complex z = complex_number(frame.transpose() * (at - from)), first = std::log(z / (z - l)) / l,
                          second = 1.0 / (z * (z - l));
            return frame *
                   vector(k * c * first + std::conj(c) * (std::conj(first) + (z - std::conj(z)) * std::conj(second)) -
                          d * std::conj(first)) /
                   (2 * mu);
          },
          [=](const Vec2& at) -> Mat2 {
            const Complex z = complex_number(frame.transpose() * (at - from)), a = 1.0 / z, b = 1.0 / (z - l),
                          second = a * b, third = (b * b - a * a) / (2 * l);
            const Mat2 local =
                tensor(-4 * (c * second).real(), 2.0 * (2.0 * c * (second - (z - std::conj(z)) * third) - d * second));
            return frame * local * frame.transpose();
          }};
}

/// The amplitude of mode II is -i times that of mode I.
Nucleus tip_nucleus(const Material& m, const Vec2& tip, const Mat2& frame, double length, int mode) {
  const double size = plane_modulus(m) / (8 * std::sqrt(2 * pi)), mu = m.mu, k = kappa(m);
  const TipPotential potential{mode == 1 ? Complex(size) : Complex(0, -size), length};
  return {[=](const Vec2& at) -> Vec2 {
            const Complex z = complex_number(frame.transpose() * (at - tip));
            const Potential here = potential(z), mirrored = potential(std::conj(z));
            return frame * vector(k * here.P - mirrored.P - (z - std::conj(z)) * std::conj(here.F)) / (2 * mu);
          },
          [=](const Vec2& at) -> Mat2 {
            const Complex z = complex_number(frame.transpose() * (at - tip));
            const Potential here = potential(z), mirrored = potential(std::conj(z));
            const double sum = 4 * here.F.real();
            // s22 - i s12
            const Complex normal = here.F + mirrored.F + (z - std::conj(z)) * std::conj(here.D);
            return frame * tensor(sum, {2 * normal.real() - sum, -2 * normal.imag()}) * frame.transpose();
          }};
}

// Phi = Omega = B z^(-3/2): at the conjugate place the conjugate root.
Nuclei tip_nuclei(const Material& m, const Vec2& tip, const Mat2& frame) {
  const double size = plane_modulus(m) / (8 * std::sqrt(2 * pi)), mu = m.mu, k = kappa(m);
  return {[=](const Vec2& at, std::array<NucleusValue, Nuclei::most>& values) {
    const Complex z = complex_number(frame.transpose() * (at - tip)), first = inverse(z), root = std::sqrt(z),
                  one_over = inverse(root), F = times(first, one_over), P = -2.0 * one_over, D = -1.5 * times(F, first),
                  across = z - std::conj(z);
    for (int mode = 0; mode < 2; ++mode) {
      const Complex B = mode == 0 ? Complex(size) : Complex(0, -size);
      const Complex F_here = times(B, F), P_here = times(B, P), D_here = times(B, D),
                    F_mirrored = times(B, std::conj(F)), P_mirrored = times(B, std::conj(P));
      values[mode].displacement = frame * vector(k * P_here - P_mirrored - times(across, std::conj(F_here))) / (2 * mu);
      const double sum = 4 * F_here.real();
      const Complex normal = F_here + F_mirrored + times(across, std::conj(D_here));
      values[mode].stress = frame * tensor(sum, {2 * normal.real() - sum, -2 * normal.imag()}) * frame.transpose();
    }
  }};
}

}  // namespace kerf
