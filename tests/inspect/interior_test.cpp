// The worst direction of a small crack: the closed form against a search over all angles, and known cases.

#include "inspect/interior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::inspect::interior_test {
namespace {

/// K_I^2 + K_II^2 over pi of a crack in a direction, straight from its tractions.
double released(const Eigen::Vector3d& s, double friction, double direction) {
  const double nx = -std::sin(direction), ny = std::cos(direction);
  const double tx = s[0] * nx + s[2] * ny, ty = s[2] * nx + s[1] * ny;
  const double normal = tx * nx + ty * ny, shear = std::abs(tx * ny - ty * nx);
  if (normal > 0) return normal * normal + shear * shear;
  const double driven = std::max(shear + friction * normal, 0.);
  return driven * driven;
}

TEST(Interior, TheWorstDirectionIsTheWorst) {
  std::mt19937 dice(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d s(any(dice), any(dice), any(dice));
    const double friction = i % 3 == 0 ? 0 : std::abs(any(dice));
    const WorstCrack worst = worst_crack(s, friction);
    const double found = worst.K_I * worst.K_I + worst.K_II * worst.K_II;
    double most = 0;
    for (int k = 0; k < 3600; ++k) most = std::max(most, released(s, friction, k * pi / 3600));
    EXPECT_GE(found, most - 1e-12);
    EXPECT_LE(found, most + 3e-3 * s.norm() * s.norm());
    // Its direction is where that is found, from one side where faces begin to close.
    const double at = worst.direction;
    EXPECT_NEAR(
        std::max({released(s, friction, at), released(s, friction, at + 1e-6), released(s, friction, at - 1e-6)}),
        found, 1e-4 * s.norm() * s.norm() + 1e-12);
    EXPECT_GE(at, 0);
    EXPECT_LT(at, pi);
  }
}

TEST(Interior, KnownCases) {
  const WorstCrack pulled = worst_crack({0, 2, 0}, 0.5);
  EXPECT_NEAR(pulled.K_I, 2, 1e-12);
  EXPECT_NEAR(std::sin(pulled.direction), 0, 1e-12);
  const WorstCrack pressed = worst_crack({0, -1, 0}, 0.3);  // (sqrt(1 + mu^2) - mu)/2
  EXPECT_TRUE(pressed.closed);
  EXPECT_NEAR(pressed.K_II, (std::sqrt(1.09) - 0.3) / 2, 1e-12);
  EXPECT_EQ(worst_crack({-1, -1, 0}, 0).K_II, 0);
}

}  // namespace
}  // namespace kerf::inspect::interior_test
