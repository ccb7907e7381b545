// Triangles with linear values as pixels. Every pixel has 2 x 2 samples, and a sample belongs to the triangle that its
// center lies in: a scan line per row of samples, from the left side to the right one, a center on a side belonging to
// the right triangle. Neighbors compute the crossing with their common side from the same two ends in the same order
// (the upper first), so that there are no gaps between them and no sample is painted twice. The value is
//   step(x, y) = origin + gx x + gy y   in steps of the color table, clamped to the values of the corners,
// because of a nearly flat triangle the gradient is rounding. The picture is made in bands of 64 rows of pixels. Lines
// of the mesh have the width asked for, but no more than a share of the triangle's size; triangles of a few pixels turn
// into an even gray instead of black.

#include "plot/figure/raster.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int per_pixel = 2;  // samples per pixel, each way
constexpr int rows_of_band = 64 * per_pixel;

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
  double half_width, fade, inward;      // inward: the sign of distances inside

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
    const double turned = cross(c[1].x - c[0].x, c[2].x - c[0].x), doubled = std::abs(turned);
    inward = turned > 0 ? -1 : 1;
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
    return fade * line + between();
  }
  /// The same where no line is near.
  double between() const {
    return (1 - fade) * 0.42;
  }
  /// Samples of first..last in which no line is near, for certain.
  std::array<int, 2> free(int first, int last, double y) const {
    double from = first, to = last;
    const double away = half_width + 0.5;
    for (const Eigen::Vector3d& s : side) {
      // inward (a x + b) >= away
      const double a = inward * s[0], b = inward * (s[1] * y + s[2]);
      if (a > 0)
        from = std::max(from, (away - b) / a + 1);
      else if (a < 0)
        to = std::min(to, (away - b) / a - 1);
      else if (b < away + 1)
        to = from;
    }
    const int begin = static_cast<int>(std::clamp(std::ceil(from), double(first), double(last)));
    return {begin, static_cast<int>(std::clamp(std::floor(to), double(begin), double(last)))};
  }
};

/// Rows of samples from `top` on: a band of the picture, which stays in the cache.
struct Canvas {
  int width, height;  // in samples, of the whole picture
  int top = 0, bottom = 0;
  std::vector<std::uint32_t> samples = {};

  std::uint32_t* row(int j) {
    return samples.data() + static_cast<std::size_t>(j - top) * static_cast<std::size_t>(width);
  }
};

/// color(row, first, last, y) colors the samples of a row.
template <typename Color>
void fill(Canvas& canvas, const std::array<Corner, 3>& corners, const Color& color) {
  std::array<Vec2, 3> p = {corners[0].x, corners[1].x, corners[2].x};
  const auto upper = [](const Vec2& a, const Vec2& b) { return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x(); };
  std::sort(p.begin(), p.end(), upper);
  const int bottom = std::min(canvas.bottom, first_sample(p[2].y(), canvas.height));
  for (int j = std::max(canvas.top, first_sample(p[0].y(), canvas.height)); j < bottom; ++j) {
    const double y = j + 0.5;
    double left = across(p[0], p[2], y);
    double right = y < p[1].y() ? across(p[0], p[1], y) : across(p[1], p[2], y);
    if (left > right) std::swap(left, right);
    color(canvas.row(j), first_sample(left, canvas.width), first_sample(right, canvas.width), y);
  }
}

/// Pixels of a band.
void average(Canvas& canvas, Image& image) {
  std::size_t out = static_cast<std::size_t>(canvas.top / per_pixel) * static_cast<std::size_t>(image.width);
  for (int j = canvas.top; j < canvas.bottom; j += per_pixel) {
    const std::uint32_t* a = canvas.row(j);
    const std::uint32_t* b = a + canvas.width;
    // Two of the four channels at a time, each in 16 bits: (sum + 2)/4 < 256.
    constexpr std::uint32_t two = 0x00ff00ff, half = 0x00020002;
    for (int i = 0; i < image.width; ++i, a += 2, b += 2) {
      const std::uint32_t even = (a[0] & two) + (a[1] & two) + (b[0] & two) + (b[1] & two) + half;
      const std::uint32_t odd = (a[0] >> 8 & two) + (a[1] >> 8 & two) + (b[0] >> 8 & two) + (b[1] >> 8 & two) + half;
      image.pixels[out++] = (even >> 2 & two) | (odd >> 2 & two) << 8;
    }
  }
}

/// One triangle on a band of the canvas.
void paint_triangle(Canvas& canvas, const Painting& painting, const Colors& table, std::size_t t) {
  const bool valued = painting.values && painting.values->cols() > 0;
  const double low = painting.limits.low, per_step = 256 / (painting.limits.high - low);
  std::array<Corner, 3> c;
  bool finite = true;
  for (std::size_t k = 0; k < 3; ++k) {
    c[k].x = per_pixel * painting.points[static_cast<std::size_t>(painting.triangles[t][k])];
    const double value = valued ? (*painting.values)(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) : 0;
    finite = finite && std::isfinite(value);
    c[k].step = std::clamp((value - low) * per_step, -1e9, 1e9);
  }
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
  const bool all_known = finite && !(painting.margin && painting.margin->cols() > 0);
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
  const auto plain = [&](std::uint32_t* row, int first, int last, double y) {
    if (all_known && !valued)
      std::fill(row + first, row + last, painting.plain);
    else if (all_known)
      for (int i = first; i < last; ++i)
        row[i] = table[static_cast<std::size_t>(
            static_cast<int>(std::clamp(origin + gx * (i + 0.5) + gy * y, floor, ceiling)))];
    else
      for (int i = first; i < last; ++i) row[i] = value_color(i + 0.5, y);
  };
  if (!(painting.edge_width > 0)) return fill(canvas, c, plain);
  const Wire wire(c, per_pixel * painting.edge_width);
  const auto lined = [&](std::uint32_t* row, int first, int last, double y) {
    for (int i = first; i < last; ++i) {
      const double x = i + 0.5;
      row[i] = mix(value_color(x, y), painting.edge, wire.cover(x, y));
    }
  };
  const double between = wire.between();
  fill(canvas, c, [&](std::uint32_t* row, int first, int last, double y) {
    const auto [from, to] = wire.free(first, last, y);
    lined(row, first, from, y);
    if (between == 0)
      plain(row, from, to, y);
    else
      for (int i = from; i < to; ++i) row[i] = mix(value_color(i + 0.5, y), painting.edge, between);
    lined(row, to, last, y);
  });
}

/// Of every band the triangles that may have samples in it, in their order.
std::vector<std::vector<Index>> bands_of(const Painting& painting, int height) {
  std::vector<std::vector<Index>> bands(static_cast<std::size_t>((height + rows_of_band - 1) / rows_of_band));
  for (std::size_t t = 0; t < painting.triangles.size(); ++t) {
    double low = infinity, high = -infinity;
    bool drawable = true;
    for (const Index v : painting.triangles[t]) {
      const Vec2& x = painting.points[static_cast<std::size_t>(v)];
      drawable = drawable && x.allFinite();
      low = std::min(low, per_pixel * x.y());
      high = std::max(high, per_pixel * x.y());
    }
    if (!drawable) continue;
    const int first = first_sample(low, height), last = first_sample(high, height);
    for (int b = first / rows_of_band; b * rows_of_band < last; ++b)
      bands[static_cast<std::size_t>(b)].push_back(static_cast<Index>(t));
  }
  return bands;
}

}  // namespace

Image paint(int width, int height, const Painting& painting) {
  static_assert(per_pixel == 2, "average() knows four samples");
  Image image{width, height, {}};
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  Canvas canvas{per_pixel * width, per_pixel * height};
  const Colors& table = colors(painting.scale);
  for (const std::vector<Index>& band : bands_of(painting, canvas.height)) {
    canvas.bottom = std::min(canvas.height, canvas.top + rows_of_band);
    canvas.samples.assign(static_cast<std::size_t>(canvas.bottom - canvas.top) * static_cast<std::size_t>(canvas.width),
                          0);
    for (const Index t : band) paint_triangle(canvas, painting, table, static_cast<std::size_t>(t));
    average(canvas, image);
    canvas.top = canvas.bottom;
  }
  return image;
}

}  // namespace kerf
