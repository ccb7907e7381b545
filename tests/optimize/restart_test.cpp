// Misfits go to zero: what a bad start makes of an end, and what a restart finds there.

#include "tests/optimize/inverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::restart_test {
namespace {

using Eigen::VectorXd;
using inverse::Plate;

/// The truth is solved on another mesh by another element. Radius and stiffness of an inclusion trade places in a
/// narrow valley of J, whose floor is a ten thousandth of J at bad starts.
struct Valley {
  Plate plate;
  Problem problem;
  Drawn region;
  Valley() {
    plate.inclusions = {{{0.55, 0.48}, 0.2}};
    plate.inclusion_young = 4;
    plate.size = 0.1;
    plate.true_size = 0.05;
    Synthetic truth = plate.truth();
    truth.spacing = 0.025;
    problem = plate.frame();
    problem.objective = with_measured(problem.objective, 1, measure(truth).field);
    region = plate.region("r", 0.2, 20);
    region.upper[2] = 0.3;
    region.from_map = false;
  }
  OptimizeResult run(const VectorXd& start) {
    region.start = start;
    OptimizeRequest r{.method = OptimizeMethod::Slsqp, .max_iterations = 150};
    r.design.drawn = {region};
    return optimize_parameters(problem, r, {}, {});
  }
};

TEST(Restart, EndsThatAreCalledOptimalAreNotThoseOfBadStarts) {
  Valley valley;
  int optimal = 0;
  const std::array starts{Eigen::Vector4d(0.4, 0.6, 0.12, 2), Eigen::Vector4d(0.65, 0.35, 0.1, 15),
                          Eigen::Vector4d(0.35, 0.35, 0.28, 0.5), Eigen::Vector4d(0.5, 0.5, 0.25, 19)};
  for (const Eigen::Vector4d& start : starts) {
    const OptimizeResult end = valley.run(start);
    if (end.ending != Ending::Optimal) continue;
    ++optimal;
    // What is left is the error of the mesh, and a restart finds nothing more than that.
    const OptimizeResult again = valley.run(end.variables);
    EXPECT_GE(again.objective,
              end.objective - std::max(1e-3 * end.objective, std::abs(end.finer.objective - end.objective)));
    EXPECT_NEAR(end.variables[2], 0.2, 0.005) << end.stopped;
    EXPECT_NEAR(end.variables[3], 4, 0.2) << end.stopped;
  }
  EXPECT_EQ(optimal, 4);
}

}  // namespace
}  // namespace kerf::restart_test
