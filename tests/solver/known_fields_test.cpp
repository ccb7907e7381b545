// Fields of which more is known than their values: what is proved of sums and multiples, and of integrals over
// triangles. The truths are areas and integrals by hand.

#include "solver/data/all_triangles.hpp"
#include "solver/element/local.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

namespace kerf::known_fields_test {
namespace {

const std::array<Vec2, 3> half = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};  // of the unit square

/// A field (f, 0) whose values over a box are known by `range`.
using Range = std::function<Interval(const Interval& x, const Interval& y)>;
class Known final : public Enclosure {
 public:
  explicit Known(Range range) : range_(std::move(range)) {}
  OnPiece along(const EdgeLine&, double, double) const override {
    return {};
  }
  std::array<Interval, 2> over(const Interval& x, const Interval& y) const override {
    return {range_(x, y), Interval{0, 0}};
  }
  int degree() const override {
    return -1;
  }

 private:
  Range range_;
};
VectorField known(std::function<double(const Vec2&)> f, Range range) {
  return VectorField([f = std::move(f)](const Vec2& x) { return Vec2(f(x), 0); },
                     std::make_shared<Known>(std::move(range)));
}

double mean(const TriangleValues& v, const TriangleRule& rule) {
  return v.at.row(0).dot(rule.w);
}

TEST(KnownFields, SmoothOnesAreTakenAsTheyAre) {
  const TriangleRule rule = triangle_rule(10);
  const VectorField f = known([](const Vec2& x) { return std::exp(x.x()); },
                              [](const Interval& x, const Interval&) -> Interval {
                                return {std::exp(x.low), std::exp(x.high)};
                              });
  const TriangleValues v = triangle_values(f, half, rule);
  EXPECT_TRUE(v.whole);
  EXPECT_EQ(v.how, Resolution::Sampled);  // nothing is known of its derivatives
  for (Eigen::Index q = 0; q < rule.w.size(); ++q) EXPECT_DOUBLE_EQ(v.at(0, q), std::exp(rule.x(0, q)));
  EXPECT_NEAR(mean(v, rule), 2 * (std::exp(1.0) - 2), 1e-9);
}

// 1 where x > 0.3: 0.49 of the triangle.
TEST(KnownFields, JumpsAreEnclosed) {
  const TriangleRule rule = triangle_rule(10);
  const auto step = [](const Vec2& x) { return x.x() > 0.3 ? 1.0 : 0.0; };
  const TriangleValues v = triangle_values(known(step,
                                                 [](const Interval& x, const Interval&) -> Interval {
                                                   return {x.low > 0.3 ? 1.0 : 0.0, x.high > 0.3 ? 1.0 : 0.0};
                                                 }),
                                           half, rule);
  EXPECT_FALSE(v.whole);
  EXPECT_EQ(v.how, Resolution::Proved);
  EXPECT_GT(v.error, 0);
  EXPECT_LT(v.error, 0.02);
  EXPECT_NEAR(mean(v, rule), 0.49, v.error);
  // No polynomial of degree 4 leaves less of the step: exact, by rational numbers.
  constexpr double least = 0.03405677478;
  EXPECT_GE(v.rest, least);
  EXPECT_LT(v.rest, 1.2 * least);
}

// 1 above a crack along the lower side and 0 below it: on the triangle there is no jump but at its rim.
TEST(KnownFields, JumpsAlongAnEdgeAreNoneInside) {
  const TriangleRule rule = triangle_rule(10);
  const TriangleValues v = triangle_values(known([](const Vec2& x) { return x.y() >= 0 ? 1.0 : 0.0; },
                                                 [](const Interval&, const Interval& y) -> Interval {
                                                   return {y.low > 0 ? 1.0 : 0.0, 1};
                                                 }),
                                           half, rule);
  EXPECT_TRUE(v.whole);
  EXPECT_EQ(v.how, Resolution::Proved);
  EXPECT_NEAR(mean(v, rule), 1, 1e-14);
  EXPECT_GT(v.error, 0);
  EXPECT_LT(v.error, 1e-9);
  EXPECT_GT(v.rest, 0);
  EXPECT_LT(v.rest, 1e-9);
}

// Ten waves in each triangle, of which nothing but the range is known: a few looks per triangle, and no proof.
TEST(KnownFields, WhatCannotBeProvedCostsAFewLooks) {
  const TriangleRule rule = triangle_rule(10);
  std::atomic<int> looks = 0;
  const VectorField f = known([](const Vec2& x) { return 2 + std::sin(6000 * x.x()) * std::cos(5000 * x.y()); },
                              [&looks](const Interval&, const Interval&) -> Interval {
                                return ++looks, Interval{1, 3};
                              });
  std::vector<Index> all(5000);
  std::iota(all.begin(), all.end(), 0);
  const auto cell = [](Index t) {
    const double x = 0.01 * (t % 100), y = 0.01 * (t / 100);
    return Triangle{.x = {Vec2(x, y), Vec2(x + 0.01, y), Vec2(x, y + 0.01)}};
  };
  const std::vector<TriangleValues> values = triangle_values(f, all, cell, rule, 3, "body force", 2);
  EXPECT_LT(looks, 40 * 5000);  // some 14 looks, of two or three ranges each
  double total = 0;
  for (const TriangleValues& v : values) total += mean(v, rule) / 5000;
  EXPECT_NEAR(total, 2, 0.05);
}

TEST(KnownFields, NothingIsProvedOfWhatHasNoRange) {
  const TriangleRule rule = triangle_rule(10);
  const Range none = [](const Interval&, const Interval&) { return Interval{}; };
  const TriangleValues v = triangle_values(known([](const Vec2&) { return 1.0; }, none), half, rule);
  EXPECT_EQ(v.how, Resolution::Open);
  EXPECT_EQ(v.rest, infinity);
  EXPECT_EQ(v.error, infinity);
  try {
    triangle_values(known([](const Vec2&) { return nan; }, none), half, rule, 0, "weight");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_EQ(std::string(e.what()).find("the weight is not finite at ("), 0u) << e.what();
  }
}

/// Every value at places of a box lies in the range over it, and at places of a segment in that along it.
void expect_enclosed(const VectorField& f, double wide) {
  ASSERT_TRUE(f.known());
  const Interval x{-0.5, 0.75}, y{0.25, 1};
  const std::array<Interval, 2> over = f.known()->over(x, y);
  const EdgeLine edge{{-1, 0.5}, {2, -1}, {0, 1}};
  const OnPiece along = f.known()->along(edge, 0.25, 0.75);
  for (int d = 0; d < 2; ++d) {
    EXPECT_LT(over[std::size_t(d)].high - over[std::size_t(d)].low, wide);
    for (int i = 0; i <= 10; ++i) {
      const double s = 0.25 + 0.05 * i, on = f(edge.a + s * (edge.b - edge.a))[d];
      EXPECT_LE(along.value[std::size_t(d)].low, on);
      EXPECT_GE(along.value[std::size_t(d)].high, on);
      for (int k = 0; k <= 10; ++k) {
        const double at = f(Vec2(x.low + 0.1 * i * (x.high - x.low), y.low + 0.1 * k * (y.high - y.low)))[d];
        EXPECT_LE(over[std::size_t(d)].low, at);
        EXPECT_GE(over[std::size_t(d)].high, at);
      }
    }
    EXPECT_NEAR(along.eighth[std::size_t(d)], 0, 1e-300);  // of straight lines
  }
  EXPECT_FALSE(along.cut);
  EXPECT_EQ(f.known()->degree(), 1);
}

TEST(KnownFields, SumsAndMultiplesAreKnownToo) {
  const VectorField a = linear_field([](const Vec2&x) { return Vec2(1 + 2 * x.x(), x.y() - x.x()); }),
                    b = linear_field([](const Vec2&x) { return Vec2(3 * x.y(), -4); });
  expect_enclosed(a, 2.51);
  expect_enclosed(b, 2.26);
  expect_enclosed(sum(a, b), 4.76);
  expect_enclosed(scaled(-2, a), 5.01);
  expect_enclosed(sum(scaled(-2, a), scaled(0.5, b)), 6.2);
  EXPECT_EQ(sum(a, b)(Vec2(1, 2)), Vec2(9, -3));
  EXPECT_EQ(scaled(-2, a)(Vec2(1, 2)), Vec2(-6, -2));
}

TEST(KnownFields, OfNothingAndOfBlackBoxes) {
  const VectorField box = [](const Vec2&x) { return x; }, none;
  const VectorField line = linear_field([](const Vec2& x) { return x; });
  EXPECT_FALSE(scaled(2, none));
  EXPECT_FALSE(sum(none, none));
  EXPECT_TRUE(sum(none, line).known());
  EXPECT_TRUE(sum(line, none).known());
  EXPECT_FALSE(sum(line, box).known());
  EXPECT_FALSE(scaled(2, box).known());
  // What has no end stays without one.
  const VectorField open =
      known([](const Vec2&) { return 1.0; }, [](const Interval&, const Interval&) { return Interval{}; });
  for (const VectorField& f : {sum(open, line), scaled(0, open)}) {
    const Interval over = f.known()->over({0, 1}, {0, 1})[0];
    EXPECT_EQ(over.low, -infinity);
    EXPECT_EQ(over.high, infinity);
    EXPECT_EQ(f.known()->degree(), -1);
  }
}

}  // namespace
}  // namespace kerf::known_fields_test
