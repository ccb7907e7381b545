#pragma once
// Triangles to pixels: linear values, colors looked up per sample, four samples per pixel.

#include "plot/figure/colors.hpp"

namespace kerf {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  // row by row from the top; 0xAARRGGBB, colors premultiplied by alpha
};

struct Painting {
  std::span<const Vec2> points;  // in pixels, y downwards, pixel (0, 0) covers [0, 1] x [0, 1]
  std::span<const std::array<Index, 3>> triangles;
  const Eigen::Matrix3Xd* values = nullptr;  // absent or without columns: `plain`
  const Eigen::Matrix3Xd* margin = nullptr;  // gray where it is negative
  Limits limits;
  Scale scale = Scale::Linear;
  std::uint32_t plain = 0xffe9eef5;
  double edge_width = 0;  // in pixels; less where triangles are small, so that the picture does not go black
  std::uint32_t edge = 0xff40566b;
};

/// Transparent where there is no triangle. A sample on a shared edge belongs to exactly one triangle; the orientation
/// of triangles does not matter; triangles with a point that is not finite are left out.
Image paint(int width, int height, const Painting& painting);

}  // namespace kerf
