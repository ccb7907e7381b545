// The fields about a crack tip under unit K_I, unit K_II and a unit force along x [Westergaard 1939]:
//   Z = 1/sqrt(2 pi z),  K_I: s_11 = Re Z - y Im Z', s_22 = Re Z + y Im Z', s_12 = -y Re Z',
//   K_II: s_11 = 2 Im Z + y Re Z', s_22 = -y Re Z', s_12 = Re Z - y Im Z';  force: s_rr = -cos(angle)/(pi r).
// The rotation is turn times -Im Z, Re Z, -y/(2 pi r^2), turn = (kappa + 1)/(4 mu), kappa + 1 = 2 + 8 mu c [theory:
// F.1, F.2]. In orthotropic materials: orthotropic_tip.cpp.

#include "solver/tip_fields.hpp"

#include "solver/post/orthotropic_tip.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace kerf {

namespace {

double part_of(const TipRing& ring, double r) {
  return std::clamp((r - ring.inner) / (ring.outer - ring.inner), 0.0, 1.0);
}

}  // namespace

double cut_off(const TipRing& ring, double r) {
  const double t = part_of(ring, r);
  return 1 - t * t * t * (10 + t * (6 * t - 15));
}

double cut_off_slope(const TipRing& ring, double r) {
  const double t = part_of(ring, r);
  return -30 * t * t * (1 - t) * (1 - t) / (ring.outer - ring.inner);
}

std::array<LocalState, 3> tip_fields(const Material& m, const Vec2& x, double angle) {
  if (!isotropic(m)) return orthotropic_tip_fields(m, x, angle);
  const double r = x.norm(), turn = (2 + 8 * m.mu * m.c) / (4 * m.mu);
  const std::complex<double> Z = std::polar(1 / std::sqrt(2 * pi * r), -angle / 2),
                             slope = -0.5 * Z / std::complex(x.x(), x.y());
  const double shear_I = -x.y() * slope.real(), shear_II = Z.real() - x.y() * slope.imag();
  const Eigen::Vector4d s_I(Z.real() - x.y() * slope.imag(), shear_I, shear_I, Z.real() + x.y() * slope.imag());
  const Eigen::Vector4d s_II(2 * Z.imag() + x.y() * slope.real(), shear_II, shear_II, -x.y() * slope.real());
  const Vec2 e = x / r;
  const Eigen::Vector4d s_force =
      -e.x() / (pi * r) * Eigen::Vector4d(e.x() * e.x(), e.x() * e.y(), e.x() * e.y(), e.y() * e.y());
  const auto field = [&](const Eigen::Vector4d& s, double rotation) {
    return LocalState{tensor(s), tensor(displacement_gradient(m, s, rotation))};
  };
  return {field(s_I, -turn * Z.imag()), field(s_II, turn * Z.real()), field(s_force, -turn * e.y() / (2 * pi * r))};
}

}  // namespace kerf
