#pragma once
// K of an edge crack by superposition: what the stress of the uncracked body puts on its faces [theory: M.1, M.4, M.5].

#include "inspect/mouth.hpp"

namespace kerf::inspect {

/// Stress near a place of the boundary, (s11, s22, s12) in the frame of its tangent and its inward normal: a quadratic
/// polynomial in x (along) and y (inward) over a length: columns 1, x, y, x^2, x y, y^2, x and y over that length.
struct LocalStress {
  Eigen::Matrix<double, 3, 6> of = Eigen::Matrix<double, 3, 6>::Zero();
  double rough = 0;  // root mean square of what the fit leaves, over the largest stress fitted
};

/// Where the stress is looked at: (x, y) over the length; and the fit to values there, a column each. `loads`: s22 and
/// s12 at the place itself, which the loads on the boundary say exactly.
inline constexpr int samples = 11;
const std::array<Vec2, samples>& sample_places();
LocalStress fit_stress(const Eigen::Matrix<double, 3, samples>& values, const Vec2& loads);

/// The boundary that a crack leaves.
struct MouthAt {
  double length = 0, curvature = 0;
  double pressure = 0;  // in the crack
};

/// K at an angle to the tangent. Open where the superposition opens it; else its faces are closed all along, and slide
/// where the shear overcomes friction.
struct EdgeIntensity {
  double K_I = 0, K_II = 0;
  bool closed = false;
};
EdgeIntensity intensity(const Mouths& mouths, const LocalStress& stress, const MouthAt& at, double beta);

/// The angle of the largest K_I^2 + K_II^2, between Mouths::flattest and 180 degrees less that.
double worst_angle(const Mouths& mouths, const LocalStress& stress, const MouthAt& at);

}  // namespace kerf::inspect
