// Groups of numbers as bars from zero on one scale, names to the left and texts behind them; what is not finite is left
// out.

#include "plot/bars.hpp"

#include "io/text.hpp"
#include "plot/figure/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr std::array<std::uint32_t, 4> fills{0x0072b2, 0x8fb8d6, 0xb0b7be, 0xd8a878};
constexpr double bars_page_width = 1700, bars_margin = 36, pitch = 40, thickness = 24, group_gap = 26;
const Font group_font{25, true}, name_font{22}, tick_font{22}, bars_label_font{25};

bool drawable(const Bar& bar) {
  return std::isfinite(bar.value);
}

constexpr double room = bars_page_width - 2 * bars_margin;

/// Names, bars from zero and texts below one another.
struct Columns {
  double most = 0;              // the largest value
  double names = 0, texts = 0;  // widths
  double height = 0;            // of all groups
  double left = 0, width = 0;   // of the bars
  double at(double value) const {
    return left + width * std::max(value, 0.0) / most;
  }
};

Columns lay_out_bars(const BarChart& chart, const Measure& measure) {
  Columns c;
  for (const BarGroup& group : chart.groups) {
    c.height += 1.4 * group_font.size + group_gap;
    for (const Bar& bar : group.bars) {
      if (!drawable(bar)) continue;
      c.most = std::max(c.most, bar.value);
      c.names = std::max(c.names, measure(clean_text(bar.name), name_font));
      c.texts = std::max(c.texts, measure(clean_text(bar.text), name_font));
      c.height += pitch;
    }
  }
  c.names = std::min(c.names, 0.4 * room);
  c.texts = std::min(c.texts, 0.3 * room);
  if (!(c.most > 0)) c.most = 1;
  c.left = bars_margin + c.names + 18;
  c.width = room - c.names - c.texts - 40;
  return c;
}

void draw_bar(cairo_t* pen, const Columns& c, const Bar& bar, double y, const Measure& measure) {
  const double middle = y + 0.5 * pitch, top = middle - 0.65 * name_font.size;
  write_block(pen, {c.left - 14, top}, wrap(bar.name, name_font, {c.names + 1, 13, 1}, measure), {1});
  cairo_new_path(pen);
  cairo_rectangle(pen, c.left, middle - 0.5 * thickness, std::max(c.at(bar.value) - c.left, 2.5), thickness);
  color(pen, fills[bar.style % fills.size()]);
  cairo_fill(pen);
  write_block(pen, {c.at(bar.value) + 12, top}, wrap(bar.text, name_font, {c.texts + 1, 13, 1}, measure));
}

}  // namespace

void draw(const std::filesystem::path& path, const BarChart& chart) {
  const Measure measure = ruler();
  const Columns columns = lay_out_bars(chart, measure);
  const Heading head = heading(chart.title, chart.subtitle, room, 2, measure);
  const double top = head.bottom(bars_margin) + 16;
  const Sheet page = page_with(head, bars_margin, static_cast<int>(bars_page_width),
                               static_cast<int>(top + columns.height + 100 + bars_margin));
  cairo_t* pen = page.pen();
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
  const Ticks marks = ticks(0, columns.most, 8);
  const double bottom = top + columns.height + 8;
  for (std::size_t i = 0; i < marks.at.size(); ++i)
    write(pen, {columns.at(marks.at[i]), bottom + 18}, marks.labels[i], tick_font, {0.5});
  const Lines label = wrap(with_note(chart.x_label, marks.note), bars_label_font, {room, 17, 1}, measure);
  write_block(pen, {columns.left + 0.5 * columns.width, bottom + 40}, label, {0.5});
  double y = top;
  for (const BarGroup& group : chart.groups) {
    y += group_gap;
    write_block(pen, {bars_margin, y}, wrap(group.title, group_font, {room, 18, 1}, measure));
    y += 1.4 * group_font.size;
    const double end = y + pitch * static_cast<double>(std::ranges::count_if(group.bars, drawable));
    for (const double mark : marks.at)
      line(pen, {columns.at(mark), y}, {columns.at(mark), end}, 1.4, mark == 0 ? frame_gray : grid_gray);
    for (const Bar& bar : group.bars) {
      if (!drawable(bar)) continue;
      draw_bar(pen, columns, bar, y, measure);
      y += pitch;
    }
  }
  save(path, page);
}

}  // namespace kerf
