// What a bound on the largest stress leaves out of an L-shaped body.

#include "optimize/stress_zones.hpp"

#include <gtest/gtest.h>

namespace kerf::stress_zones_test {
namespace {

constexpr Index left = 0, load = 1, edge = 2, roller = 3;

/// (0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2): clamped on the left, loaded on the right, on rollers at the top.
Shape body() {
  Shape s;
  s.labels = {"left", "load", "edge", "roller"};
  s.outline.sides = {{{0, 0}, edge, {}}, {{2, 0}, load, {}},   {{2, 1}, edge, {}},
                     {{1, 1}, edge, {}}, {{1, 2}, roller, {}}, {{0, 2}, left, {}}};
  return s;
}

struct Drawn {
  Shape shape = body();
  std::vector<Support> supports{{left, false, true, true, {}}, {roller, true, true, false, {}}};
  std::vector<Index> loaded{load};
  std::vector<Loop> frozen = {};
  bool leaves_out(const Vec2& x, LargestStress how = {}) const {
    how.zones = stress_zones({shape, supports, loaded, frozen}, how);
    return how.leaves_out(x);
  }
};

TEST(StressZones, AreWhereEveryDesignIsSingular) {
  const Drawn d;
  const double size = extent(d.shape), end = 0.01 * size, band = 0.014 * size;
  for (const double y : {0.1, 1.0, 1.9}) {  // the clamp
    EXPECT_TRUE(d.leaves_out({0.9 * band, y}));
    EXPECT_FALSE(d.leaves_out({1.1 * band, y}));
  }
  for (const double y : {0.0, 1.0}) {  // ends of the load
    EXPECT_TRUE(d.leaves_out({2 - 0.9 * end, y}));
    EXPECT_FALSE(d.leaves_out({2 - 1.1 * end, y}));
  }
  EXPECT_FALSE(d.leaves_out({2, 0.5}));
  // A design may cut the corner away, and rollers that end at a right angle are regular.
  EXPECT_FALSE(d.leaves_out({1, 1}));
  EXPECT_FALSE(d.leaves_out({1, 2}));
}

TEST(StressZones, HaveTheCornersThatStaySolid) {
  Drawn d;
  d.frozen = {polygon("pad", {{0.5, 0.5}, {1.5, 0.5}, {1.5, 1.5}, {0.5, 1.5}}, none)};
  EXPECT_TRUE(d.leaves_out({1, 1}));
  d.frozen = {polygon("pad", {{0.5, 0.5}, {1.0, 0.5}, {1.0, 1.5}, {0.5, 1.5}}, none)};
  EXPECT_FALSE(d.leaves_out({1, 1}));
}

TEST(StressZones, HaveCracksAndOtherMaterials) {
  Drawn d;
  d.shape.cracks.push_back({"c", {{0.5, 0.5}, {0.8, 0.5}}, {}});
  d.shape.regions.push_back(polygon("hard", {{1.2, 0.2}, {1.4, 0.2}, {1.4, 0.4}, {1.2, 0.4}}, none));
  EXPECT_TRUE(d.leaves_out({0.81, 0.5}));
  EXPECT_FALSE(d.leaves_out({0.65, 0.5}));
  EXPECT_TRUE(d.leaves_out({1.2, 0.2}));
  EXPECT_FALSE(d.leaves_out({1.3, 0.2}));
}

TEST(StressZones, CanBeTakenAwayAndAreNamed) {
  const Drawn d;
  EXPECT_FALSE(d.leaves_out({0, 1}, {.ends = 0.01, .supports = 0}));
  EXPECT_FALSE(d.leaves_out({2, 0}, {.ends = 0, .supports = 0.02}));
  LargestStress how;
  how.zones = stress_zones({d.shape, d.supports, d.loaded, d.frozen}, how);
  const std::string words = zones_in_words(how);
  EXPECT_NE(words.find("support \"left\" within 0.0396"), std::string::npos) << words;
  EXPECT_NE(words.find("end of load \"load\" at (2, 0) within 0.0283"), std::string::npos) << words;
  EXPECT_EQ(zones_in_words({}), "");
}

}  // namespace
}  // namespace kerf::stress_zones_test
