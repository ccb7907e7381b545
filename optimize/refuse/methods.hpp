#pragma once
// What only a level set, or only drawn shapes, can get wrong.

#include "kerf/inverse.hpp"
#include "optimize/refuse.hpp"
#include "optimize/refuse/extent_of_body.hpp"

namespace kerf {

/// Appends to `all`. `drawable`: the frame has no problem of its own.
void look_at_level_set(const Problem& p, const OptimizeRequest& r, bool drawable, std::vector<Wrong>& all);
void look_at_design(const Problem& p, const OptimizeRequest& r, bool drawable, std::vector<Wrong>& all);

}  // namespace kerf
