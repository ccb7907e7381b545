// The color bar of a picture, upright beside the plot or lying below it: colors, ticks, label. Where the limits of the
// scale leave out values the bar has a point at that end, in the color of the end, and the extreme value in words. Both
// bars are drawn by one code in coordinates along and across the bar. In a lying bar the words stand beside the label
// and are left out where there is no room.

#include "plot/figure/color_bar.hpp"

namespace kerf {

namespace {

/// An upright bar has its low end at the bottom, a lying one at the left: `along` from there, `across` from the plot.
struct ColorBar {
  const Layout& layout;
  const Limits& limits;
  bool upright = layout.beside;
  double length = upright ? layout.bar.height : layout.bar.width;
  double thickness = upright ? layout.bar.width : layout.bar.height;

  Vec2 at(double along, double across) const {
    const Box& bar = layout.bar;
    return upright ? Vec2(bar.x + across, bar.y + bar.height - along) : Vec2(bar.x + along, bar.y + across);
  }
  void line_to(cairo_t* pen, double along, double across) const {
    const Vec2 p = at(along, across);
    cairo_line_to(pen, p.x(), p.y());
  }
};

void paint_colors(cairo_t* pen, const ColorBar& bar, const Colors& table) {
  const Box& box = bar.layout.bar;
  Image image{static_cast<int>(box.width), static_cast<int>(box.height), {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const double share = bar.upright ? 1 - (j + 0.5) / image.height : (i + 0.5) / image.width;
      image.pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(i)] =
          table[static_cast<std::size_t>(256 * share)];
    }
  }
  put(pen, image, {box.x, box.y});
}

void draw_point(cairo_t* pen, const ColorBar& bar, double end, double tip, std::uint32_t rgb) {
  cairo_new_path(pen);
  bar.line_to(pen, end, 0);
  bar.line_to(pen, tip, 0.5 * bar.thickness);
  bar.line_to(pen, end, bar.thickness);
  cairo_close_path(pen);
  color(pen, rgb);
  cairo_fill(pen);
}

void draw_outline(cairo_t* pen, const ColorBar& bar) {
  const double point = bar.layout.point;
  cairo_new_path(pen);
  bar.line_to(pen, 0, 0);
  if (bar.limits.below()) bar.line_to(pen, -point, 0.5 * bar.thickness);
  bar.line_to(pen, 0, bar.thickness);
  bar.line_to(pen, bar.length, bar.thickness);
  if (bar.limits.above()) bar.line_to(pen, bar.length + point, 0.5 * bar.thickness);
  bar.line_to(pen, bar.length, 0);
  cairo_close_path(pen);
  stroke(pen, 1.6, frame_gray);
}

void draw_ticks(cairo_t* pen, const ColorBar& bar, double outside) {
  const Layout& layout = bar.layout;
  const Limits& limits = bar.limits;
  for (std::size_t i = 0; i < layout.values.at.size(); ++i) {
    const double along = (layout.values.at[i] - limits.low) / (limits.high - limits.low) * bar.length;
    cairo_new_path(pen);
    bar.line_to(pen, along, bar.thickness);
    bar.line_to(pen, along, bar.thickness + layout.tick_length);
    stroke(pen, 1.6, frame_gray);
    const Vec2 where = bar.at(along, bar.thickness + outside + (bar.upright ? 0 : 0.5 * layout.tick.size));
    write(pen, where, layout.values.labels[i], layout.tick, {bar.upright ? 0 : 0.5});
  }
}

/// The label, and what lies beyond the ends: beside these, or where the label leaves room.
void write_words(cairo_t* pen, const ColorBar& bar, double outside) {
  const Layout& layout = bar.layout;
  const Limits& limits = bar.limits;
  const std::string least = extreme_text("min", limits.least), most = extreme_text("max", limits.most);
  const double length = bar.length, thickness = bar.thickness;
  if (bar.upright) {
    if (limits.above()) write(pen, bar.at(length + layout.point, thickness + outside), most, layout.extreme, {0, gray});
    if (limits.below()) write(pen, bar.at(-layout.point, thickness + outside), least, layout.extreme, {0, gray});
    write_block(pen, {layout.bar.x + thickness + layout.label_gap, layout.plot.y + 0.5 * layout.plot.height},
                layout.value_label, {0.5, ink, true});
    return;
  }
  const Vec2 label = {layout.bar.x + 0.5 * length, layout.bar.y + thickness + layout.label_gap};
  write_block(pen, label, layout.value_label, {0.5});
  double half = 0;
  for (const auto& line : layout.value_label.text)
    half = std::max(half, 0.5 * text_width(pen, line, layout.value_label.font));
  const double y = label.y() + 0.65 * layout.value_label.font.size, room = 0.5 * length + layout.point - half - 30;
  if (limits.below() && text_width(pen, least, layout.extreme) < room)
    write(pen, {layout.bar.x - layout.point, y}, least, layout.extreme, {0, gray});
  if (limits.above() && text_width(pen, most, layout.extreme) < room)
    write(pen, {layout.bar.x + length + layout.point, y}, most, layout.extreme, {1, gray});
}

}  // namespace

void draw_color_bar(cairo_t* pen, const Layout& layout, Scale scale, const Limits& limits) {
  const Colors& table = colors(scale);
  const ColorBar bar{layout, limits};
  const double outside = layout.tick_length + layout.tick_gap;
  paint_colors(pen, bar, table);
  if (limits.below()) draw_point(pen, bar, 0, -layout.point, table.front());
  if (limits.above()) draw_point(pen, bar, bar.length, bar.length + layout.point, table.back());
  draw_outline(pen, bar);
  draw_ticks(pen, bar, outside);
  write_words(pen, bar, outside);
}

}  // namespace kerf
