// Many small charts of one kind side by side: a value per setting of a knob, on one logarithmic scale for all of them,
// with limits, and a color for how the value is judged (good, told of, bad). What was refused is a cross at the upper
// edge; values beyond the scale lie on its ends. Labels below are left out, every second, third, ..., where they would
// touch. Four charts stand in a line.

#include "plot/multiples.hpp"

#include "io/text.hpp"
#include "plot/figure/frame.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double multiples_margin = 34, panel_width = 430, panel_height = 250, left = 74, gap_x = 34, title_room = 44,
                 axis_room = 66, dot = 5;
constexpr std::size_t columns = 4;
const Font multiples_tick{15}, name{19, true}, multiples_label{15};
constexpr std::uint32_t good_blue = palette[0], told_orange = palette[4], bad_red = 0xc01414;

struct Panel {
  const Multiples& all;
  const Multiple& data;
  Box plot;

  double x(std::size_t i) const {
    return plot.x + plot.width * (static_cast<double>(i) + 0.5) / static_cast<double>(data.points.size());
  }
  double y(double value) const {
    const double low = std::log10(all.least), high = std::log10(all.most);
    const double share = (std::log10(std::clamp(value, all.least, all.most)) - low) / (high - low);
    return plot.y + (1 - share) * plot.height;
  }
};

void draw_value_axis(cairo_t* pen, const Panel& p) {
  const LogTicks marks = log_ticks(p.all.least, p.all.most, 6);
  for (std::size_t i = 0; i < marks.major.at.size(); ++i) {
    const double y = p.y(marks.major.at[i]);
    line(pen, {p.plot.x, y}, {p.plot.x + p.plot.width, y}, 1, grid_gray);
    write(pen, {p.plot.x - 7, y}, marks.major.labels[i], multiples_tick, {1});
  }
}

/// Every label, or every second, third ...: what does not touch.
void draw_knob_axis(cairo_t* pen, const Panel& p) {
  double widest = 0;
  for (const MultiplePoint& point : p.data.points)
    widest = std::max(widest, text_width(pen, point.label, multiples_tick));
  const double pitch = p.plot.width / static_cast<double>(std::max<std::size_t>(1, p.data.points.size()));
  const auto step = static_cast<std::size_t>(std::max(1.0, std::ceil((widest + 6) / pitch)));
  const double bottom = p.plot.y + p.plot.height;
  for (std::size_t i = 0; i < p.data.points.size(); ++i) {
    line(pen, {p.x(i), bottom}, {p.x(i), bottom + 5}, 1.2, frame_gray);
    if (i % step == 0) write(pen, {p.x(i), bottom + 16}, p.data.points[i].label, multiples_tick, {0.5});
  }
}

void draw_limits(cairo_t* pen, const Panel& p) {
  const double half = 0.5 * p.plot.width / static_cast<double>(std::max<std::size_t>(1, p.data.points.size()));
  for (std::size_t i = 0; i < p.data.points.size(); ++i)
    if (const double limit = p.data.points[i].limit; limit > 0)
      line(pen, {p.x(i) - half, p.y(limit)}, {p.x(i) + half, p.y(limit)}, 2.4, 0xb9c1c9);
}

void draw_cross(cairo_t* pen, const Vec2& at) {
  line(pen, at + Vec2(-dot, -dot), at + Vec2(dot, dot), 2.4, ink);
  line(pen, at + Vec2(-dot, dot), at + Vec2(dot, -dot), 2.4, ink);
}

void draw_points(cairo_t* pen, const Panel& p) {
  cairo_new_path(pen);
  for (std::size_t i = 0; i < p.data.points.size(); ++i)
    if (p.data.points[i].value >= 0) cairo_line_to(pen, p.x(i), p.y(p.data.points[i].value));
  stroke(pen, 1.6, good_blue, 0.6);
  for (std::size_t i = 0; i < p.data.points.size(); ++i) {
    const MultiplePoint& point = p.data.points[i];
    if (point.mark == MultipleMark::Refused || !(point.value >= 0)) {
      draw_cross(pen, {p.x(i), p.plot.y + 12});
      if (point.mark == MultipleMark::Refused) continue;
    }
    const double y = point.value >= 0 ? p.y(point.value) : p.plot.y + 12;
    cairo_new_path(pen);
    cairo_arc(pen, p.x(i), y, dot, 0, 2 * pi);
    color(pen, point.mark == MultipleMark::Good ? good_blue : point.mark == MultipleMark::Told ? told_orange : bad_red);
    cairo_fill(pen);
  }
}

void draw_multiple(cairo_t* pen, const Panel& p, const Measure& measure) {
  write_block(pen, {p.plot.x, p.plot.y - title_room + 8},
              wrap(clean_text(p.data.title), name, {p.plot.width, 14, 1}, measure));
  draw_value_axis(pen, p);
  draw_knob_axis(pen, p);
  draw_limits(pen, p);
  draw_points(pen, p);
  draw_frame(pen, p.plot);
  write_block(pen, {p.plot.x + 0.5 * p.plot.width, p.plot.y + p.plot.height + 28},
              wrap(clean_text(p.data.x_label), multiples_label, {p.plot.width, 12, 1}, measure), {0.5, gray});
}

}  // namespace

void draw(const std::filesystem::path& path, const Multiples& multiples) {
  const Measure measure = ruler();
  const std::size_t across = std::min(columns, std::max<std::size_t>(1, multiples.panels.size()));
  const std::size_t down = (multiples.panels.size() + across - 1) / across;
  const double pitch_x = left + panel_width + gap_x, pitch_y = title_room + panel_height + axis_room;
  const double width = std::max(2 * multiples_margin + pitch_x * static_cast<double>(across), 900.0);
  const Heading head = heading(multiples.title, multiples.subtitle, width - 2 * multiples_margin, 3, measure);
  const double top = head.bottom(multiples_margin) + 18;
  const Sheet page = page_with(head, multiples_margin, static_cast<int>(width),
                               static_cast<int>(top + pitch_y * static_cast<double>(down) + multiples_margin));
  cairo_set_line_cap(page.pen(), CAIRO_LINE_CAP_BUTT);
  for (std::size_t i = 0; i < multiples.panels.size(); ++i) {
    const double x = multiples_margin + left + pitch_x * static_cast<double>(i % across),
                 y = top + title_room + pitch_y * static_cast<double>(i / across);
    draw_multiple(page.pen(), {multiples, multiples.panels[i], {x, y, panel_width, panel_height}}, measure);
  }
  save(path, page);
}

}  // namespace kerf
