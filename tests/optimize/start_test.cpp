// Patterns of holes to start from: their number and place by hand; random ones repeat.

#include "optimize/level_set/start.hpp"

#include <gtest/gtest.h>

namespace kerf::start_test {
namespace {

TEST(StartDiscs, RegularPatternsLieInTheBoxAndRandomOnesRepeat) {
  const StartHoles regular{.columns = 4, .rows = 3, .radius = 0.1};
  const std::vector<Disc> discs = start_discs(regular, {0, 0}, {2, 1});
  EXPECT_EQ(discs.size(), 14u);  // columns of 3 and 4 by turns
  for (const Disc& d : discs)
    EXPECT_TRUE(d.center.x() > 0 && d.center.x() < 2 && d.center.y() >= 0 && d.center.y() <= 1);

  const StartHoles random{.random = 5, .seed = 7};
  const std::vector<Disc> a = start_discs(random, {0, 0}, {2, 1}), b = start_discs(random, {0, 0}, {2, 1});
  ASSERT_EQ(a.size(), 5u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].center, b[i].center);
  EXPECT_NE(a[0].center, start_discs({.random = 5, .seed = 8}, {0, 0}, {2, 1})[0].center);
}

}  // namespace
}  // namespace kerf::start_test
