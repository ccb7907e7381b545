#pragma once
// What processes that have a body in parts find out together.

#include <functional>
#include <span>

namespace kerf {

/// Over processes, the same on all.
struct Sums {
  std::function<void(std::span<double>)> add, most;
};

}  // namespace kerf
