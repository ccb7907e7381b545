#pragma once
// What of a design stays solid.

#include "optimize/level_set/background.hpp"

#include <string>
#include <vector>

namespace kerf {

/// Frozen loops, regions of other materials, strips of a `width` along loads and along what functionals look at, the
/// rings of functionals (named in a note), and the labels of supports.
Solid solid_parts(const Problem& p, const OptimizeRequest& r, double width, std::vector<std::string>& notes);

}  // namespace kerf
