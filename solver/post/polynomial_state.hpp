#pragma once
// States of equilibrium whose stress is a polynomial: what rings around a tip need not be asked about. Internal to this
// room.

#include "kerf/scene.hpp"
#include "solver/shared_tips.hpp"
#include "solver/tip_fields.hpp"

#include <vector>

namespace kerf {

/// Isotropic: phi' = sum a_n z^n, psi' = sum b_n z^n, n <= degree, z = (x + iy)/scale [Muskhelishvili 1953; theory:
/// F.7], and a state under the uniform body force `force`.
struct PolynomialState {
  Material material;  // as seen in the frame of the state
  double scale = 1;
  int degree = 0;
  Vec2 force = Vec2::Zero();
  Eigen::VectorXd coefficients;  // Re a_n, Im a_n, Re b_n, Im b_n, as many as there are

  LocalState at(const Vec2& x) const;
  double t_stress() const;  // s_xx - s_yy at 0
};

/// A symmetric stress and a rotation at a point, and what they count.
struct StateSample {
  Vec2 x;
  Mat2 stress;
  double rotation, weight;
};

/// The state nearest to the samples (of all processes) by weighted least squares, exact (to rounding) when they come
/// from such a state.
PolynomialState fit_state(const Material& material, int degree, const Vec2& force,
                          const std::vector<StateSample>& samples, const Sums& sums = {});

/// s_11 = s_22 = stress: what looks the same from every direction.
PolynomialState uniform_pressure(const Material& material, double stress);

}  // namespace kerf
