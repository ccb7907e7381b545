#pragma once
// An end of a crack and the room around it.

#include "kerf/shape.hpp"

#include <array>
#include <string>

namespace kerf {

struct TipPlace {
  Vec2 at, direction;          // unit, out of the crack
  double clearance;            // to the nearest boundary, other crack, or other straight piece of this one
  std::string nearest;         // what that is
  std::array<double, 2> ring;  // 0.06 and 0.2 times half the crack's length, smaller where `clearance` asks for it
};
/// The ring ends half way to what is nearest, and within a tenth of the radius of a curved crack.
TipPlace crack_tip(const Shape& shape, Index crack, bool at_start);

}  // namespace kerf
