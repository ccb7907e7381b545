// Bounds against values that were found in another way.

#include "solver/witness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

void confront(Bounded& b, double witness, double unsure, const char* by) {
  const double outside = std::max(b.lower - witness, witness - b.upper);
  if (outside > unsure)
    qualify(b, fmt::format("the bounds are estimates: {} gives {:.6g}, which they do not hold", by, witness));
}

void confront(TipBounds& b, const TipIntensity& tip) {
  constexpr double unsure = 0.02;
  const double size = std::hypot(tip.K_I, tip.K_II);
  const char* rings = "the integral over rings about the tip";
  confront(b.K_I, tip.K_I, (unsure + tip.spread_K_I) * size, rings);
  confront(b.K_II, tip.K_II, (unsure + tip.spread_K_II) * size, rings);
  if (!b.K_I.guaranteed || !b.K_II.guaranteed) qualify(b.G, b.K_I.guaranteed ? b.K_II.note : b.K_I.note);
}

}  // namespace kerf
