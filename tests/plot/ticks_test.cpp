// Numbers along an axis against labels by hand: round, inside, distinct and few at every size and offset.

#include "plot/figure/ticks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::ticks_test {
namespace {

using Labels = std::vector<std::string>;

TEST(Ticks, RoundNumbersInside) {
  const Ticks t = ticks(-1.03, 1.03, 5);
  EXPECT_EQ(t.labels, (Labels{"−1.0", "−0.5", "0.0", "0.5", "1.0"}));
  EXPECT_EQ(t.note, "");
  EXPECT_EQ(ticks(0, 10, 6).labels, (Labels{"0", "2", "4", "6", "8", "10"}));
}

TEST(Ticks, LargeAndSmallNumbersShareAPowerOfTen) {
  const Ticks small = ticks(0, 2e-6, 4);
  EXPECT_EQ(small.labels, (Labels{"0", "1", "2"}));
  EXPECT_EQ(small.note, "×10⁻⁶");
  const Ticks large = ticks(-1.5e7, 1.5e7, 3);
  EXPECT_EQ(large.labels, (Labels{"−1", "0", "1"}));
  EXPECT_EQ(large.note, "×10⁷");
}

TEST(Ticks, FarFromZeroShareAnOffset) {
  const Ticks t = ticks(1e6, 1e6 + 1, 6);
  EXPECT_EQ(t.labels, (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(t.note, "+ 1000000");
}

TEST(Ticks, AlwaysInsideDistinctAndNotTooMany) {
  for (const double size : {1e-250, 1e-30, 1e-7, 0.3, 1.0, 37.0, 1e9, 1e250}) {
    for (const double start : {0.0, -1.0, -0.371, 5.0, 1e4}) {
      for (int most = 2; most <= 12; ++most) {
        const double low = start * size, high = (start + 1) * size;
        const Ticks t = ticks(low, high, most);
        ASSERT_EQ(t.at.size(), t.labels.size());
        ASSERT_GE(t.at.size(), 2u) << low << ' ' << high;
        if (most >= 4) {
          ASSERT_LE(int(t.at.size()), most) << low << ' ' << high;
        }
        for (std::size_t i = 0; i < t.at.size(); ++i) {
          EXPECT_GE(t.at[i], low - 1e-5 * size);
          EXPECT_LE(t.at[i], high + 1e-5 * size);
          if (i > 0) {
            EXPECT_NE(t.labels[i], t.labels[i - 1]);
          }
        }
      }
    }
  }
}

TEST(Ticks, DegenerateIntervalsHaveOneLabel) {
  EXPECT_EQ(ticks(3, 3, 5).labels, (Labels{"3"}));
  EXPECT_EQ(ticks(0, 0, 5).labels, (Labels{"0"}));
  EXPECT_EQ(ticks(std::nan(""), 1, 5).labels.size(), 1u);
}

TEST(Pretty, MinusAndExponent) {
  EXPECT_EQ(pretty(-1.5e-6), "−1.5×10⁻⁶");
  EXPECT_EQ(pretty(1e20), "1×10²⁰");
  EXPECT_EQ(pretty(0.25), "0.25");
  EXPECT_EQ(pretty(-0.0), "0");
  EXPECT_EQ(pretty(std::nan("")), "–");
}

}  // namespace
}  // namespace kerf::ticks_test
