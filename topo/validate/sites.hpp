#pragma once
// Where the balls of a validation go.

#include "kerf/validate.hpp"

namespace kerf {

struct Site {
  std::size_t number;  // of the point
  Vec2 at;
  double clear = 0;  // distance to the next feature; not positive outside the body, on features and in rings
  bool inside = true;
  double ball = 0;                 // radius; 0: no radius fits
  std::vector<double> radii = {};  // those that fit, decreasing
};

/// Sites in batches whose balls keep apart.
std::vector<std::vector<Site>> place(const Shape& shape, const Functional& j, const ValidationRequest& request);

/// The shape with a ball_hole of `sides` sides around every site; their label is the last one.
Shape with_balls(const Shape& shape, const std::vector<Site>& sites, int sides);

}  // namespace kerf
