// Series of points as lines with markers: both axes logarithmic, or y linear. Points that an axis has no place for are
// left out. Color and marker follow the style of a series, so that series are told apart without colors. Dotted lines
// of given slopes, a fan from one point, show orders of convergence: they stand in the corner where they are in the way
// of the fewest points, falling ones in a left corner and rising ones in a right one if there is a choice. An axis
// spans the data and at least 0.8 of a decade, so that it has two labels.

#include "plot/chart.hpp"

#include "io/text.hpp"
#include "plot/figure/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr double chart_margin = 34, marker = 6.5, chart_plot_width = 1050, plot_height = 820;
constexpr int most_ticks = 9;
constexpr double legend_gap = 30, legend_line = 54, legend_pitch = 34;
const Font tick{24}, legend{22}, label{26};

/// The points that can be drawn, in the coordinates of the axes.
std::vector<Vec2> on_axes(const Series& s, bool linear_y) {
  std::vector<Vec2> points;
  for (const Vec2& p : s.points)
    if (p.allFinite() && p.x() > 0 && (linear_y || p.y() > 0))
      points.emplace_back(std::log10(p.x()), linear_y ? p.y() : std::log10(p.y()));
  return points;
}

struct Frame {
  Box plot;
  Vec2 low, high;  // at the ends of the axes: decimal logarithms, or values of a linear one
  bool linear_y = false;
  Vec2 place(const Vec2& p) const {
    const Vec2 share = (p - low).cwiseQuotient(high - low);
    return {plot.x + share.x() * plot.width, plot.y + (1 - share.y()) * plot.height};
  }
};

/// Ends of an axis: the data with some room, and enough of a decade for two labels.
std::array<double, 2> axis(double least, double most) {
  if (!(least <= most)) return {-1, 0};
  const double room = std::max(0.04 * (most - least), 0.5 * (0.8 - (most - least)));
  return {least - room, most + room};
}

std::array<double, 2> linear_axis(double least, double most) {
  if (!(least <= most)) return {0, 1};
  const double room = most > least ? 0.04 * (most - least) : 0.05 * std::max(std::abs(most), 1e-12);
  return {least - room, most + room};
}

void draw_marker(cairo_t* pen, const Vec2& at, std::size_t style, std::uint32_t rgb) {
  cairo_new_path(pen);
  const auto polygon = [&](int corners, double turn, double radius) {
    for (int i = 0; i < corners; ++i) {
      const double angle = turn + 2 * pi * i / corners;
      cairo_line_to(pen, at.x() + radius * std::sin(angle), at.y() - radius * std::cos(angle));
    }
    cairo_close_path(pen);
  };
  switch (style % 5) {
    case 0:
      cairo_arc(pen, at.x(), at.y(), marker, 0, 2 * pi);
      break;
    case 1:
      polygon(4, pi / 4, 1.3 * marker);
      break;
    case 2:
      polygon(3, 0, 1.4 * marker);
      break;
    case 3:
      polygon(4, 0, 1.4 * marker);
      break;
    default:
      polygon(3, pi, 1.4 * marker);
  }
  color(pen, rgb);
  cairo_fill_preserve(pen);
  stroke(pen, 1.5, paper);
}

void draw_line(cairo_t* pen, const std::vector<Vec2>& pixels, const std::vector<Vec2>& markers, const Series& s) {
  const std::uint32_t rgb = palette[s.style % palette.size()];
  const std::array<double, 2> dashes{11, 9}, dots{3, 5};
  cairo_new_path(pen);
  for (const Vec2& p : pixels) cairo_line_to(pen, p.x(), p.y());
  if (s.dashed || s.dotted) cairo_set_dash(pen, s.dashed ? dashes.data() : dots.data(), 2, 0);
  stroke(pen, 3, rgb, s.dashed ? 0.75 : 1);
  cairo_set_dash(pen, nullptr, 0, 0);
  for (const Vec2& p : markers) draw_marker(pen, p, s.style, rgb);
}

/// One axis: `along` 0 is x, 1 is y. Returns the width of its widest label.
double draw_axis(cairo_t* pen, const Frame& frame, int along, const Font& font) {
  const bool linear = along == 1 && frame.linear_y;
  LogTicks marks = linear ? LogTicks{ticks(frame.low[along], frame.high[along], most_ticks), {}}
                          : log_ticks(std::pow(10, frame.low[along]), std::pow(10, frame.high[along]), most_ticks);
  if (frame.linear_y && along == 0)  // beside plain values, plain times
    for (std::size_t i = 0; i < marks.major.at.size(); ++i) marks.major.labels[i] = pretty(marks.major.at[i]);
  const Box& plot = frame.plot;
  const auto at = [&](double value) {
    Vec2 p = frame.low;
    p[along] = linear ? value : std::log10(value);
    return frame.place(p);
  };
  const Vec2 outwards = along == 0 ? Vec2(0, 1) : Vec2(-1, 0);
  double widest = 0;
  for (const double value : marks.minor)
    line(pen, at(value), at(value) + 0.5 * tick_length * outwards, 1.2, frame_gray);
  for (std::size_t i = 0; i < marks.major.at.size(); ++i) {
    const Vec2 p = at(marks.major.at[i]);
    line(pen, p, along == 0 ? Vec2(p.x(), plot.y) : Vec2(plot.x + plot.width, p.y()), 1.2, grid_gray);
    line(pen, p, p + tick_length * outwards, 1.6, frame_gray);
    const Vec2 text = p + (tick_length + tick_gap + (along == 0 ? 0.5 * font.size : 0)) * outwards;
    write(pen, text, marks.major.labels[i], font, {along == 0 ? 0.5 : 1.0});
    widest = std::max(widest, text_width(pen, marks.major.labels[i], font));
  }
  return widest;
}

/// How many of the points on these lines lie in the box: corners and twenty places between each two.
int crossings(const Box& box, const std::vector<std::vector<Vec2>>& lines) {
  int count = 0;
  for (const auto& line : lines)
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
      for (int k = 0; k <= 20; ++k) {
        const Vec2 p = line[i] + k / 20.0 * (line[i + 1] - line[i]) - Vec2(box.x, box.y);
        count += p.minCoeff() >= 0 && p.x() <= box.width && p.y() <= box.height;
      }
  return count;
}

/// A fan from one point in the corner with the least in the way; falling lines belong to the lower left, rising ones to
/// the lower right if there is a choice.
void draw_slopes(cairo_t* pen, const Frame& frame, const std::vector<Slope>& slopes,
                 const std::vector<std::vector<Vec2>>& lines, const Font& font) {
  const Box& plot = frame.plot;
  const Vec2 unit(plot.width / (frame.high - frame.low).x(), plot.height / (frame.high - frame.low).y());
  const double width = 0.36 * plot.width, height = 0.3 * plot.height, gap = 0.02 * plot.width;
  const std::array<double, 2> dots{2, 6};
  for (const Slope& s : slopes) {
    const bool falls = s.exponent < 0;
    const double left = plot.x + gap, right = plot.x + plot.width - gap - width;
    const double top = plot.y + gap, bottom = plot.y + plot.height - gap - height;
    std::array<Box, 4> corners{{{left, bottom, width, height},
                                {right, bottom, width, height},
                                {left, top, width, height},
                                {right, top, width, height}}};
    if (!falls) std::swap(corners[0], corners[1]);
    const Box& box = *std::min_element(corners.begin(), corners.end(), [&](const Box& a, const Box& b) {
      return crossings(a, lines) < crossings(b, lines);
    });
    const double side = falls ? 1 : -1;
    const Vec2 from(falls ? box.x : box.x + width, box.y);
    Vec2 step(side, std::abs(s.exponent) * unit.y() / unit.x());
    step *= std::min((height - font.size) / step.y(), 0.55 * width);
    const Vec2 to = from + step;
    cairo_new_path(pen);
    cairo_move_to(pen, from.x(), from.y());
    cairo_line_to(pen, to.x(), to.y());
    cairo_set_dash(pen, dots.data(), 2, 0);
    stroke(pen, 2.4, gray);
    cairo_set_dash(pen, nullptr, 0, 0);
    write(pen, to + Vec2(6 * side, 0.35 * font.size), s.name, font, {falls ? 0.0 : 1.0, gray});
  }
}

/// The points of every series on the axes, and what they span.
struct Data {
  std::vector<std::vector<Vec2>> lines;
  Vec2 least = Vec2::Constant(infinity), most = -least;
  int named = 0;
  double legend_width = 0;
};

Data collect(const Chart& chart, const Measure& measure) {
  Data data;
  for (const Series& s : chart.series) {
    data.lines.push_back(on_axes(s, chart.linear_y));
    for (const Vec2& p : data.lines.back()) {
      data.least = data.least.cwiseMin(p);
      data.most = data.most.cwiseMax(p);
    }
    if (data.lines.back().empty()) continue;
    ++data.named;
    data.legend_width = std::max(data.legend_width, legend_line + 12 + measure(clean_text(s.name), legend));
  }
  return data;
}

Frame frame_of(const Data& data, bool linear_y, double top) {
  const auto x = axis(data.least.x(), data.most.x());
  const auto y = linear_y ? linear_axis(data.least.y(), data.most.y()) : axis(data.least.y(), data.most.y());
  const double height = std::max(plot_height, legend_pitch * data.named);
  return {{chart_margin + 150, top, chart_plot_width, height}, {x[0], y[0]}, {x[1], y[1]}, linear_y};
}

/// The series with their names to the right of the plot.
void draw_series(cairo_t* pen, const Box& plot, const std::vector<Series>& series,
                 const std::vector<std::vector<Vec2>>& pixels) {
  double entry = plot.y + 0.5 * legend_pitch;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i].empty()) continue;
    const Series& s = series[i];
    draw_line(pen, pixels[i], s.marked_at_end ? std::vector{pixels[i].back()} : pixels[i], s);
    const double from = plot.x + plot.width + legend_gap;
    draw_line(pen, {{from, entry}, {from + legend_line, entry}}, {{from + 0.5 * legend_line, entry}}, s);
    write(pen, {from + legend_line + 12, entry}, clean_text(s.name), legend);
    entry += legend_pitch;
  }
}

}  // namespace

void draw(const std::filesystem::path& path, const Chart& chart) {
  const Measure measure = ruler();
  Data data = collect(chart, measure);
  const double page_width = chart_margin + 150 + chart_plot_width + legend_gap + data.legend_width + chart_margin;
  const Heading head = heading(chart.title, chart.subtitle, page_width - 2 * chart_margin, 2, measure);
  const Frame frame = frame_of(data, chart.linear_y, head.bottom(chart_margin) + 18);
  const Box& plot = frame.plot;
  const double label_y = plot.y + plot.height + tick_length + tick_gap + tick.size + 10;
  const Lines x_label = wrap(chart.x_label, label, {plot.width, 18, 1}, measure);
  const std::string note = chart.linear_y ? ticks(frame.low.y(), frame.high.y(), most_ticks).note : "";
  const Lines y_label = wrap(with_note(chart.y_label, note), label, {plot.height, 18, 1}, measure);

  const Sheet page = page_with(head, chart_margin, static_cast<int>(page_width),
                               static_cast<int>(label_y + x_label.height() + chart_margin));
  cairo_t* pen = page.pen();
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
  draw_axis(pen, frame, 0, tick);
  const double widest = draw_axis(pen, frame, 1, tick);
  draw_frame(pen, plot);
  write_block(pen, {plot.x + 0.5 * plot.width, label_y}, x_label, {0.5});
  write_block(pen, {plot.x - tick_length - tick_gap - widest - 14 - y_label.height(), plot.y + 0.5 * plot.height},
              y_label, {0.5, ink, true});
  for (auto& points : data.lines)
    for (Vec2& p : points) p = frame.place(p);
  draw_slopes(pen, frame, chart.slopes, data.lines, legend);
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
  draw_series(pen, plot, chart.series, data.lines);
  if (data.named == 0)
    write(pen, {plot.x + 0.5 * plot.width, plot.y + 0.5 * plot.height}, "no points to draw", label, {0.5, gray});
  save(path, page);
}

}  // namespace kerf
