#pragma once
// What an initial guess looks for in place of a drawn thing: a small hole, crack or inclusion, somewhere in a box.

#include "kerf/perturbation.hpp"

#include <vector>

namespace kerf {

/// One thing that it may be.
struct Variant {
  Perturbation what;
  double angle = 0, young = 0;
};

struct Sought {
  std::size_t drawn = 0;                         // number in the design
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // of its middle
  double least = 0, most = 0;                    // size
  double size = 0;                               // where nothing tells it
  std::vector<Variant> variants = {{}};          // a hole
  bool turns = false;                            // the angles of the variants are samples of a continuum
};

}  // namespace kerf
