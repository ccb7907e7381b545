// Kelvin's field of a point force, the matrix M(eps) between the force on a small clamp and the mean displacement of
// its rim, and its inverse [theory: T.26, T.27, T.29].

#include "topo/formulas/clamped_hole.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/mutation.hpp"

#include <Eigen/LU>
#include <cmath>

namespace kerf {

double kolosov(const Material& m) {
  return 1 + 8 * m.mu * m.c;
}

double flexibility(const Material& m) {
  return 1 / (2 * pi * m.mu * (1 + kolosov(m)));
}

Mat2 kelvin(const Material& m, const Vec2& r) {
  // The factor 1/2 before kappa: the logarithm is that of |r|^2.
  const double square = r.squaredNorm();
  return flexibility(m) * (-0.5 * kolosov(m) * std::log(square) * Mat2::Identity() + r * r.transpose() / square);
}

Mat2 kelvin_stress(const Material& m, const Vec2& r, int j) {
  const double k = kolosov(m), square = r.squaredNorm();
  const Vec2 e = Vec2::Unit(j), y = r / square;
  const Mat2 linear = e * y.transpose() + y * e.transpose() - y[j] * Mat2::Identity(), yy = y * y.transpose();
  return -(0.5 * (k - 1) * linear + 2 * r[j] * yy) / (pi * (1 + k));
}

// M = flexibility (kappa ln(1/eps) + 1/2) I + Hreg. The 1/2 is the mean of r_i r_j/|r|^2 over the rim.
Mat2 clamped_matrix(const Material& m, double eps, const Mat2& hreg) {
  return flexibility(m) *
             (0.5 * mutant(FormulaPart::ClampedHalf) -
              mutant(FormulaPart::ClampedLogarithm) * kolosov(m) * std::log(eps)) *
             Mat2::Identity() +
         mutant(FormulaPart::ClampedRegular) * hreg;
}

// With friction M is not symmetric, and its symmetric part decides. M loses its definiteness where eps is not small
// against the distance to the sides.
bool admits_clamp(const Mat2& m) {
  const Mat2 b = 0.5 * (m + m.transpose());
  return b(0, 0) > 0 && b.determinant() > 0;
}

Vec2 clamped_force(const Material& m, double eps, const Mat2& hreg, const Vec2& u0) {
  const Mat2 a = clamped_matrix(m, eps, hreg);
  if (!admits_clamp(a))
    throw Error(Fault::Numerics,
                "clamped hole: its radius " + std::to_string(eps) +
                    " is too large for the expansion, choose one well below the distance to the sides");
  return mutant(FormulaPart::ClampedForce) * a.inverse() * u0;
}

namespace {

std::string clamped_hole_in_words(const Perturbation&) {
  return "a clamped hole";
}

}  // namespace

constinit const PerturbationKind kinds::clamped_hole{
    .word = "clamped_hole", .description = clamped_hole_in_words, .becomes = Becomes::Clamp};

}  // namespace kerf
