#include "plot/curves.hpp"

#include "io/text.hpp"
#include "plot/figure/pen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace kerf {

namespace {

// [Okabe, Ito 2008]: told apart by color-blind readers, too.
constexpr std::array<std::uint32_t, 7> palette{0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x7a4b2a};
constexpr std::uint32_t line_gray = 0xdde2e7;
constexpr double margin = 34, tick_length = 9, tick_gap = 9, panel_gap = 34, unit_height = 250, plot_width = 1290;
constexpr double legend_line = 44, legend_pitch = 32;
const Font tick{24}, legend{22}, label{26};

/// One axis: values to shares of its length.
struct Axis {
  double low = 0, high = 1;  // of logarithms when `logarithmic`
  bool logarithmic = false;
  double share(double value) const {
    return ((logarithmic ? std::log10(value) : value) - low) / (high - low);
  }
  bool shows(double value) const {
    return std::isfinite(value) && (!logarithmic || value > 0);
  }
};

Axis make_axis(const std::vector<double>& values, bool logarithmic, double room) {
  Axis axis{0, 1, logarithmic};
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const double v : values) {
    if (!axis.shows(v)) continue;
    least = std::min(least, logarithmic ? std::log10(v) : v);
    most = std::max(most, logarithmic ? std::log10(v) : v);
  }
  if (!(least <= most)) return axis;
  double extent = most - least;
  const double magnitude = std::max(std::abs(least), std::abs(most));
  if (!(extent > 1e-9 * magnitude)) extent = magnitude > 0 ? 0.1 * magnitude : 1;  // a constant
  const double middle = 0.5 * least + 0.5 * most, half = std::max(0.5 * (most - least), 0.5 * extent);
  axis.low = middle - half - room * extent;
  axis.high = middle + half + room * extent;
  return axis;
}

struct Marks {
  std::vector<double> at;
  std::vector<std::string> labels;
  std::string note;
};

Marks marks(const Axis& axis, int most) {
  if (axis.logarithmic) {
    const LogTicks t = log_ticks(std::pow(10, axis.low), std::pow(10, axis.high), most);
    return {t.major.at, t.major.labels, t.major.note};
  }
  const Ticks t = ticks(axis.low, axis.high, most);
  return {t.at, t.labels, t.note};
}

void line(cairo_t* pen, const Vec2& from, const Vec2& to, double width, std::uint32_t rgb) {
  cairo_new_path(pen);
  cairo_move_to(pen, from.x(), from.y());
  cairo_line_to(pen, to.x(), to.y());
  stroke(pen, width, rgb);
}

struct Placed {
  Box box;
  Axis x, y;
  Vec2 place(double at, double value) const {
    return {box.x + x.share(at) * box.width, box.y + (1 - y.share(value)) * box.height};
  }
};

void draw_curve(cairo_t* pen, const Placed& panel, const std::vector<double>& x, const Curve& curve,
                std::uint32_t rgb) {
  if (curve.limit && panel.y.shows(*curve.limit)) {
    const std::array<double, 2> dashes{12, 9};
    const double y = panel.place(0, *curve.limit).y();
    cairo_set_dash(pen, dashes.data(), 2, 0);
    line(pen, {panel.box.x, y}, {panel.box.x + panel.box.width, y}, 2.2, rgb);
    cairo_set_dash(pen, nullptr, 0, 0);
  }
  const std::size_t count = std::min(x.size(), curve.values.size());
  const double dot = count <= 40 ? 5.5 : count <= 120 ? 3.5 : 0;
  cairo_new_path(pen);
  for (std::size_t i = 0; i < count; ++i) {
    if (!panel.y.shows(curve.values[i])) {
      cairo_new_sub_path(pen);
      continue;
    }
    const Vec2 p = panel.place(x[i], curve.values[i]);
    cairo_line_to(pen, p.x(), p.y());
  }
  cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
  stroke(pen, 3, rgb);
  for (std::size_t i = 0; i < count; ++i) {
    const bool alone =
        (i == 0 || !panel.y.shows(curve.values[i - 1])) && (i + 1 == count || !panel.y.shows(curve.values[i + 1]));
    const double radius = alone ? std::max(dot, 4.0) : dot;
    if (!panel.y.shows(curve.values[i]) || !(radius > 0)) continue;
    const Vec2 p = panel.place(x[i], curve.values[i]);
    cairo_new_path(pen);
    cairo_arc(pen, p.x(), p.y(), radius, 0, 2 * std::numbers::pi);
    color(pen, rgb);
    cairo_fill_preserve(pen);
    stroke(pen, 1.2, paper);
  }
}

/// Names in the corner of the panel that holds the fewest points.
void draw_legend(cairo_t* pen, const Placed& panel, const std::vector<double>& x, const std::vector<Curve>& curves) {
  double width = 0;
  int names = 0;
  for (const Curve& curve : curves) {
    if (curve.name.empty()) continue;
    ++names;
    width = std::max(width, legend_line + 12 + text_width(pen, clean_text(curve.name), legend));
  }
  if (names == 0) return;
  width += 24;
  const double height = legend_pitch * names + 12;
  const Box& b = panel.box;
  std::array<Box, 4> corners{{{b.x + b.width - width - 10, b.y + 10, width, height},
                              {b.x + b.width - width - 10, b.y + b.height - height - 10, width, height},
                              {b.x + 10, b.y + 10, width, height},
                              {b.x + 10, b.y + b.height - height - 10, width, height}}};
  const auto hidden = [&](const Box& box) {
    int count = 0;
    for (const Curve& curve : curves)
      for (std::size_t i = 0; i < std::min(x.size(), curve.values.size()); ++i) {
        if (!panel.y.shows(curve.values[i])) continue;
        const Vec2 p = panel.place(x[i], curve.values[i]) - Vec2(box.x, box.y);
        count += p.minCoeff() >= 0 && p.x() <= box.width && p.y() <= box.height;
      }
    return count;
  };
  const Box& box = *std::min_element(corners.begin(), corners.end(),
                                     [&](const Box& a, const Box& c) { return hidden(a) < hidden(c); });
  cairo_new_path(pen);
  cairo_rectangle(pen, box.x, box.y, box.width, box.height);
  color(pen, paper, 0.85);
  cairo_fill(pen);
  double y = box.y + 6 + 0.5 * legend_pitch;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].name.empty()) continue;
    line(pen, {box.x + 12, y}, {box.x + 12 + legend_line, y}, 3, palette[i % palette.size()]);
    write(pen, {box.x + 24 + legend_line, y}, clean_text(curves[i].name), legend, 0);
    y += legend_pitch;
  }
}

std::string with_note(const std::string& text, const std::string& note) {
  return note.empty() ? text : text + " (" + note + ")";
}

}  // namespace

void draw(const std::filesystem::path& path, const Curves& curves) {
  const Measure measure = ruler();
  const Axis x = make_axis(curves.x, false, 0.015);
  std::vector<Axis> axes;
  std::vector<Marks> marks_of;
  double widest = 0;
  for (const Panel& panel : curves.panels) {
    std::vector<double> values;
    for (const Curve& curve : panel.curves) {
      values.insert(values.end(), curve.values.begin(), curve.values.end());
      if (curve.limit) values.push_back(*curve.limit);
    }
    axes.push_back(make_axis(values, panel.logarithmic, 0.08));
    marks_of.push_back(marks(axes.back(), panel.share > 1 ? 8 : 5));
    for (const std::string& text : marks_of.back().labels) widest = std::max(widest, measure(text, tick));
  }
  const double left = margin + 1.3 * label.size + 14 + widest + tick_length + tick_gap;
  const double page_width = left + plot_width + margin + 20;
  const Lines title = wrap(curves.title, {34, true}, 22, page_width - 2 * margin, 2, measure);
  const Lines subtitle = wrap(curves.subtitle, {24}, 18, page_width - 2 * margin, 3, measure);
  const bool upper = curves.upper.size() == curves.x.size() && !curves.upper.empty();
  double y = margin + title.height() + subtitle.height() + 18 + (upper ? 34 : 0);
  std::vector<Placed> panels;
  for (std::size_t i = 0; i < curves.panels.size(); ++i) {
    const double height = unit_height * curves.panels[i].share;
    panels.push_back({{left, y, plot_width, height}, x, axes[i]});
    y += height + panel_gap;
  }
  y -= panel_gap;
  const double label_y = y + tick_length + tick_gap + tick.size + 10;
  const Sheet page = sheet(static_cast<int>(page_width), static_cast<int>(label_y + 1.3 * label.size + 0.6 * margin));
  cairo_t* pen = page.pen();
  color(pen, paper);
  cairo_paint(pen);
  write_block(pen, {margin, margin}, title, 0);
  write_block(pen, {margin, margin + title.height()}, subtitle, 0, gray);

  // Whole numbers below one another: iterations are counted.
  Marks across = marks(x, 10);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < across.at.size(); ++i)
    if (across.at[i] == std::round(across.at[i])) kept.push_back(i);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const Box& box = panels[p].box;
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
    for (const std::size_t i : kept) {
      const double at = box.x + x.share(across.at[i]) * box.width;
      line(pen, {at, box.y}, {at, box.y + box.height}, 1.2, line_gray);
      line(pen, {at, box.y + box.height}, {at, box.y + box.height + tick_length}, 1.6, frame_gray);
      if (p + 1 == panels.size())
        write(pen, {at, box.y + box.height + tick_length + tick_gap + 0.5 * tick.size}, across.labels[i], tick, 0.5);
    }
    for (std::size_t i = 0; i < marks_of[p].at.size(); ++i) {
      const double at = panels[p].place(0, marks_of[p].at[i]).y();
      line(pen, {box.x, at}, {box.x + box.width, at}, 1.2, line_gray);
      line(pen, {box.x - tick_length, at}, {box.x, at}, 1.6, frame_gray);
      write(pen, {box.x - tick_length - tick_gap, at}, marks_of[p].labels[i], tick, 1);
    }
    cairo_new_path(pen);
    cairo_rectangle(pen, box.x, box.y, box.width, box.height);
    stroke(pen, 1.6, frame_gray);
    const Lines name = wrap(with_note(curves.panels[p].label, marks_of[p].note), label, 15, box.height, 1, measure);
    write_block(pen, {margin, box.y + 0.5 * box.height}, name, 0.5, ink, true);
    cairo_save(pen);
    cairo_rectangle(pen, box.x, box.y, box.width, box.height);
    cairo_clip(pen);
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
    for (std::size_t k = 0; k < curves.panels[p].curves.size(); ++k)
      draw_curve(pen, panels[p], curves.x, curves.panels[p].curves[k], palette[k % palette.size()]);
    draw_legend(pen, panels[p], curves.x, curves.panels[p].curves);
    cairo_restore(pen);
  }
  if (panels.empty() || curves.x.empty()) {
    save(path, page);
    return;
  }
  const Box& last = panels.back().box;
  write_block(pen, {last.x + 0.5 * last.width, label_y}, wrap(curves.x_label, label, 18, plot_width, 1, measure), 0.5);
  if (upper) {
    const Font small{20};
    const double above = panels.front().box.y - 18;
    const std::string name = curves.upper_label + ":";
    const double width = text_width(pen, name, small), from = std::max(0.5 * margin, last.x - tick_gap - width);
    write(pen, {from, above}, name, small, 0, gray);
    double free = from + width + 10;
    for (const std::size_t i : kept) {
      const auto at = std::find(curves.x.begin(), curves.x.end(), across.at[i]);
      if (at == curves.x.end()) continue;
      const std::string text = pretty(curves.upper[static_cast<std::size_t>(at - curves.x.begin())]);
      const double middle = last.x + x.share(*at) * last.width, half = 0.5 * text_width(pen, text, small);
      if (middle - half < free) continue;
      write(pen, {middle, above}, text, small, 0.5, gray);
      free = middle + half + 12;
    }
  }
  save(path, page);
}

}  // namespace kerf
