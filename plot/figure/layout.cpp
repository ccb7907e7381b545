// Where everything of a picture of the body stands: plot, ticks, labels, title, color bar, in pixels. The plot has the
// aspect of what is drawn, with some air around it, at most 1600 pixels for plot and sides and 1150 in height (1500
// where the body is upright). Widths of tick labels depend on the size of the plot, and that on the room that labels
// leave: six rounds settle it. A low plot has its color bar below. Texts are broken into lines, then set smaller, and
// cut with "…" where no size fits: one more line comes before letters get smaller than 0.85. Widths of texts come from
// a Measure, so that the layout can be tested without drawing.

#include "plot/figure/layout.hpp"

#include "io/text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double widest = 1600, narrowest = 700, narrowest_for_text = 1000;
constexpr double highest = 1150, highest_of_tall = 1500;
constexpr double least_plot = 90;     // pixels; smaller plots could not carry two tick labels
constexpr double least_beside = 420;  // a lower plot has its color bar below
constexpr double bar_thickness = 34, bar_distance = 44;

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + ' ') {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  return words;
}

/// How many bytes of `text` fit, at least one letter, never half of one.
std::size_t fitting(const std::string& text, const Font& font, double width, const std::string& tail,
                    const Measure& measure) {
  std::size_t good = 0;
  for (std::size_t i = 1; i <= text.size(); ++i) {
    if (i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80) continue;
    if (good > 0 && measure(text.substr(0, i) + tail, font) > width) break;
    good = i;
  }
  return good;
}

std::vector<std::string> broken(const std::string& text, const Font& font, double width, const Measure& measure) {
  std::vector<std::string> lines;
  std::string line;
  for (std::string word : words_of(text)) {
    const std::string longer = line.empty() ? word : line + ' ' + word;
    if (measure(longer, font) <= width) {
      line = longer;
      continue;
    }
    if (!line.empty()) lines.push_back(std::move(line));
    while (measure(word, font) > width) {  // a word longer than a line
      const std::size_t count = fitting(word, font, width, "", measure);
      if (count == word.size()) break;
      lines.push_back(word.substr(0, count));
      word = word.substr(count);
    }
    line = word;
  }
  if (!line.empty()) lines.push_back(std::move(line));
  return lines;
}

Ticks upright_ticks(double low, double high, double length, const Font& font) {
  return ticks(low, high, std::clamp(static_cast<int>(length / (3 * font.size)), 2, 12));
}

double longest(const Ticks& ticks, const Font& font, const Measure& measure) {
  double out = 0;
  for (const auto& label : ticks.labels) out = std::max(out, measure(label, font));
  return out;
}

/// As many as fit side by side; a single one where two would touch.
Ticks level_ticks(double low, double high, double length, const Font& font, const Measure& measure) {
  Ticks out;
  for (int count = std::max(2, static_cast<int>(length / 110)); count >= 2; --count) {
    out = ticks(low, high, count);
    if (out.at.size() < 2) return out;
    const double apart = (out.at[1] - out.at[0]) / (high - low) * length;
    if (longest(out, font, measure) + font.size <= apart) return out;
  }
  const std::size_t middle = out.at.size() / 2;
  out.at = {out.at[middle]};
  out.labels = {out.labels[middle]};
  return out;
}

struct Bounds {
  Vec2 low = Vec2::Constant(infinity);
  Vec2 high = -low;
  void add(const Vec2& p) {
    if (!p.allFinite()) return;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

/// Of what is drawn, with some air around it; never empty, never without extent.
Bounds bounds(const Picture& picture) {
  Bounds out;
  for (const auto& triangle : picture.triangles) {
    for (const Index p : triangle) out.add(picture.points[static_cast<std::size_t>(p)]);
  }
  for (const auto* lines : {&picture.outlines, &picture.cracks}) {
    for (const auto& line : *lines) {
      for (const Vec2& p : line) out.add(p);
    }
  }
  for (const auto& [from, to] : picture.arrows) {
    out.add(from);
    out.add(to);
  }
  if (!out.low.allFinite()) {
    for (const auto& [at, name] : picture.marks) out.add(at);
  }
  if (!out.low.allFinite()) out = {Vec2::Zero(), Vec2::Ones()};
  const double magnitude = std::max(out.low.cwiseAbs().maxCoeff(), out.high.cwiseAbs().maxCoeff());
  // Points that are all one, up to rounding at their distance from the origin, get a size of that distance.
  double extent = (out.high - out.low).maxCoeff();
  if (!(extent > 1e-9 * magnitude)) extent = magnitude > 0 ? magnitude : 1;
  const Vec2 size = (out.high - out.low).cwiseMax(1e-6 * extent);
  const Vec2 air = Vec2::Constant(std::max(0.025 * std::sqrt(size.x() * size.y()), 0.007 * extent));
  const Vec2 middle = 0.5 * out.low + 0.5 * out.high;
  const Vec2 half = 0.5 * size + air;
  return {middle - half, middle + half};
}

std::string with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label + " in " + unit;
}

std::string value_label(const Picture& picture) {
  return with_unit(picture.value_label, picture.dimension ? unit(picture.units, *picture.dimension) : "");
}

}  // namespace

std::string extreme_text(const char* word, double value) {
  return fmt::format("{} {}", word, pretty(value, 3));
}

std::string with_note(const std::string& label, const std::string& note) {
  return note.empty() ? label : label.empty() ? note : fmt::format("{} ({})", label, note);
}

Lines wrap(const std::string& text, Font font, const TextRoom& room, const Measure& measure) {
  const auto& [width, smallest, most] = room;
  const std::string clean = clean_text(text);
  for (std::size_t count = 1; count <= most; ++count) {
    // One more line before the letters get much smaller.
    const double end = count < most ? std::max(smallest, 0.85 * font.size) : smallest;
    for (Font f = font; f.size >= end; f.size -= 1) {
      std::vector<std::string> lines = broken(clean, f, width, measure);
      if (lines.size() <= count) return {std::move(lines), f};
    }
  }
  font.size = smallest;
  std::vector<std::string> lines = broken(clean, font, width, measure);
  lines.resize(most);
  lines.back() = lines.back().substr(0, fitting(lines.back(), font, width, " …", measure)) + " …";
  return {std::move(lines), font};
}

namespace {

const Font axis_font{26, false, true}, label_font{26};

double outside(const Layout& out) {
  return out.tick_length + out.tick_gap;
}

bool has_bar_beside(const Layout& out) {
  return out.has_bar && out.beside;
}

double bar_length_beside(const Layout& out, const Limits& limits) {
  return out.plot.height - out.point * (limits.below() + limits.above());
}

/// The values and the label of a bar beside the plot; returns what they need to the right of it.
double fit_bar_beside(Layout& out, const Picture& picture, const Limits& limits, const Measure& measure) {
  out.values = upright_ticks(limits.low, limits.high, bar_length_beside(out, limits), out.tick);
  double extreme = 0;
  if (limits.below()) extreme = measure(extreme_text("min", limits.least), out.extreme);
  if (limits.above()) extreme = std::max(extreme, measure(extreme_text("max", limits.most), out.extreme));
  // The label stands between the words at the ends.
  out.label_gap = outside(out) + longest(out.values, out.tick, measure) + 14;
  const double label_length = out.plot.height - (extreme > 0 ? 4 * out.point : 0);
  out.value_label = wrap(with_note(value_label(picture), out.values.note), label_font, {label_length, 17, 2}, measure);
  return bar_distance + bar_thickness + out.margin +
         std::max(out.label_gap + out.value_label.height(), outside(out) + extreme);
}

struct Sides {
  double left, right;  // of the plot
};

/// The size of the plot and its ticks, and what stands to the left and to the right of it.
Sides fit_plot(Layout& out, const Picture& picture, const Limits& limits, const Measure& measure) {
  const Bounds view = bounds(picture);
  const Vec2 size = view.high - view.low;
  const Vec2 middle = 0.5 * view.low + 0.5 * view.high;
  const double top_height = size.x() < 0.6 * size.y() ? highest_of_tall : highest;
  // The labels' widths depend on the size of the plot and the other way round: a few rounds settle it.
  Sides sides{160, out.has_bar ? 240.0 : 60.0};
  for (int round = 0; round < 6; ++round) {
    const double room = widest - sides.left - sides.right;
    out.scale = std::min(room / size.x(), top_height / size.y());
    out.plot.width = std::max(least_plot, std::round(size.x() * out.scale));
    out.plot.height = std::max(least_plot, std::round(size.y() * out.scale));
    const Vec2 half = Vec2(out.plot.width, out.plot.height) / (2 * out.scale);
    out.low = middle - half;
    const Vec2 high = middle + half;
    out.x = level_ticks(out.low.x(), high.x(), out.plot.width, out.tick, measure);
    out.y = upright_ticks(out.low.y(), high.y(), out.plot.height, out.tick);
    out.beside = out.beside && out.plot.height >= least_beside;

    sides.left = out.margin + 1.3 * axis_font.size + 8 + longest(out.y, out.tick, measure) + outside(out);
    sides.right = std::max(out.margin, 0.5 * longest(out.x, out.tick, measure) + 14);
    if (has_bar_beside(out)) {
      sides.right = fit_bar_beside(out, picture, limits, measure);
    } else if (out.has_bar) {
      out.values = level_ticks(limits.low, limits.high, out.plot.width, out.tick, measure);
      sides.right = std::max(sides.right, 0.5 * longest(out.values, out.tick, measure) + 14);
    }
  }
  return sides;
}

/// The width of the page, where the plot lies across it, title and subtitle above.
void place_heading(Layout& out, const Picture& picture, const Sides& sides, const Measure& measure) {
  const double needed = sides.left + out.plot.width + sides.right;
  const Font title{38, true}, subtitle{26};
  const double text =
      std::max(measure(clean_text(picture.title), title), measure(clean_text(picture.subtitle), subtitle));
  const double width = std::ceil(std::max({needed, narrowest, std::min(text + 2 * out.margin, narrowest_for_text)}));
  out.width = static_cast<int>(width);
  out.plot.x = std::round(sides.left + 0.5 * (width - needed));

  // Title and subtitle start above the plot if that leaves them on one line each, else at the margin.
  const double text_x = out.plot.x + text + out.margin <= width ? out.plot.x : out.margin;
  const double text_width = width - text_x - out.margin;
  out.title = wrap(picture.title, title, {text_width, 24, 3}, measure);
  out.subtitle = wrap(picture.subtitle, subtitle, {text_width, 19, 3}, measure);
  out.title_x = text_x;
}

/// The color bar beside the plot, or below it from `y` on. Returns where the page ends.
double place_bar(Layout& out, const Picture& picture, const Limits& limits, double y, const Measure& measure) {
  if (out.beside) {
    out.bar = {out.plot.x + out.plot.width + bar_distance, out.plot.y + (limits.above() ? out.point : 0), bar_thickness,
               bar_length_beside(out, limits)};
    return y;
  }
  const double width = out.width, length = std::max(out.plot.width, 600.0);  // room for labels below a tiny plot
  const double x = std::clamp(out.plot.x + 0.5 * (out.plot.width - length), out.margin + 20, width - length);
  out.bar = {std::round(x) + (limits.below() ? out.point : 0), std::round(y + 20),
             length - out.point * (limits.below() + limits.above()), bar_thickness};
  out.values = level_ticks(limits.low, limits.high, out.bar.width, out.tick, measure);
  out.value_label =
      wrap(with_note(value_label(picture), out.values.note), label_font, {width - 2 * out.margin, 17, 2}, measure);
  out.label_gap = outside(out) + out.tick.size + 8;
  return out.bar.y + out.bar.height + out.label_gap + out.value_label.height();
}

}  // namespace

Layout lay_out(const Picture& picture, const Limits& limits, const Measure& measure) {
  Layout out;
  out.has_bar = picture.values.cols() > 0;
  place_heading(out, picture, fit_plot(out, picture, limits, measure), measure);
  double y = out.margin + out.title.height() + out.subtitle.height();
  if (y > out.margin) y += 18;
  out.plot.y = std::round(y);
  y = out.plot.y + out.plot.height + outside(out) + out.tick.size + 10;
  out.x_label = wrap(with_note(with_unit("x", unit(picture.units, dimension::length)), out.x.note), axis_font,
                     {out.width - 2 * out.margin, 15, 1}, measure);
  out.y_label = wrap(with_note(with_unit("y", unit(picture.units, dimension::length)), out.y.note), axis_font,
                     {out.plot.height + 60, 15, 1}, measure);
  out.x_label_y = y;
  y += out.x_label.height();
  if (out.has_bar) y = place_bar(out, picture, limits, y, measure);
  out.height = static_cast<int>(std::ceil(y + 0.6 * out.margin));
  return out;
}

}  // namespace kerf
