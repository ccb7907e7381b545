// What charts have in common: a page with title and subtitle, straight lines, the frame of a plot.

#include "plot/figure/frame.hpp"

namespace kerf {

Heading heading(const std::string& title, const std::string& subtitle, double width, std::size_t most,
                const Measure& measure) {
  return {wrap(title, {34, true}, {width, 22, 2}, measure), wrap(subtitle, {24}, {width, 18, most}, measure)};
}

void write_heading(cairo_t* pen, const Vec2& at, const Heading& heading) {
  write_block(pen, at, heading.title);
  write_block(pen, {at.x(), at.y() + heading.title.height()}, heading.subtitle, {0, gray});
}

Sheet page_with(const Heading& heading, double margin, int width, int height) {
  Sheet page = sheet(width, height);
  color(page.pen(), paper);
  cairo_paint(page.pen());
  write_heading(page.pen(), {margin, margin}, heading);
  return page;
}

void line(cairo_t* pen, const Vec2& from, const Vec2& to, double width, std::uint32_t rgb) {
  cairo_new_path(pen);
  cairo_move_to(pen, from.x(), from.y());
  cairo_line_to(pen, to.x(), to.y());
  stroke(pen, width, rgb);
}

void draw_frame(cairo_t* pen, const Box& box) {
  cairo_new_path(pen);
  cairo_rectangle(pen, box.x, box.y, box.width, box.height);
  stroke(pen, 1.6, frame_gray);
}

}  // namespace kerf
