#pragma once
// Points to validate at, where none are given.

#include "kerf/analysis.hpp"
#include "kerf/validate.hpp"

namespace kerf {

struct Choice {
  const Analysis& a;
  const Functional& j;
  const ValidationRequest& r;
  const Shape& shape;
};

/// Two points (one where no second is apart) with room for the largest radius, if there is any: where the smallest
/// share of a mode of the formula is largest, and T not small.
std::vector<Vec2> chosen_points(const Choice& choice);

}  // namespace kerf
