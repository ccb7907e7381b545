// Pictures read back by Cairo: colors where they belong, nothing cut at the border.

#include "plot/picture.hpp"

#include "io/files.hpp"
#include "plot/figure/colors.hpp"
#include "tests/support/sample.hpp"

#include <cairo.h>

#include <set>

// Asked by the leak sanitizer, if there is one: fontconfig keeps its caches to the end, and they do not grow.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig";
}

namespace kerf::picture_test {
namespace {

using test::Folder;
using test::grid;

struct Png {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  // 0xRRGGBB

  explicit Png(const std::filesystem::path& path) {
    cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
    EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS) << path;
    width = cairo_image_surface_get_width(surface);
    height = cairo_image_surface_get_height(surface);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int j = 0; j < height; ++j) {
      const auto* row = reinterpret_cast<const std::uint32_t*>(data + std::ptrdiff_t(j) * stride);
      for (int i = 0; i < width; ++i) pixels.push_back(row[i] & 0xffffff);
    }
    cairo_surface_destroy(surface);
  }
  std::uint32_t at(int i, int j) const {
    return pixels[std::size_t(j) * std::size_t(width) + std::size_t(i)];
  }
  int drawn(int x0, int y0, int x1, int y1) const {
    int count = 0;
    for (int j = y0; j < y1; ++j) {
      for (int i = x0; i < x1; ++i) count += at(i, j) != 0xffffff;
    }
    return count;
  }
  long count(std::uint32_t color) const {
    return std::count(pixels.begin(), pixels.end(), color & 0xffffff);
  }
};

/// Nothing is cut: a rim of some pixels stays white.
void expect_white_rim(const Png& png) {
  const int rim = 6;
  EXPECT_EQ(png.drawn(0, 0, png.width, rim), 0) << "top";
  EXPECT_EQ(png.drawn(0, png.height - rim, png.width, png.height), 0) << "bottom";
  EXPECT_EQ(png.drawn(0, 0, rim, png.height), 0) << "left";
  EXPECT_EQ(png.drawn(png.width - rim, 0, png.width, png.height), 0) << "right";
}

Png drawn(const Picture& picture) {
  const Folder folder;
  const auto path = folder.path / "a.png";
  draw(path, picture);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "a.png.part"));
  return Png(path);
}

struct Shape {
  const char* name;
  Vec2 low, high;
  double value_scale;
  bool long_text;
};

class AnyShape : public testing::TestWithParam<Shape> {};

TEST_P(AnyShape, NothingIsCut) {
  const Shape& s = GetParam();
  for (const Scale scale : {Scale::Linear, Scale::Diverging}) {
    Picture picture = grid(s.low, s.high, 12, 12, [&](const Vec2& p) {
      const Vec2 t = (p - s.low).cwiseQuotient(s.high - s.low);
      // A spike in one corner and a pit in the opposite one: both ends of the color bar get their points.
      return s.value_scale * (t.x() - t.y() + (t.norm() < 1e-9 ? 100 : 0) - (t.norm() > 1.41 ? 100 : 0));
    });
    picture.scale = scale;
    picture.clip = 0.02;
    picture.title = "Title";
    picture.subtitle = "subtitle";
    picture.value_label = "value";
    if (s.long_text) {
      for (int i = 0; i < 30; ++i) {
        picture.title += " and one more word";
        picture.subtitle += "withoutanyblankinit";
        picture.value_label += " still longer";
      }
    }
    for (int i = 0; i < 9; ++i) {
      const Vec2 t(i % 3 / 2.0, i / 3 / 2.0);
      picture.marks.emplace_back(s.low + t.cwiseProduct(s.high - s.low), "mark number " + std::to_string(i));
    }
    picture.cracks = {{s.low, s.high}};
    const Png png = drawn(picture);
    EXPECT_GE(png.width, 600);
    EXPECT_LE(png.width, 1640);
    EXPECT_GE(png.height, 200);
    EXPECT_LE(png.height, 2400);
    expect_white_rim(png);
    EXPECT_GT(png.drawn(30, 30, png.width - 30, 80), 200) << "no title";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, AnyShape,
    testing::Values(Shape{"square", {0, 0}, {1, 1}, 1, false}, Shape{"strip", {0, 0}, {10, 1}, 1e7, false},
                    Shape{"column", {0, 0}, {1, 10}, 1e-9, false}, Shape{"needle", {0, 0}, {1e4, 1}, 1e200, false},
                    Shape{"thread", {0, 0}, {1, 1e4}, 1e-200, false},
                    Shape{"far", {1e7, -1e7}, {1e7 + 1, 1 - 1e7}, 1, false},
                    Shape{"tiny", {-1e-7, -1e-7}, {1e-7, 1e-7}, 123456, false},
                    Shape{"huge", {-1e12, 0}, {1e12, 1e12}, 1e-3, false},
                    Shape{"wordy_square", {0, 0}, {1, 1}, 1, true}, Shape{"wordy_strip", {0, 0}, {20, 1}, 1, true},
                    Shape{"wordy_column", {0, 0}, {1, 20}, 1, true}),
    [](const auto& info) { return info.param.name; });

TEST(Picture, LinearFieldRunsFromTheFirstColorToTheLast) {
  Picture picture = grid({0, 0}, {1, 1}, 20, 20, [](const Vec2& p) { return 7 + 3 * p.x(); });
  const Png png = drawn(picture);
  const Colors& table = colors(Scale::Linear);
  // The row through the middle of the body: colors of the table in order, first and last among them.
  const int middle = png.height / 2;
  int left = -1, right = -1;
  for (int i = 0; i < png.width; ++i) {
    if (png.at(i, middle) == (table.front() & 0xffffff) && left < 0) left = i;
    if (png.at(i, middle) == (table.back() & 0xffffff)) right = std::max(right, i);
  }
  ASSERT_GE(left, 0);
  ASSERT_GT(right, left + 800);
  std::vector<std::uint32_t> order;
  for (int i = left; i <= right; ++i) {
    if (order.empty() || order.back() != png.at(i, middle)) order.push_back(png.at(i, middle));
  }
  std::size_t next = 0;
  for (const std::uint32_t color : table) {
    const auto found = std::find(order.begin() + std::ptrdiff_t(next), order.end(), color & 0xffffff);
    ASSERT_NE(found, order.end()) << "a color of the table is missing";
    next = std::size_t(found - order.begin());
  }
  // Halfway across the body lies the middle of the table.
  const auto halfway = png.at((left + right) / 2, middle);
  const auto place = std::find(table.begin(), table.end(), halfway | 0xff000000) - table.begin();
  EXPECT_NEAR(double(place), 127.5, 2);
}

TEST(Picture, BodyOfAnyOrientationIsFilledWithoutHoles) {
  Picture picture = grid({0, 0}, {1, 1}, 37, 29, [](const Vec2&) { return 1.0; });
  for (std::size_t t = 0; t < picture.triangles.size(); t += 2)
    std::swap(picture.triangles[t][0], picture.triangles[t][1]);
  const Png png = drawn(picture);
  const std::uint32_t color = colors(Scale::Linear)[128] & 0xffffff;
  const int x = png.width / 2, y = png.height / 2;  // somewhere in the body
  int top = y, bottom = y, left = x, right = x;
  while (png.at(x, top - 1) == color) --top;
  while (png.at(x, bottom + 1) == color) ++bottom;
  while (png.at(left - 1, y) == color) --left;
  while (png.at(right + 1, y) == color) ++right;
  ASSERT_GT(right - left, 800);
  EXPECT_NEAR(right - left, bottom - top, 1) << "equal scales";
  for (int j = top; j <= bottom; ++j) {
    for (int i = left; i <= right; ++i) ASSERT_EQ(png.at(i, j), color) << i << ' ' << j;
  }
}

TEST(Picture, NotFiniteIsGray) {
  const Png png = drawn(grid({0, 0}, {1, 1}, 10, 10, [](const Vec2& p) {
    if (p.x() < 0.35) return std::nan("");
    return p.x() > 0.75 ? infinity : p.y();
  }));
  EXPECT_GT(png.count(not_finite_color), png.width * png.height / 4);
  const Png nothing_finite = drawn(grid({0, 0}, {1, 1}, 3, 3, [](const Vec2&) { return std::nan(""); }));
  EXPECT_GT(nothing_finite.count(not_finite_color), nothing_finite.width * nothing_finite.height / 3);
  expect_white_rim(nothing_finite);
}

TEST(Picture, CracksAreBlackAndBeyondTheLimitsBarHasPoints) {
  Picture picture = grid({-1, -1}, {1, 1}, 60, 60, [](const Vec2& p) { return 1 / (p.norm() + 1e-6); });
  const Png plain = drawn(picture);
  picture.cracks = {{{-0.5, 0}, {0.5, 0}}};
  const Png cracked = drawn(picture);
  EXPECT_GT(cracked.count(0x000000), plain.count(0x000000) + 1000);
}

TEST(Picture, MeshAloneShowsItsEdges) {
  Picture picture = grid({0, 0}, {1, 1}, 8, 8, [](const Vec2&) { return 0.0; });
  picture.values.resize(3, 0);
  const Png png = drawn(picture);
  std::set<std::uint32_t> seen(png.pixels.begin(), png.pixels.end());
  EXPECT_TRUE(seen.count(0xe9eef5)) << "the body";
  EXPECT_GT(png.count(0xe9eef5), png.width * png.height / 3);
  EXPECT_LT(png.count(0xe9eef5), png.width * png.height * 8 / 10);
  expect_white_rim(png);
}

TEST(Picture, EmptyAndDegenerateInputsAreDrawn) {
  Picture empty;
  expect_white_rim(drawn(empty));
  empty.title = "Nothing\nhere \xff\xfe";  // a line end, and bytes that are no text
  expect_white_rim(drawn(empty));
  Picture crack;
  crack.cracks = {{{0, 0}, {1, 0}}, {}, {{2, 2}}};
  expect_white_rim(drawn(crack));
  Picture point;
  point.points = {{3, 3}, {3, 3}, {3, 3}};
  point.triangles = {{0, 1, 2}};
  point.values = Eigen::Matrix3Xd::Zero(3, 1);
  expect_white_rim(drawn(point));
  Picture wild = grid({0, 0}, {1, 1}, 4, 4, [](const Vec2& p) { return p.x() * 1e300; });
  wild.points[7] = {infinity, std::nan("")};
  wild.outlines = {{{0, 0}, {infinity, 0}, {1, 1}}};
  wild.marks = {{{std::nan(""), 0}, "nowhere"}, {{50, 50}, "far outside"}};
  expect_white_rim(drawn(wild));
}

TEST(Picture, SameInputSameBytes) {
  const Folder folder;
  const Picture picture = grid({0, 0}, {2, 1}, 9, 9, [](const Vec2& p) { return p.x() * p.y(); });
  draw(folder.path / "a.png", picture);
  draw(folder.path / "b.png", picture);
  EXPECT_EQ(read_file(folder.path / "a.png"), read_file(folder.path / "b.png"));
}

TEST(Picture, ErrorsNameThePathOrTheMistake) {
  const Folder folder;
  const auto path = folder.path / "missing" / "a.png";
  try {
    draw(path, Picture{});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Files);
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
  }
  Picture wrong = grid({0, 0}, {1, 1}, 1, 1, [](const Vec2&) { return 0.0; });
  wrong.values.resize(3, 1);
  EXPECT_THROW(draw(folder.path / "a.png", wrong), std::invalid_argument);
}

}  // namespace
}  // namespace kerf::picture_test
