// Quantities against a common axis: panels below one another, each with its own scale, linear or logarithmic. A curve
// breaks where it has no value, or none that a logarithm has; a value between two gaps is a dot. A dashed line is the
// limit of a curve. The legend stands in the corner of its panel with the fewest points in it. The marks of the common
// axis are whole numbers, since iterations and steps are counted; a second scale along the upper edge says what belongs
// to them (state solves), as far as there is room.

#include "plot/curves.hpp"

#include "io/text.hpp"
#include "plot/figure/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr std::size_t colors_used = 7;  // of the palette: limits are lines of the same color
constexpr double curves_margin = 34, panel_gap = 34, unit_height = 250, curves_plot_width = 1290;
constexpr double curves_legend_line = 44, curves_legend_pitch = 32;
const Font curves_tick{24}, curves_legend{22}, curves_label{26};

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
  double least = infinity, most = -least;
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

struct PlacedCurve {
  Box box;
  Axis x, y;
  Vec2 place(double at, double value) const {
    return {box.x + x.share(at) * box.width, box.y + (1 - y.share(value)) * box.height};
  }
};

void draw_curve(cairo_t* pen, const PlacedCurve& panel, const std::vector<double>& x, const Curve& curve,
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
    cairo_arc(pen, p.x(), p.y(), radius, 0, 2 * pi);
    color(pen, rgb);
    cairo_fill_preserve(pen);
    stroke(pen, 1.2, paper);
  }
}

/// Names in the corner of the panel that holds the fewest points.
void draw_legend(cairo_t* pen, const PlacedCurve& panel, const std::vector<double>& x,
                 const std::vector<Curve>& curves) {
  double width = 0;
  int names = 0;
  for (const Curve& curve : curves) {
    if (curve.name.empty()) continue;
    ++names;
    width = std::max(width, curves_legend_line + 12 + text_width(pen, clean_text(curve.name), curves_legend));
  }
  if (names == 0) return;
  width += 24;
  const double height = curves_legend_pitch * names + 12;
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
  double y = box.y + 6 + 0.5 * curves_legend_pitch;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].name.empty()) continue;
    line(pen, {box.x + 12, y}, {box.x + 12 + curves_legend_line, y}, 3, palette[i % colors_used]);
    write(pen, {box.x + 24 + curves_legend_line, y}, clean_text(curves[i].name), curves_legend);
    y += curves_legend_pitch;
  }
}

/// Everything in its place.
struct Plan {
  Heading heading;
  Axis x;
  Marks across;
  std::vector<PlacedCurve> panels;
  std::vector<Marks> marks_of;  // the panels
  double width = 0, height = 0, label_y = 0;
  bool upper = false;
};

/// Whole numbers below one another: iterations are counted.
Marks whole_marks(const Axis& x) {
  const Marks all = marks(x, 10);
  Marks whole;
  for (std::size_t i = 0; i < all.at.size(); ++i) {
    if (all.at[i] != std::round(all.at[i])) continue;
    whole.at.push_back(all.at[i]);
    whole.labels.push_back(all.labels[i]);
  }
  return whole;
}

Axis value_axis(const Panel& panel) {
  std::vector<double> values;
  for (const Curve& curve : panel.curves) {
    values.insert(values.end(), curve.values.begin(), curve.values.end());
    if (curve.limit) values.push_back(*curve.limit);
  }
  return make_axis(values, panel.logarithmic, 0.08);
}

Plan lay_out_curves(const Curves& curves, const Measure& measure) {
  Plan plan{.x = make_axis(curves.x, false, 0.015)};
  plan.across = whole_marks(plan.x);
  std::vector<Axis> axes;
  double widest = 0;
  for (const Panel& panel : curves.panels) {
    axes.push_back(value_axis(panel));
    plan.marks_of.push_back(marks(axes.back(), panel.share > 1 ? 8 : 5));
    for (const std::string& text : plan.marks_of.back().labels) widest = std::max(widest, measure(text, curves_tick));
  }
  const double left = curves_margin + 1.3 * curves_label.size + 14 + widest + tick_length + tick_gap;
  plan.width = left + curves_plot_width + curves_margin + 20;
  plan.heading = heading(curves.title, curves.subtitle, plan.width - 2 * curves_margin, 3, measure);
  plan.upper = curves.upper.size() == curves.x.size() && !curves.upper.empty();
  double y = plan.heading.bottom(curves_margin) + 18 + (plan.upper ? 34 : 0);
  for (std::size_t i = 0; i < curves.panels.size(); ++i) {
    const double height = unit_height * curves.panels[i].share;
    plan.panels.push_back({{left, y, curves_plot_width, height}, plan.x, axes[i]});
    y += height + panel_gap;
  }
  y -= panel_gap;
  plan.label_y = y + tick_length + tick_gap + curves_tick.size + 10;
  plan.height = plan.label_y + 1.3 * curves_label.size + 0.6 * curves_margin;
  return plan;
}

/// Grid and ticks; the labels of the common axis below the last panel alone.
void draw_grid(cairo_t* pen, const Plan& plan, std::size_t p) {
  const Box& box = plan.panels[p].box;
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
  for (std::size_t i = 0; i < plan.across.at.size(); ++i) {
    const double at = box.x + plan.x.share(plan.across.at[i]) * box.width;
    line(pen, {at, box.y}, {at, box.y + box.height}, 1.2, grid_gray);
    line(pen, {at, box.y + box.height}, {at, box.y + box.height + tick_length}, 1.6, frame_gray);
    if (p + 1 == plan.panels.size())
      write(pen, {at, box.y + box.height + tick_length + tick_gap + 0.5 * curves_tick.size}, plan.across.labels[i],
            curves_tick, {0.5});
  }
  const Marks& marks = plan.marks_of[p];
  for (std::size_t i = 0; i < marks.at.size(); ++i) {
    const double at = plan.panels[p].place(0, marks.at[i]).y();
    line(pen, {box.x, at}, {box.x + box.width, at}, 1.2, grid_gray);
    line(pen, {box.x - tick_length, at}, {box.x, at}, 1.6, frame_gray);
    write(pen, {box.x - tick_length - tick_gap, at}, marks.labels[i], curves_tick, {1});
  }
  draw_frame(pen, box);
}

void draw_curves_panel(cairo_t* pen, const Plan& plan, std::size_t p, const Curves& curves, const Measure& measure) {
  const Panel& panel = curves.panels[p];
  const Box& box = plan.panels[p].box;
  draw_grid(pen, plan, p);
  const Lines name = wrap(with_note(panel.label, plan.marks_of[p].note), curves_label, {box.height, 15, 1}, measure);
  write_block(pen, {curves_margin, box.y + 0.5 * box.height}, name, {0.5, ink, true});
  cairo_save(pen);
  cairo_rectangle(pen, box.x, box.y, box.width, box.height);
  cairo_clip(pen);
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
  for (std::size_t k = 0; k < panel.curves.size(); ++k)
    draw_curve(pen, plan.panels[p], curves.x, panel.curves[k], palette[k % colors_used]);
  draw_legend(pen, plan.panels[p], curves.x, panel.curves);
  cairo_restore(pen);
}

/// What belongs to the marks of the common axis, as far as there is room for it.
void draw_upper_scale(cairo_t* pen, const Plan& plan, const Curves& curves) {
  const Font small{20};
  const Box& box = plan.panels.back().box;
  const double above = plan.panels.front().box.y - 18;
  const std::string name = curves.upper_label + ":";
  const double width = text_width(pen, name, small), from = std::max(0.5 * curves_margin, box.x - tick_gap - width);
  write(pen, {from, above}, name, small, {0, gray});
  double free = from + width + 10;
  for (const double mark : plan.across.at) {
    const auto at = std::find(curves.x.begin(), curves.x.end(), mark);
    if (at == curves.x.end()) continue;
    const std::string text = pretty(curves.upper[static_cast<std::size_t>(at - curves.x.begin())]);
    const double middle = box.x + plan.x.share(*at) * box.width, half = 0.5 * text_width(pen, text, small);
    if (middle - half < free) continue;
    write(pen, {middle, above}, text, small, {0.5, gray});
    free = middle + half + 12;
  }
}

}  // namespace

void draw(const std::filesystem::path& path, const Curves& curves) {
  const Measure measure = ruler();
  const Plan plan = lay_out_curves(curves, measure);
  const Sheet page =
      page_with(plan.heading, curves_margin, static_cast<int>(plan.width), static_cast<int>(plan.height));
  cairo_t* pen = page.pen();
  for (std::size_t p = 0; p < plan.panels.size(); ++p) draw_curves_panel(pen, plan, p, curves, measure);
  if (!plan.panels.empty() && !curves.x.empty()) {
    const Box& last = plan.panels.back().box;
    const Lines name = wrap(curves.x_label, curves_label, {curves_plot_width, 18, 1}, measure);
    write_block(pen, {last.x + 0.5 * last.width, plan.label_y}, name, {0.5});
    if (plan.upper) draw_upper_scale(pen, plan, curves);
  }
  save(path, page);
}

}  // namespace kerf
