#pragma once
// What is said of a map that has no least and no largest value.

#include "io/result.hpp"

namespace kerf {

/// Why: it is masked everywhere, or none of the asked points has a value.
std::string without_extrema(const MapResult& map);

}  // namespace kerf
