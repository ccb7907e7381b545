// Triangles with linear values as pixels. Every pixel has 2 x 2 samples, and a sample belongs to the triangle that its
// center lies in: a scan line per row of samples, from the left side to the right one, a center on a side belonging to
// the right triangle. Neighbors compute the crossing with their common side from the same two ends in the same order
// (the upper first), so that there are no gaps between them and no sample is painted twice. The value is
//   step(x, y) = origin + gx x + gy y   in steps of the color table, clamped to the values of the corners,
// because of a nearly flat triangle the gradient is rounding. Lines of the mesh have the width asked for, but no more
// than a share of the triangle's size; triangles of a few pixels turn into an even gray instead of black.

#include "plot/figure/raster.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int per_pixel = 2;  // samples per pixel, each way

struct Corner {
  Vec2 x;
  double step;  // value as a step of the color table
};

/// x of the line a-b at height y. Neighbors compute the same bits because a is always the upper end.
double across(const Vec2& a, const Vec2& b, double y) {
  return a.x() + (y - a.y()) * ((b.x() - a.x()) / (b.y() - a.y()));
}

/// First sample whose center is not left of x.
int first_sample(double x, int count) {
  return static_cast<int>(std::clamp(std::ceil(x - 0.5), 0.0, double(count)));
}

std::uint32_t mix(std::uint32_t a, std::uint32_t b, double share_of_b) {
  const auto weight = static_cast<std::uint32_t>(std::lround(256 * share_of_b));
  std::uint32_t out = 0xff000000;
  for (const int shift : {0, 8, 16}) {
    out |= ((a >> shift & 255) * (256 - weight) + (b >> shift & 255) * weight) >> 8 << shift;
  }
  return out;
}

/// Signed distances to the three sides as functions of the sample, and how wide to draw them.
struct Wire {
  std::array<Eigen::Vector3d, 3> side;  // distance = side . (x, y, 1)
  double half_width, fade;

  Wire(const std::array<Corner, 3>& c, double width) {
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = c[k].x, d = c[(k + 1) % 3].x - a;
      const double length = d.norm();
      longest = std::max(longest, length);
      const Vec2 n = length > 0 ? Vec2(Vec2(d.y(), -d.x()) / length) : Vec2::Zero();
      side[k] = {n.x(), n.y(), -n.dot(a)};
    }
    // Side of the equilateral triangle with the same smallest height.
    const double doubled = std::abs(cross(c[1].x - c[0].x, c[2].x - c[0].x));
    const double size = longest > 0 ? 1.1547 * doubled / longest : 0;
    half_width = 0.5 * std::min(width, 0.11 * size);
    fade = std::clamp((size - 3) / 5, 0.0, 1.0);  // smaller triangles turn into an even gray
  }

  /// Share of the sample that the lines cover.
  double cover(double x, double y) const {
    const Eigen::Vector3d at(x, y, 1);
    double d = std::abs(side[0].dot(at));
    d = std::min(d, std::abs(side[1].dot(at)));
    d = std::min(d, std::abs(side[2].dot(at)));
    const double line = std::max(0.0, std::min(d + 0.5, half_width) - std::max(d - 0.5, -half_width));
    return fade * line + (1 - fade) * 0.42;
  }
};

struct Canvas {
  int width, height;  // in samples
  std::vector<std::uint32_t> samples;
};

template <typename Color>
void fill(Canvas& canvas, const std::array<Corner, 3>& corners, const Color& color) {
  std::array<Vec2, 3> p = {corners[0].x, corners[1].x, corners[2].x};
  const auto upper = [](const Vec2& a, const Vec2& b) { return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x(); };
  std::sort(p.begin(), p.end(), upper);
  const int bottom = first_sample(p[2].y(), canvas.height);
  for (int j = first_sample(p[0].y(), canvas.height); j < bottom; ++j) {
    const double y = j + 0.5;
    double left = across(p[0], p[2], y);
    double right = y < p[1].y() ? across(p[0], p[1], y) : across(p[1], p[2], y);
    if (left > right) std::swap(left, right);
    const int last = first_sample(right, canvas.width);
    std::uint32_t* row = canvas.samples.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(canvas.width);
    for (int i = first_sample(left, canvas.width); i < last; ++i) row[i] = color(i + 0.5, y);
  }
}

Image average(const Canvas& canvas) {
  Image image{canvas.width / per_pixel, canvas.height / per_pixel, {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::size_t out = 0;
  for (int j = 0; j < image.height; ++j) {
    const std::uint32_t* a = canvas.samples.data() + static_cast<std::size_t>(2 * j) * std::size_t(canvas.width);
    const std::uint32_t* b = a + canvas.width;
    for (int i = 0; i < image.width; ++i, a += 2, b += 2) {
      std::uint32_t pixel = 0;
      for (const int shift : {0, 8, 16, 24}) {
        const std::uint32_t sum =
            (a[0] >> shift & 255) + (a[1] >> shift & 255) + (b[0] >> shift & 255) + (b[1] >> shift & 255);
        pixel |= (sum + 2) / 4 << shift;
      }
      image.pixels[out++] = pixel;
    }
  }
  return image;
}

}  // namespace

Image paint(int width, int height, const Painting& painting) {
  static_assert(per_pixel == 2, "average() knows four samples");
  Canvas canvas{per_pixel * width, per_pixel * height, {}};
  canvas.samples.assign(static_cast<std::size_t>(canvas.width) * static_cast<std::size_t>(canvas.height), 0);
  const Colors& table = colors(painting.scale);
  const bool valued = painting.values && painting.values->cols() > 0;
  const double low = painting.limits.low, per_step = 256 / (painting.limits.high - low);

  for (std::size_t t = 0; t < painting.triangles.size(); ++t) {
    std::array<Corner, 3> c;
    bool drawable = true, finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      c[k].x = per_pixel * painting.points[static_cast<std::size_t>(painting.triangles[t][k])];
      drawable = drawable && c[k].x.allFinite();
      const double value = valued ? (*painting.values)(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) : 0;
      finite = finite && std::isfinite(value);
      c[k].step = std::clamp((value - low) * per_step, -1e9, 1e9);
    }
    if (!drawable) continue;

    // step(x, y) is linear; between the corners' values and within the table whatever rounding does.
    const Vec2 e1 = c[1].x - c[0].x, e2 = c[2].x - c[0].x;
    const double area = cross(e1, e2), d1 = c[1].step - c[0].step, d2 = c[2].step - c[0].step;
    const bool sliver = !(std::abs(area) > 1e-12);
    const double gx = sliver ? 0 : (d1 * e2.y() - d2 * e1.y()) / area;
    const double gy = sliver ? 0 : (d2 * e1.x() - d1 * e2.x()) / area;
    const double origin = c[0].step - gx * c[0].x.x() - gy * c[0].x.y();
    const auto [least, most] = std::minmax({c[0].step, c[1].step, c[2].step});
    const double floor = std::clamp(least, 0.0, 255.0), ceiling = std::clamp(most, 0.0, 255.0);
    double mx = 0, my = 0, margin = 1;
    if (painting.margin && painting.margin->cols() > 0) {
      const Eigen::Vector3d at = painting.margin->col(static_cast<Eigen::Index>(t));
      mx = sliver ? 0 : ((at[1] - at[0]) * e2.y() - (at[2] - at[0]) * e1.y()) / area;
      my = sliver ? 0 : ((at[2] - at[0]) * e1.x() - (at[1] - at[0]) * e2.x()) / area;
      margin = at[0] - mx * c[0].x.x() - my * c[0].x.y();
    }
    const auto value_color = [&](double x, double y) {
      if (!finite || margin + mx * x + my * y < 0) return not_finite_color;
      if (!valued) return painting.plain;
      return table[static_cast<std::size_t>(std::clamp(origin + gx * x + gy * y, floor, ceiling))];
    };
    if (painting.edge_width > 0) {
      const Wire wire(c, per_pixel * painting.edge_width);
      fill(canvas, c, [&](double x, double y) { return mix(value_color(x, y), painting.edge, wire.cover(x, y)); });
    } else {
      fill(canvas, c, value_color);
    }
  }
  return average(canvas);
}

}  // namespace kerf
