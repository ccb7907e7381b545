// Times to an error, read off sequences of runs.

#include "bench/measure/compare.hpp"

#include "kerf/types.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::compare_test {
namespace {

using Kind = TimeTo::Kind;

// error = 0.01/seconds
const std::vector<WorkPoint> halving{{0.01, 1}, {0.002, 5}, {0.005, 2}};

TEST(TimeTo, IsExactOnAPowerLaw) {
  const auto t = time_to(halving, 3e-3);
  ASSERT_TRUE(t);
  EXPECT_EQ(t->kind, Kind::Interpolated);
  EXPECT_NEAR(t->seconds, 0.01 / 3e-3, 1e-12);
}

TEST(TimeTo, SaysWhenTheCoarsestRunIsGoodEnough) {
  const auto t = time_to(halving, 0.02);
  ASSERT_TRUE(t);
  EXPECT_EQ(t->kind, Kind::AtMost);
  EXPECT_DOUBLE_EQ(t->seconds, 1);
  EXPECT_EQ(text(t), "<=1");
}

TEST(TimeTo, ExtrapolatesALittleAndNoFurther) {
  const auto near = time_to(halving, 1e-3), far = time_to(halving, 1e-4);
  ASSERT_TRUE(near && far);
  EXPECT_EQ(near->kind, Kind::Extrapolated);
  EXPECT_NEAR(near->seconds, 10, 1e-12);
  EXPECT_EQ(text(near), "~10");
  EXPECT_EQ(far->kind, Kind::Missed);
  EXPECT_DOUBLE_EQ(far->seconds, 5);
  EXPECT_EQ(text(far), ">5 (2e-03)");
}

TEST(TimeTo, DoesNotExtrapolateFromErrorsThatStandStill) {
  EXPECT_EQ(time_to({{0.01, 1}, {0.01, 2}}, 5e-3)->kind, Kind::Missed);
  EXPECT_EQ(time_to({{0.01, 1}}, 5e-3)->kind, Kind::Missed);
}

TEST(TimeTo, LeavesOutWhatIsNoMeasurement) {
  EXPECT_FALSE(time_to({}, 1e-3));
  EXPECT_FALSE(time_to({{nan, 1}, {0, 1}, {1, 0}, {1, nan}}, 1e-3));
  EXPECT_EQ(text(std::nullopt), "-");
  std::vector<WorkPoint> more = halving;
  more.push_back({nan, 1e-9});
  EXPECT_DOUBLE_EQ(time_to(more, 3e-3)->seconds, time_to(halving, 3e-3)->seconds);
}

TEST(TimeTo, PrefersWhatWasReached) {
  const TimeTo reached{Kind::Interpolated, 9, 1e-3}, guessed{Kind::Extrapolated, 1, 1e-3},
      missed{Kind::Missed, 0.1, 5e-3};
  EXPECT_TRUE(faster(reached, guessed));
  EXPECT_TRUE(faster(guessed, missed));
  EXPECT_FALSE(faster(missed, reached));
  EXPECT_TRUE(faster({Kind::AtMost, 8, 1e-3}, reached));
}

}  // namespace
}  // namespace kerf::compare_test
