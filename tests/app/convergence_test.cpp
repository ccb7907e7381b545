// Richardson's extrapolation of a quantity on three meshes.

#include "app/sweep/convergence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::convergence_test {
namespace {

Convergence of(double limit, double c, double order) {
  Convergence out{.of = "q", .size = {0.4, 0.2, 0.1}};
  for (std::size_t k = 0; k < 3; ++k) out.value[k] = limit + c * std::pow(out.size[k], order);
  extrapolate(out);
  return out;
}

TEST(Convergence, OrderAndLimitOfAPowerAreExact) {
  for (const double order : {0.5, 1.0, 2.0, 4.0})
    for (const double c : {-3.0, 0.2}) {
      const Convergence found = of(7, c, order);
      EXPECT_NEAR(found.order, order, 1e-9);
      EXPECT_NEAR(found.limit, 7, 1e-10);
      EXPECT_NEAR(found.error, std::abs(c) * std::pow(0.1, order), 1e-10);
    }
}

TEST(Convergence, DifferencesThatDoNotFallHaveNoLimit) {
  for (const std::array<double, 3>& values : {std::array<double, 3>{1, 2, 3.5}, {1, 2, 1.5}}) {
    Convergence c{.of = "q", .size = {4, 2, 1}, .value = values};
    extrapolate(c);
    EXPECT_TRUE(std::isnan(c.limit));
    EXPECT_GE(c.error, 1);
  }
}

// What falls as slowly as noise has no limit, what falls by chance no error of its own.
TEST(Convergence, OrdersThatNoMeshHasAreNotBelieved) {
  const Convergence slow = of(1.4873, 2e-4, 0.18), fast = of(1, 1e6, 9);
  EXPECT_TRUE(std::isnan(slow.limit));
  EXPECT_LT(slow.error, 1e-4);
  EXPECT_GE(fast.error, std::abs(fast.value[2] - fast.value[1]) / 16);
}

TEST(Convergence, WhatNoMeshChangesIsItsLimit) {
  Convergence c{.of = "q", .size = {4, 2, 1}, .value = {2, 2, 2}};
  extrapolate(c);
  EXPECT_EQ(c.limit, 2);
  EXPECT_EQ(c.error, 0);
}

}  // namespace
}  // namespace kerf::convergence_test
