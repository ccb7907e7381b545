#pragma once
// Not a number, and more than any.

#include <limits>

namespace kerf {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                        infinity = std::numeric_limits<double>::infinity();

}  // namespace kerf
