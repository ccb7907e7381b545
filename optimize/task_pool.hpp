#pragma once
// Starts of designs that several processes try.

#include "kerf/optimize.hpp"

#include <string>
#include <string_view>

namespace kerf {

/// Has tasks done, each by try_start on some process; returns the answers in their order.
using TaskPool = std::function<std::vector<std::string>(const std::vector<std::string>& tasks)>;

/// One look at one start: `problem` and `request` are those that optimize_parameters was given, but for the start.
std::string try_start(const Problem& problem, const OptimizeRequest& request, std::string_view task);

/// As kerf/optimize.hpp has it; request.starts are looked at by the pool, with the same results.
OptimizeResult optimize_parameters(const Problem& problem, const OptimizeRequest& request, const Observer& see,
                                   const CheckpointPlace& place, const TaskPool& pool);

}  // namespace kerf
