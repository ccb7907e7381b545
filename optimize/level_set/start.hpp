#pragma once
// The holes that a level set begins with.

#include "kerf/optimize.hpp"

namespace kerf {

struct Disc {
  Vec2 center;
  double radius;
};

/// In the box low..high. Random ones by a generator of our own: the same on every machine.
std::vector<Disc> start_discs(const StartHoles& start, const Vec2& low, const Vec2& high);

}  // namespace kerf
