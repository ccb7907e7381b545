// An interval holds every value that its operands allow: seen against the same operation in extended precision at
// numbers inside them, ends that are 0 or infinite among them.
#include "io/case/interval.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace kerf::interval_test {
namespace {

// Intervals whose ends meet where rules change: 0, 1, infinity, quarter turns, and numbers between.
std::vector<Interval> some_intervals() {
  const std::vector<double> ends{-infinity, -1e9, -7.5, -pi,    -1, -0.25, -1e-300, 0,
                                 1e-300,    0.25, 1,    pi / 2, 3,  40,    1e9,     infinity};
  std::vector<Interval> all;
  for (const double low : ends)
    for (const double high : ends)
      if (low <= high && low < infinity && high > -infinity) all.push_back({low, high});
  return all;
}

// Numbers of an interval: its ends where they are finite, 0 and 1 where they lie inside, and some between.
std::vector<double> numbers_of(const Interval& a) {
  std::vector<double> in;
  const double low = std::max(a.low, -1e12), high = std::min(a.high, 1e12);
  for (const double v : {low, high, 0.0, 1.0, -1.0, low + 0.3 * (high - low), low + 0.8 * (high - low), pi / 2})
    if (contains(a, v)) in.push_back(v);
  return in;
}

bool holds(const Interval& a, long double v) {
  return std::isnan(v) || (static_cast<long double>(a.low) <= v && v <= static_cast<long double>(a.high));
}

template <typename Bounds, typename Value>
void expect_holds(Bounds&& bounds, Value&& value) {
  for (const Interval& a : some_intervals()) {
    const Interval found = bounds(a);
    ASSERT_LE(found.low, found.high) << a.low << " " << a.high;
    for (const double v : numbers_of(a))
      EXPECT_TRUE(holds(found, value(static_cast<long double>(v))))
          << "[" << a.low << ", " << a.high << "] at " << v << ": [" << found.low << ", " << found.high << "]";
  }
}

template <typename Bounds, typename Value>
void expect_pairs_hold(Bounds&& bounds, Value&& value) {
  for (const Interval& a : some_intervals())
    for (const Interval& b : some_intervals()) {
      const Interval found = bounds(a, b);
      ASSERT_LE(found.low, found.high);
      for (const double v : numbers_of(a))
        for (const double w : numbers_of(b))
          ASSERT_TRUE(holds(found, value(static_cast<long double>(v), static_cast<long double>(w))))
              << "[" << a.low << ", " << a.high << "] and [" << b.low << ", " << b.high << "] at " << v << ", " << w
              << ": [" << found.low << ", " << found.high << "]";
    }
}

TEST(IntervalTest, SumsDifferencesProductsAndQuotientsHoldTheirValues) {
  expect_pairs_hold([](auto a, auto b) { return a + b; }, [](long double v, long double w) { return v + w; });
  expect_pairs_hold([](auto a, auto b) { return a - b; }, [](long double v, long double w) { return v - w; });
  expect_pairs_hold([](auto a, auto b) { return a * b; }, [](long double v, long double w) { return v * w; });
  expect_pairs_hold([](auto a, auto b) { return a / b; },
                    [](long double v, long double w) { return w == 0 ? std::nanl("") : v / w; });
}

TEST(IntervalTest, FunctionsHoldTheirValues) {
  expect_holds([](auto a) { return absolute(a); }, [](long double v) { return std::abs(v); });
  expect_holds([](auto a) { return square_root(a); }, [](long double v) { return std::sqrt(v); });
  expect_holds([](auto a) { return exponential(a); }, [](long double v) { return std::exp(v); });
  expect_holds([](auto a) { return logarithm(a); }, [](long double v) { return std::log(v); });
  expect_holds([](auto a) { return sine(a); }, [](long double v) { return std::sin(v); });
  expect_holds([](auto a) { return cosine(a); }, [](long double v) { return std::cos(v); });
  expect_holds([](auto a) { return arc_tangent(a); }, [](long double v) { return std::atan(v); });
  for (const int n : {-3, -2, -1, 0, 1, 2, 3, 6})
    expect_holds([n](auto a) { return power(a, n); },
                 [n](long double v) { return v == 0 && n < 0 ? std::nanl("") : std::pow(v, n); });
  for (const double p : {-1.5, 0.5, 2.25})
    expect_holds(
        [p](auto a) { return power(a, p); },
        [p](long double v) { return v == 0 && p < 0 ? std::nanl("") : std::pow(v, static_cast<long double>(p)); });
}

TEST(IntervalTest, AnglesHoldTheirValuesAndTheCutIsNotCrossed) {
  expect_pairs_hold([](auto y, auto x) { return arc_tangent(y, x); },
                    [](long double y, long double x) { return std::atan2(y, x); });
  const Interval above_axis = arc_tangent({1, 2}, {-2, -1});
  EXPECT_GT(above_axis.low, pi / 2);
  EXPECT_LT(above_axis.high, pi);
}

TEST(IntervalTest, RulesAreExactWhereTheyMustBe) {
  EXPECT_TRUE(is(exactly(0) * whole_line, 0)) << "the derivative of a constant vanishes";
  EXPECT_TRUE(is(exactly(1) * exactly(0.1), 0.1));
  EXPECT_TRUE(is(power(exactly(0.1), 1), 0.1));
  EXPECT_TRUE(is(power(whole_line, 0), 1));
  EXPECT_TRUE(is(exactly(0.1) / exactly(1), 0.1));
  const Interval quotient = exactly(1) / Interval{0, 2};
  EXPECT_LE(quotient.low, 0.5);
  EXPECT_GT(quotient.low, 0.4999);
  EXPECT_EQ(quotient.high, infinity);
  EXPECT_LT((exactly(-1) / Interval{0, 2}).high, -0.4999);
  EXPECT_LT((exactly(1) / Interval{-2, 0}).high, -0.4999);
  EXPECT_FALSE(is_bounded(exactly(1) / Interval{-1, 1}));
  EXPECT_FALSE(is_bounded(exactly(1) / exactly(0)));
}

TEST(IntervalTest, TwoEnclosuresMeet) {
  const Interval both = common({0, 2}, {1, 3});
  EXPECT_EQ(both.low, 1);
  EXPECT_EQ(both.high, 2);
  const Interval apart = common({0, 1}, {2, 3});  // rounding alone can part them: the first is kept
  EXPECT_EQ(apart.low, 0);
  EXPECT_EQ(apart.high, 1);
}

}  // namespace
}  // namespace kerf::interval_test
