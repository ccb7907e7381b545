#pragma once
// From values to colors: two perceptual maps of 256 steps, and which values their ends stand for.

#include "plot/picture.hpp"

#include <cstdint>

namespace kerf {

using Colors = std::array<std::uint32_t, 256>;  // 0xffRRGGBB

/// Linear: viridis. Diverging: Moreland's cool-warm [Moreland 2009, Diverging Color Maps].
const Colors& colors(Scale scale);

inline constexpr std::uint32_t not_finite_color = 0xffb4b4b4;

struct Limits {
  double low = 0, high = 1;    // of the scale
  double least = 0, most = 0;  // of the finite values
  bool below() const {
    return least < low;
  }
  bool above() const {
    return most > high;
  }
};

/// Area-weighted quantiles: at most `clip` of the area lies beyond each end, and nothing at all when leaving nothing
/// out would lengthen the scale by less than a tenth. Diverging limits are symmetric about 0. Always low < high.
Limits limits(const Picture& picture);

}  // namespace kerf
