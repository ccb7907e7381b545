#pragma once
// Reentrant corners of a body: how singular its stress is there.

#include "inspect/recovered.hpp"
#include "inspect/wedge.hpp"

namespace kerf::inspect {

/// Between two straight sides that bear nothing.
struct ReentrantCorner {
  Vec2 at = Vec2::Zero(), bisector = Vec2::Zero();  // unit, into the body
  Index edge = none, triangle = none;               // of the side behind it
  double room = 0;                                  // its sides are straight, and nothing else is there, up to here
  Wedge wedge;
  std::array<double, 2> intensity{};  // generalised stress intensities of the two modes
};

/// Those that turn by more than corner_turn, in the order of their edges; none in bodies with a body force or an
/// eigenstrain.
std::vector<ReentrantCorner> reentrant_corners(const RecoveredState& state);

}  // namespace kerf::inspect
