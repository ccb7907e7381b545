#pragma once
// A level set on a body-fitted mesh: carve, mesh, solve, move, nucleate.

#include "optimize/history.hpp"
#include "optimize/problem.hpp"

namespace kerf {

OptimizeResult optimise_level_set(const Problem& p, const OptimizeRequest& r, const Observer& see,
                                  const CheckpointPlace& place);

}  // namespace kerf
