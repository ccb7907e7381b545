#include "plot/page/svg.hpp"

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

std::string time_bars(const Seconds& s) {
  std::vector<std::pair<std::string, double>> phases;
  for (const auto& [name, value] :
       {std::pair("mesh", s.mesh), std::pair("assemble", s.assemble), std::pair("factor", s.factor),
        std::pair("solve", s.solve), std::pair("contact", s.contact), std::pair("map", s.map),
        std::pair("validate", s.validate), std::pair("optimize", s.optimize), std::pair("output", s.output)}) {
    if (std::isfinite(value) && value > 0) phases.emplace_back(name, value);
  }
  if (phases.empty()) return {};
  std::stable_sort(phases.begin(), phases.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  double sum = 0;
  for (const auto& phase : phases) sum += phase.second;
  const double total = std::isfinite(s.total) && s.total > 0 ? s.total : sum, longest = phases.front().second;
  const int row = 30;
  std::string out = fmt::format(
      "<svg class=\"bars\" viewBox=\"0 0 720 {}\" role=\"img\" aria-label=\"Time per phase\">\n", row * phases.size());
  int y = 0;
  for (const auto& [name, value] : phases) {
    const double width = std::max(1.5, 420 * value / longest);
    out += fmt::format("<text x=\"92\" y=\"{}\" text-anchor=\"end\">{}</text>", y + 20, name);
    out += fmt::format("<rect x=\"104\" y=\"{}\" width=\"{:.1f}\" height=\"20\" rx=\"2\" fill=\"#2a788e\"/>", y + 5,
                       width);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{}\">{:.3f} s<tspan class=\"dim\"> · {:.0f} %</tspan></text>\n",
                       112 + width, y + 20, value, 100 * value / total);
    y += row;
  }
  return out + "</svg>\n";
}

namespace {

struct Frame {
  double x0, x1, y0, y1;                // of the plot, in drawing units
  double low_x, high_x, low_y, high_y;  // of the values
  double x(double v) const {
    return x0 + (v - low_x) / (high_x - low_x) * (x1 - x0);
  }
  double y(double v) const {
    return y1 - (v - low_y) / (high_y - low_y) * (y1 - y0);
  }
};

std::string axes(const Frame& f, const std::string& label) {
  const Ticks x = ticks(f.low_x, f.high_x, 8), y = ticks(f.low_y, f.high_y, 6);
  std::string out;
  for (std::size_t i = 0; i < y.at.size(); ++i) {
    out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", f.x0, f.y(y.at[i]), f.x1);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", f.x0 - 8, f.y(y.at[i]) + 5,
                       y.labels[i]);
  }
  for (std::size_t i = 0; i < x.at.size(); ++i) {
    out += fmt::format("<path class=\"axis\" d=\"M{0:.1f} {1:.1f}v5\"/>", f.x(x.at[i]), f.y1);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", f.x(x.at[i]), f.y1 + 22,
                       x.labels[i]);
  }
  const auto note = [](const std::string& text) { return text.empty() ? text : fmt::format(" ({})", text); };
  out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">arc length{}</text>", 0.5 * (f.x0 + f.x1),
                     f.y1 + 44, note(x.note));
  out += fmt::format("<text x=\"{:.1f}\" y=\"18\" class=\"name\">{}{}</text>", f.x0, escape_html(label), note(y.note));
  out += fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>\n", f.x0, f.y0, f.y1, f.x1);
  return out;
}

}  // namespace

std::string crack_curve(const CrackResult& crack, const CrackCurve& curve) {
  std::vector<Vec2> points;  // arc length, value
  double low = 0, high = 0;
  for (const CrackRow& row : crack.rows) {
    const double value = curve.value(row);
    if (std::isfinite(row.s) && std::isfinite(value)) points.emplace_back(row.s, value);
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (points.size() < 2 || !(points.back().x() > points.front().x())) return {};
  if (!(high > low)) high = low + 1;
  const double air = 0.05 * (high - low);
  const Frame f{
      86, 700, 34, 210, points.front().x(), points.back().x(), low < 0 ? low - air : 0, high > 0 ? high + air : 0};

  std::string out =
      fmt::format("<svg class=\"curve\" viewBox=\"0 0 720 262\" role=\"img\" aria-label=\"{} along {}\">\n",
                  escape_html(curve.label), escape_html(crack.name));
  // A closed stretch reaches half way to the open neighbors of its first and last row.
  for (std::size_t i = 0; i < crack.rows.size();) {
    std::size_t end = i;
    while (end < crack.rows.size() && crack.rows[end].closed == crack.rows[i].closed) ++end;
    if (crack.rows[i].closed) {
      const double from = i == 0 ? f.low_x : 0.5 * (crack.rows[i - 1].s + crack.rows[i].s);
      const double to = end == crack.rows.size() ? f.high_x : 0.5 * (crack.rows[end - 1].s + crack.rows[end].s);
      if (to > from) {
        out += fmt::format("<rect class=\"closed\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                           f.x(from), f.y0, f.x(to) - f.x(from), f.y1 - f.y0);
      }
    }
    i = end;
  }
  out += axes(f, curve.label);
  out +=
      fmt::format("<path fill=\"none\" stroke=\"{}\" stroke-width=\"2.2\" stroke-linejoin=\"round\" d=\"", curve.color);
  for (std::size_t i = 0; i < points.size(); ++i) {
    out += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", f.x(points[i].x()), f.y(points[i].y()));
  }
  return out + "\"/>\n</svg>\n";
}

}  // namespace kerf
