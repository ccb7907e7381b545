// Charts read back by Cairo, and the marks of logarithmic axes.

#include "plot/chart.hpp"

#include "io/files.hpp"
#include "plot/figure/ticks.hpp"
#include "tests/support/sample.hpp"

#include <cairo.h>

#include <algorithm>

namespace kerf::chart_test {
namespace {

using test::Folder;

/// Pixels of one color in the picture of a chart.
long drawn(const Chart& chart, std::uint32_t rgb) {
  const Folder folder;
  const auto path = folder.path / "chart.png";
  draw(path, chart);
  cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
  EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
  const int width = cairo_image_surface_get_width(surface), height = cairo_image_surface_get_height(surface);
  long count = 0;
  for (int j = 0; j < height; ++j) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(
        cairo_image_surface_get_data(surface) + std::ptrdiff_t(j) * cairo_image_surface_get_stride(surface));
    count += std::count_if(row, row + width, [rgb](std::uint32_t p) { return (p & 0xffffff) == rgb; });
  }
  cairo_surface_destroy(surface);
  return count;
}

constexpr std::uint32_t blue = 0x0072b2;

Chart falling() {
  return {.title = "Speed",
          .x_label = "seconds",
          .y_label = "error",
          .series = {{"a", {{0.01, 0.1}, {0.1, 0.01}, {1, 0.001}}}},
          .slopes = {{-1, "slope −1"}}};
}

TEST(Chart, DrawsTheLineOfASeriesInItsColor) {
  EXPECT_GT(drawn(falling(), blue), 2000);
  Chart none = falling();
  none.series.clear();
  EXPECT_EQ(drawn(none, blue), 0);
}

TEST(Chart, LeavesOutWhatHasNoLogarithm) {
  Chart chart = falling();
  chart.series[0].points.insert(chart.series[0].points.begin() + 1,
                                {{0, 1}, {-1, 1}, {1, 0}, {1, -1}, {nan, 1}, {1, nan}, {1 / 0.0, 1}});
  EXPECT_EQ(drawn(chart, blue), drawn(falling(), blue));
}

TEST(Chart, DrawsNothingButTheFrameWithoutPoints) {
  Chart chart = falling();
  chart.series[0].points = {{0, 0}};
  EXPECT_EQ(drawn(chart, blue), 0);
}

TEST(Chart, TakesASinglePoint) {
  Chart chart = falling();
  chart.series[0].points.resize(1);
  EXPECT_GT(drawn(chart, blue), 50);
}

TEST(Chart, HasALinearAxisForValues) {
  Chart chart = falling();
  chart.series[0].points = {{0.1, -2}, {1, 0}, {10, 3}};
  EXPECT_LT(drawn(chart, blue), drawn(falling(), blue));  // a single point has a logarithm
  chart.linear_y = true;
  const long marked = drawn(chart, blue);
  EXPECT_GT(marked, 2000);
  chart.series[0].marked_at_end = true;
  EXPECT_LT(drawn(chart, blue), marked);
}

TEST(Chart, NamesTheFileThatCannotBeWritten) {
  try {
    draw("/no/such/folder/chart.png", falling());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Files);
    EXPECT_NE(std::string(e.what()).find("/no/such/folder/chart.png"), std::string::npos);
  }
}

TEST(LogTicks, StandAtDecades) {
  const LogTicks t = log_ticks(2e-3, 30, 9);
  ASSERT_EQ(t.major.at.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(t.major.at[i], std::pow(10, double(i) - 2));
  EXPECT_EQ(t.major.labels, (std::vector<std::string>{"10⁻²", "10⁻¹", "10⁰", "10¹"}));
  EXPECT_EQ(t.minor.size(), 8u + 8 + 8 + 8 + 2);
  EXPECT_DOUBLE_EQ(t.minor.front(), 2e-3);
  EXPECT_DOUBLE_EQ(t.minor.back(), 30);
}

TEST(LogTicks, AreEverySoManyDecadesOnALongAxis) {
  const LogTicks t = log_ticks(1e-16, 1, 9);
  EXPECT_EQ(t.major.labels,
            (std::vector<std::string>{"10⁻¹⁶", "10⁻¹⁴", "10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"}));
  EXPECT_EQ(t.minor.size(), 8u);
}

TEST(LogTicks, NameTwoAndFiveOnAShortAxis) {
  EXPECT_EQ(log_ticks(0.15, 0.9, 9).major.labels, (std::vector<std::string>{"2×10⁻¹", "5×10⁻¹"}));
  EXPECT_EQ(log_ticks(0.4, 2.5, 9).major.labels, (std::vector<std::string>{"5×10⁻¹", "10⁰", "2×10⁰"}));
}

}  // namespace
}  // namespace kerf::chart_test
