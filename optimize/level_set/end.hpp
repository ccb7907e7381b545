#pragma once
// What there is to say of a level set's design at the end: the certificate and its word.

#include "optimize/level_set/descent.hpp"
#include "optimize/loop/finish.hpp"

namespace kerf {

OptimizeResult result_of(const Ground& g, const Descent& d, bool go_on);

}  // namespace kerf
