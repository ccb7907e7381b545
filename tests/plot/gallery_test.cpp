// Bodies side by side, bars and small multiples, read back by Cairo.

#include "plot/gallery.hpp"

#include "plot/bars.hpp"
#include "plot/multiples.hpp"
#include "tests/support/sample.hpp"

#include <cairo.h>

#include <algorithm>

namespace kerf::gallery_test {
namespace {

using test::Folder;

/// Pixels of one color, and the height of the page.
struct Seen {
  long pixels = 0;
  int height = 0;
};

template <typename Drawing>
Seen look(const Drawing& drawing, std::uint32_t rgb) {
  const Folder folder;
  const auto path = folder.path / "drawing.png";
  draw(path, drawing);
  cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
  EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
  const int width = cairo_image_surface_get_width(surface);
  Seen seen{.height = cairo_image_surface_get_height(surface)};
  for (int j = 0; j < seen.height; ++j) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(
        cairo_image_surface_get_data(surface) + std::ptrdiff_t(j) * cairo_image_surface_get_stride(surface));
    seen.pixels += std::count_if(row, row + width, [rgb](std::uint32_t p) { return (p & 0xffffff) == rgb; });
  }
  cairo_surface_destroy(surface);
  return seen;
}

constexpr std::uint32_t own = 0x1f5a8a, other = 0x6b747d, blue = 0x0072b2;

Polyline square(double low, double high) {
  return {{low, low}, {high, low}, {high, high}, {low, high}};
}

GalleryPanel panel() {
  return {.title = "a",
          .caption = "1",
          .body = {square(0, 1), square(0.25, 0.75)},
          .frame = {square(0, 1)},
          .accent = true};
}

TEST(Gallery, FillsABodyButNotItsHoles) {
  const Gallery g{.title = "Bodies", .rows = {{.title = "row", .panels = {panel()}}}};
  const double whole = 205.0 * 205.0;
  EXPECT_NEAR(look(g, own).pixels, 0.75 * whole, 0.03 * whole);
  EXPECT_EQ(look(g, other).pixels, 0);
}

TEST(Gallery, ScalesItsRows) {
  Gallery g{.title = "Bodies",
            .rows = {{.title = "row", .panels = {panel()}}, {.title = "row", .panels = {panel()}, .scale = 2}}};
  const double whole = 205.0 * 205.0;
  EXPECT_NEAR(look(g, own).pixels, 0.75 * 5 * whole, 0.1 * whole);
}

TEST(Gallery, BreaksLines) {
  Gallery one{.title = "Bodies", .rows = {{.title = "row", .panels = {panel()}}}}, many = one;
  many.rows[0].panels.assign(12, panel());
  EXPECT_GT(look(many, own).height, look(one, own).height + 400);
  EXPECT_GT(look(Gallery{.title = "nothing"}, own).height, 0);
  many.rows[0].panels[0].body.clear();
  many.rows[0].panels[0].frame.clear();
  EXPECT_NEAR(look(many, own).pixels, 11 * 0.75 * 205 * 205, 0.05 * 11 * 205 * 205);
}

TEST(Bars, AreAsLongAsTheirValues) {
  BarChart chart{.title = "Bars", .x_label = "x", .groups = {{"g", {{.name = "a", .value = 2, .text = "2"}}}}};
  const long two = look(chart, blue).pixels;
  chart.groups[0].bars.push_back({.name = "b", .value = 1, .text = "1"});
  EXPECT_NEAR(static_cast<double>(look(chart, blue).pixels), 1.5 * static_cast<double>(two), 0.02 * two);
  chart.groups[0].bars[1].value = nan;
  EXPECT_EQ(look(chart, blue).pixels, two);
  chart.groups.clear();
  EXPECT_EQ(look(chart, blue).pixels, 0);
}

TEST(Gallery, NamesTheFileThatCannotBeWritten) {
  EXPECT_THROW(draw("/nowhere/a.png", Gallery{}), Error);
  EXPECT_THROW(draw("/nowhere/a.png", BarChart{}), Error);
}

// A panel with a point of each kind.
TEST(Multiples, MarkWhatBecameOfAValue) {
  constexpr std::uint32_t told = 0xe69f00, bad = 0xc01414;
  const auto drawn = [](std::vector<MultiplePoint> points) {
    return Multiples{.title = "Errors", .panels = {{.title = "one", .x_label = "knob", .points = std::move(points)}}};
  };
  const Multiples all = drawn({{"1", 1e-8, 1e-6, MultipleMark::Good},
                               {"2", 1e-3, 1e-6, MultipleMark::Told},
                               {"3", nan, nan, MultipleMark::Refused},
                               {"4", 0.5, 1e-6, MultipleMark::Bad}});
  EXPECT_GT(look(all, blue).pixels, 40);
  EXPECT_GT(look(all, told).pixels, 40);
  EXPECT_GT(look(all, bad).pixels, 40);
  const Multiples good = drawn({{"1", 1e-8, 1e-6, MultipleMark::Good}});
  EXPECT_EQ(look(good, told).pixels + look(good, bad).pixels, 0);
  // Beyond the axis: at its end, not outside.
  EXPECT_GT(look(drawn({{"1", 0, nan, MultipleMark::Good}}), blue).pixels, 40);
  EXPECT_THROW(draw("/nowhere/at/all.png", all), Error);
}

TEST(Multiples, TakeAnotherLineForMorePanels) {
  const Multiple panel{.title = "one", .points = {{"1", 1e-8}}};
  const int one = look(Multiples{.title = "a", .panels = {panel}}, blue).height,
            five = look(Multiples{.title = "a", .panels = {5, panel}}, blue).height;
  EXPECT_GT(five, one + 250);
}

}  // namespace
}  // namespace kerf::gallery_test
