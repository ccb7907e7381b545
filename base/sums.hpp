#pragma once
// What processes that have a body in parts find out together.

#include <Eigen/Core>

#include <functional>
#include <span>

namespace kerf {

/// Over processes, the same on all.
struct Sums {
  std::function<void(std::span<double>)> add, most;
};

/// Of one process, which has the whole.
inline Sums sums_of_one() {
  const auto nothing = [](std::span<double>) {};
  return {nothing, nothing};
}

/// How far the skeleton moves under forces, both per unknown, while all faces in contact move freely: one sweep of the
/// penalty iteration, where there is a penalty.
using OpenSolve = std::function<Eigen::VectorXd(const Eigen::VectorXd& forces)>;

}  // namespace kerf
