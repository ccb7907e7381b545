#pragma once
// The worst crack inside the body: K of a short straight crack of a given length in its worst direction, from the
// stress alone [theory: M.7; Kachanov 1993].

#include "kerf/edge_cracks.hpp"

#include <vector>

namespace kerf::inspect {

/// Of a crack of half length 1 in a uniform stress (s11, s22, s12), its faces closed by pressure and sliding against
/// friction: K/sqrt(pi) in the direction (radians, in [0, pi)) of the largest K_I^2 + K_II^2.
struct WorstCrack {
  double K_I = 0, K_II = 0, direction = 0;
  bool closed = false;
};
WorstCrack worst_crack(const Eigen::Vector3d& stress, double friction);

struct InteriorCrack {
  Vec2 at = Vec2::Zero();  // its middle
  double K_I = 0, K_II = 0, K = 0, direction = 0;
  bool closed = false;
  bool masked = false;  // within two lengths of a side, a crack or another material, or five of a singular point
};
/// At the centroid of every triangle. Throws as edge_cracks does for length and friction.
std::vector<InteriorCrack> interior_cracks(const RecoveredState& state, double length, double friction);
/// The worst of them, not masked, by falling K: ten at most, none within four lengths of a worse one.
std::vector<InteriorCrack> worst_inside(const std::vector<InteriorCrack>& cracks, double length);

}  // namespace kerf::inspect
