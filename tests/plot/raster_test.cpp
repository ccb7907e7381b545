// Triangles drawn into pixels: covered samples against the area, every sample once, linear values.

#include "plot/figure/raster.hpp"

#include <gtest/gtest.h>

namespace kerf::raster_test {
namespace {

const std::vector<std::array<Index, 3>> one = {{0, 1, 2}};

std::uint32_t pixel(const Image& image, int i, int j) {
  return image.pixels[std::size_t(j) * std::size_t(image.width) + std::size_t(i)];
}

TEST(Raster, AreaOfATriangleInSamples) {
  const std::vector<Vec2> points = {{10, 10}, {90, 10}, {10, 70}};
  Painting painting;
  painting.points = points;
  painting.triangles = one;
  const Image image = paint(100, 80, painting);
  double covered = 0;
  for (const std::uint32_t p : image.pixels) covered += (p >> 24) / 255.0;
  EXPECT_NEAR(covered, 0.5 * 80 * 60, 15);  // half a sample along the slanted side
  EXPECT_EQ(pixel(image, 5, 5), 0u) << "transparent";
  EXPECT_EQ(pixel(image, 12, 12), painting.plain);
}

TEST(Raster, FanAroundAPointCoversEverySampleOnce) {
  // Odd angles, no overlap: the alphas of the separate triangles add up to the square's.
  const std::vector<Vec2> points = {{31.3, 27.7}, {0, 0}, {64, 0}, {64, 64}, {0, 64}, {17.2, 0}, {64, 41.9}};
  const std::vector<std::array<Index, 3>> fan = {{0, 1, 5}, {0, 5, 2}, {0, 2, 6}, {6, 3, 0}, {0, 3, 4}, {4, 1, 0}};
  std::vector<int> alpha(64 * 64, 0);
  for (std::size_t t = 0; t < fan.size(); ++t) {
    Painting painting;
    painting.points = points;
    painting.triangles = std::span(fan).subspan(t, 1);
    const Image image = paint(64, 64, painting);
    for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] += int((4 * (image.pixels[i] >> 24) + 128) / 255);
  }
  for (const int samples : alpha) ASSERT_EQ(samples, 4);
}

TEST(Raster, ValuesAreLinear) {
  const std::vector<Vec2> points = {{0, 0}, {512, 0}, {0, 512}};
  const Eigen::Matrix3Xd values = Eigen::Vector3d(0, 2, 0);  // x / 256: the scale ends half way
  Painting painting;
  painting.points = points;
  painting.triangles = one;
  painting.values = &values;
  painting.limits = {0, 1, 0, 2};
  const Image image = paint(512, 512, painting);
  const Colors& table = colors(Scale::Linear);
  for (int i = 0; i < 256; ++i) EXPECT_EQ(pixel(image, i, 3), table[std::size_t(i)]) << i;
  EXPECT_EQ(pixel(image, 400, 3), table[255]);
}

TEST(Raster, TrianglesThatCannotBeDrawnAreLeftOut) {
  for (const Vec2& bad : {Vec2(infinity, 3), Vec2(std::nan(""), 3)}) {
    const std::vector<Vec2> points = {{0, 0}, {8, 0}, bad};
    Painting painting;
    painting.points = points;
    painting.triangles = one;
    for (const std::uint32_t p : paint(8, 8, painting).pixels) EXPECT_EQ(p, 0u);
  }
  const std::vector<Vec2> far = {{-1e300, -1e300}, {1e300, -1e300}, {0, 1e300}};
  Painting painting;
  painting.points = far;
  painting.triangles = one;
  EXPECT_EQ(paint(8, 8, painting).pixels.size(), 64u);
}

TEST(Raster, EdgesDarkenTheirTriangles) {
  const std::vector<Vec2> points = {{2, 2}, {62, 2}, {2, 62}};
  Painting painting;
  painting.points = points;
  painting.triangles = one;
  painting.edge_width = 2;
  const Image image = paint(64, 64, painting);
  EXPECT_EQ(pixel(image, 2, 20), painting.edge);
  EXPECT_EQ(pixel(image, 20, 20), painting.plain);
}

}  // namespace
}  // namespace kerf::raster_test
