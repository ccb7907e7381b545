// The two scales of color against their published tables, and the limits of a picture against shares of its area.

#include "plot/figure/colors.hpp"

#include "tests/support/sample.hpp"

namespace kerf::colors_test {
namespace {

using test::grid;

void expect_near(std::uint32_t color, int red, int green, int blue, int distance) {
  EXPECT_NEAR(int(color >> 16 & 255), red, distance);
  EXPECT_NEAR(int(color >> 8 & 255), green, distance);
  EXPECT_NEAR(int(color & 255), blue, distance);
}

double lightness(std::uint32_t color) {
  const auto linear = [&](int shift) {
    const double c = double(color >> shift & 255) / 255;
    return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92;
  };
  return 116 * std::cbrt(0.2126 * linear(16) + 0.7152 * linear(8) + 0.0722 * linear(0)) - 16;
}

TEST(Colors, ViridisEndsQuartersAndRisingLightness) {
  const Colors& table = colors(Scale::Linear);
  expect_near(table[0], 68, 1, 84, 0);
  expect_near(table[64], 59, 82, 139, 2);
  expect_near(table[128], 33, 145, 140, 2);
  expect_near(table[192], 94, 201, 98, 2);
  expect_near(table[255], 253, 231, 37, 0);
  for (std::size_t k = 1; k < 256; ++k) EXPECT_GT(lightness(table[k]), lightness(table[k - 1]) - 0.3);
}

TEST(Colors, CoolWarmIsLightInTheMiddleAndFallsToBothEnds) {
  const Colors& table = colors(Scale::Diverging);
  expect_near(table[0], 59, 76, 192, 1);
  expect_near(table[255], 180, 4, 38, 1);
  expect_near(table[127], 221, 221, 221, 3);
  expect_near(table[64], 141, 176, 254, 3);   // Moreland's table at 1/4
  expect_near(table[191], 244, 154, 123, 3);  // and at 3/4
  for (std::size_t k = 1; k < 128; ++k) {
    EXPECT_GT(lightness(table[k]), lightness(table[k - 1]) - 0.3);
    EXPECT_GT(lightness(table[255 - k]), lightness(table[256 - k]) - 0.3);
  }
}

TEST(Limits, QuantilesWeighAreasAndLeaveOutASpike) {
  Picture picture = grid({0, 0}, {1, 1}, 50, 50, [](const Vec2& p) { return p.norm() < 1e-9 ? 1000 : p.x(); });
  const Limits l = limits(picture);
  EXPECT_EQ(l.low, 0);
  EXPECT_GT(l.high, 0.98);
  EXPECT_LE(l.high, 1);
  EXPECT_FALSE(l.below());
  EXPECT_TRUE(l.above());
  EXPECT_EQ(l.most, 1000);
  picture.clip = 0;
  EXPECT_EQ(limits(picture).high, 1000);
}

TEST(Limits, ManySmallTrianglesDoNotOutweighALargeOne) {
  // One big triangle of value 1, a thousand tiny ones of value 100.
  Picture picture;
  picture.points = {{0, 0}, {1, 0}, {0, 1}, {0.001, 0}, {0, 0.001}};
  picture.triangles = {{0, 1, 2}};
  for (int i = 0; i < 1000; ++i) picture.triangles.push_back({0, 3, 4});
  picture.values = Eigen::Matrix3Xd::Constant(3, 1001, 100);
  picture.values.col(0) << 1, 1.5, 2;
  const Limits l = limits(picture);
  EXPECT_EQ(l.low, 1);
  EXPECT_EQ(l.high, 2);
  EXPECT_TRUE(l.above());
}

TEST(Limits, AtMostTheShareOfTheAreaLiesBeyond) {
  Picture picture =
      grid({0, 0}, {1, 1}, 100, 1, [](const Vec2& p) { return std::pow(p.x(), 9) - std::pow(1 - p.x(), 9); });
  picture.clip = 0.1;
  const Limits l = limits(picture);
  int beyond = 0;
  for (Eigen::Index i = 0; i < picture.values.size(); ++i) beyond += picture.values.data()[i] > l.high;
  EXPECT_TRUE(l.above());
  EXPECT_LE(beyond, 0.1 * double(picture.values.size()));
  EXPECT_GE(beyond, 0.08 * double(picture.values.size()));
}

TEST(Limits, DivergingIsSymmetricConstantHasWidthNothingFiniteToo) {
  Picture picture = grid({0, 0}, {1, 1}, 10, 10, [](const Vec2& p) { return -3 * p.x() + 1; });
  picture.scale = Scale::Diverging;
  const Limits l = limits(picture);
  EXPECT_EQ(l.low, -2);
  EXPECT_EQ(l.high, 2);
  for (const double value : {0.0, 5.0, -1e-20, 1e200}) {
    const Limits constant = limits(grid({0, 0}, {1, 1}, 2, 2, [&](const Vec2&) { return value; }));
    EXPECT_LT(constant.low, value);
    EXPECT_GT(constant.high, value);
    EXPECT_NEAR(0.5 * constant.low + 0.5 * constant.high, value, 1e-12 * std::abs(value));
    EXPECT_FALSE(constant.below() || constant.above());
  }
  const Limits nothing = limits(grid({0, 0}, {1, 1}, 2, 2, [](const Vec2&) { return std::nan(""); }));
  EXPECT_LT(nothing.low, nothing.high);
  EXPECT_FALSE(nothing.below() || nothing.above());
}

}  // namespace
}  // namespace kerf::colors_test
