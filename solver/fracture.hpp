#pragma once
// Stress intensity factors and energy release rate at crack tips, by interaction integrals over a domain around the tip.

#include "solver/model.hpp"

namespace kerf {

/// One end of a crack that lies inside the body. K in stress x sqrt(length): ahead of the tip s_yy = K_I/sqrt(2 pi r) in
/// the frame whose x axis extends the crack. G in stress x length.
struct TipIntensity {
  Index crack = 0;
  bool at_start = false;  // of the crack's path
  Vec2 at = Vec2::Zero();
  double K_I = 0, K_II = 0, G = 0;
  double radius = 0;  // outer radius of the domain used
  double spread = 0;  // largest difference of K between rings of different radius, relative to the largest |K|
};

/// Tips of all cracks, in the order of the cracks, start before end; ends on the boundary or on a hole are no tips.
/// Right on faces in contact: the auxiliary opening works against the contact pressure (face term).
std::vector<TipIntensity> crack_tips(const Model& model, const State& state);

}  // namespace kerf
