#pragma once
// What charts share: a heading on white, colors, the frame and the grid of a plot.

#include "plot/figure/pen.hpp"

#include <array>

namespace kerf {

// [Okabe, Ito 2008], and a black: told apart by color-blind readers, too.
inline constexpr std::array<std::uint32_t, 8> palette{0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7,
                                                      0xe69f00, 0x56b4e9, 0x7a4b2a, 0x303030};
inline constexpr std::uint32_t grid_gray = 0xdde2e7;
inline constexpr double tick_length = 9, tick_gap = 9;

/// Title and subtitle at the top of a page.
struct Heading {
  Lines title, subtitle;
  double bottom(double top) const {
    return top + title.height() + subtitle.height();
  }
};
/// Across `width`, on up to two lines and `most`.
Heading heading(const std::string& title, const std::string& subtitle, double width, std::size_t most,
                const Measure& measure);
void write_heading(cairo_t* pen, const Vec2& at, const Heading& heading);

/// White, with the heading at `margin` from the left and the top.
Sheet page_with(const Heading& heading, double margin, int width, int height);

void line(cairo_t* pen, const Vec2& from, const Vec2& to, double width, std::uint32_t rgb);
void draw_frame(cairo_t* pen, const Box& box);

}  // namespace kerf
