#include "plot/bars.hpp"

#include "io/text.hpp"
#include "plot/figure/pen.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr std::array<std::uint32_t, 4> fills{0x0072b2, 0x8fb8d6, 0xb0b7be, 0xd8a878};
constexpr std::uint32_t line_gray = 0xdde2e7;
constexpr double page_width = 1700, margin = 36, pitch = 40, thickness = 24, group_gap = 26;
const Font title_font{34, true}, subtitle_font{24}, group_font{25, true}, name_font{22}, tick_font{22}, label_font{25};

bool drawable(const Bar& bar) {
  return std::isfinite(bar.value);
}

}  // namespace

void draw(const std::filesystem::path& path, const BarChart& chart) {
  const Measure measure = ruler();
  const double room = page_width - 2 * margin;
  double most = 0, names = 0, texts = 0, height = 0;
  for (const BarGroup& group : chart.groups) {
    height += 1.4 * group_font.size + group_gap;
    for (const Bar& bar : group.bars) {
      if (!drawable(bar)) continue;
      most = std::max(most, bar.value);
      names = std::max(names, measure(clean_text(bar.name), name_font));
      texts = std::max(texts, measure(clean_text(bar.text), name_font));
      height += pitch;
    }
  }
  names = std::min(names, 0.4 * room);
  texts = std::min(texts, 0.3 * room);
  if (!(most > 0)) most = 1;
  const Lines title = wrap(chart.title, title_font, 22, room, 2, measure);
  const Lines subtitle = wrap(chart.subtitle, subtitle_font, 18, room, 2, measure);
  const double top = margin + title.height() + subtitle.height() + 16;
  const double left = margin + names + 18, width = room - names - texts - 40;
  const auto at = [&](double value) { return left + width * std::max(value, 0.0) / most; };

  const Sheet page = sheet(static_cast<int>(page_width), static_cast<int>(top + height + 100 + margin));
  cairo_t* pen = page.pen();
  color(pen, paper);
  cairo_paint(pen);
  write_block(pen, {margin, margin}, title, 0);
  write_block(pen, {margin, margin + title.height()}, subtitle, 0, gray);
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
  const Ticks marks = ticks(0, most, 8);
  const double bottom = top + height + 8;
  const auto lines = [&](double from, double to) {
    for (const double mark : marks.at) {
      cairo_new_path(pen);
      cairo_move_to(pen, at(mark), from);
      cairo_line_to(pen, at(mark), to);
      stroke(pen, 1.4, mark == 0 ? frame_gray : line_gray);
    }
  };
  for (std::size_t i = 0; i < marks.at.size(); ++i)
    write(pen, {at(marks.at[i]), bottom + 18}, marks.labels[i], tick_font, 0.5);
  const std::string label = marks.note.empty() ? chart.x_label : chart.x_label + " (" + marks.note + ")";
  write_block(pen, {left + 0.5 * width, bottom + 40}, wrap(label, label_font, 17, room, 1, measure), 0.5);
  double y = top;
  for (const BarGroup& group : chart.groups) {
    y += group_gap;
    write_block(pen, {margin, y}, wrap(group.title, group_font, 18, room, 1, measure), 0);
    y += 1.4 * group_font.size;
    lines(y, y + pitch * static_cast<double>(std::ranges::count_if(group.bars, drawable)));
    for (const Bar& bar : group.bars) {
      if (!drawable(bar)) continue;
      const double middle = y + 0.5 * pitch;
      write_block(pen, {left - 14, middle - 0.65 * name_font.size},
                  wrap(bar.name, name_font, 13, names + 1, 1, measure), 1);
      cairo_new_path(pen);
      cairo_rectangle(pen, left, middle - 0.5 * thickness, std::max(at(bar.value) - left, 2.5), thickness);
      color(pen, fills[bar.style % fills.size()]);
      cairo_fill(pen);
      write_block(pen, {at(bar.value) + 12, middle - 0.65 * name_font.size},
                  wrap(bar.text, name_font, 13, texts + 1, 1, measure), 0);
      y += pitch;
    }
  }
  save(path, page);
}

}  // namespace kerf
