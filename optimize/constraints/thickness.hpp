#pragma once
// How thin the members of a body are, and the gaps between them.

#include "optimize/constraints/sides.hpp"

namespace kerf {

struct Thinnest {
  double width = infinity;  // infinite: there are no two sides that face one another
  Vec2 at = Vec2::Zero();   // in the middle
};

/// The least diameter of the discs inside the body that touch its boundary at two places whose normals differ by more
/// than 120 degrees: the local thickness on the medial axis without its branches into corners. `gaps`: of the discs
/// outside. Pairs of which neither side can move do not count. Widths up to `most` are looked for; their error is at
/// most 0.1 % of it.
Thinnest thinnest(const std::vector<DrawnSide>& sides, const std::vector<bool>& moves, bool gaps, double most);

}  // namespace kerf
