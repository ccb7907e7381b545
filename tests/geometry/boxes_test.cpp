// The index of boxes: it finds what a look at every box finds, and looks at few.
#include "geometry/boxes.hpp"

#include "geometry/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace kerf;

namespace boxes_test {

/// Of sizes over six decades, few of which meet, half of them crowded into one corner.
std::vector<AxisBox> uneven(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<AxisBox> boxes;
  for (std::size_t i = 0; i < n; ++i) {
    const double scale = i % 2 == 0 ? 1 : 1e-4, size = scale / std::sqrt(double(n)) * std::pow(10, -6 * unit(random));
    const Vec2 low(scale * unit(random), scale * unit(random));
    boxes.push_back({low, low + size * Vec2(unit(random), unit(random))});
  }
  return boxes;
}

TEST(BoxTree, FindsWhatEveryBoxWouldSay) {
  for (const std::size_t n : {0, 1, 2, 5, 300}) {
    const std::vector<AxisBox> boxes = uneven(n, 1), asked = uneven(200, 2);
    const BoxTree tree(boxes);
    for (const AxisBox& box : asked) {
      std::vector<Index> expected;
      for (std::size_t i = 0; i < n; ++i)
        if (boxes[i].meets(box)) expected.push_back(Index(i));
      EXPECT_EQ(tree.meeting(box), expected);
    }
  }
}

TEST(BoxTree, TheNearestOneComesWithFewLooks) {
  std::vector<double> looks;
  for (const std::size_t n : {1000, 4000, 16000}) {
    const std::vector<AxisBox> boxes = uneven(n, 3);
    const BoxTree tree(boxes);
    double count = 0;
    const auto counted = [&](const AxisBox&) {
      ++count;
      return true;
    };
    const std::vector<AxisBox> asked = uneven(200, 4);
    for (const AxisBox& box : asked) {
      double least = infinity, expected = infinity;
      tree.each_near(box.low, least, counted, [&](Index i) {
        least = std::min(least, std::sqrt(boxes[std::size_t(i)].squared_distance(box.low)));
      });
      for (const AxisBox& b : boxes) expected = std::min(expected, std::sqrt(b.squared_distance(box.low)));
      EXPECT_EQ(least, expected);
    }
    looks.push_back(count / double(asked.size()));
  }
  EXPECT_LT(looks.back(), 100);
  EXPECT_LT(looks.back(), 1.7 * looks.front());  // 16 times as many boxes
}

TEST(BoxTree, BoxesAllInOnePlaceAreNoMatter) {
  const std::vector<AxisBox> boxes(1000, AxisBox{{1, 1}, {2, 2}});
  const BoxTree tree(boxes);
  EXPECT_EQ(tree.meeting({{2, 2}, {3, 3}}).size(), 1000u);
  EXPECT_TRUE(tree.meeting({{2.5, 2}, {3, 3}}).empty());
}

TEST(BoxTree, WhatReachesOneBoxReachesNoOther) {
  std::vector<AxisBox> row;
  for (int i = 0; i < 100; ++i) row.push_back({Vec2(i, 0), Vec2(i + 0.5, 1)});
  const BoxTree tree(row);
  std::vector<Index> found;
  const double reach = 0.25;
  tree.each_near(
      {41.75, 0.5}, reach, [](const AxisBox&) { return true; }, [&](Index i) { found.push_back(i); });
  std::ranges::sort(found);
  EXPECT_EQ(found, (std::vector<Index>{41, 42}));
}

}  // namespace boxes_test
