// The section of intervals: quantity, place, lower and upper end, the half width as a share of the value, whether it is
// guaranteed, and the interval drawn. All intervals of a quantity are drawn on one line from 0 to the farthest end, so
// that their widths can be compared with the quantity itself; none is thinner than two pixels. Notes are said once,
// below. docs/theory/guarantees.md, "Intervals".

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

struct Row {
  std::string quantity, where;  // HTML
  const Bounded* of;
  Dimension dimension;
};

/// "s_xx" as HTML.
std::string with_index(std::string_view name) {
  const std::size_t bar = name.find('_');
  return bar == std::string_view::npos ? std::string(name)
                                       : fmt::format("{}<sub>{}</sub>", name.substr(0, bar), name.substr(bar + 1));
}

std::string where(const BoundedMean& m) {
  switch (m.of) {
    case BoundedMean::Of::Disc:
      return fmt::format("mean over the disc {}, radius {}", at_place(m.from), pretty(m.radius));
    case BoundedMean::Of::Line:
      return fmt::format("mean along {} to {}", at_place(m.from), at_place(m.to));
    case BoundedMean::Of::Displacement:
      return fmt::format("mean of {}", escape_html(m.on));
    case BoundedMean::Of::Reaction:
      return fmt::format("support of {}", escape_html(m.on));
    case BoundedMean::Of::Loads:
      return "all loads";
  }
  return {};
}

std::vector<Row> rows_of(const BoundsResult& bounds, const std::optional<Dimension>& functional) {
  std::vector<Row> rows;
  for (const BoundedTip& t : bounds.tips) {
    const std::string where =
        fmt::format("{}, {} {}", escape_html(t.crack), t.at_start ? "start" : "end", at_place(t.at));
    rows.push_back({"K<sub>I</sub>", where, &t.K_I, dimension::stress_intensity});
    rows.push_back({"K<sub>II</sub>", where, &t.K_II, dimension::stress_intensity});
    rows.push_back({"G", where, &t.G, dimension::release_rate});
  }
  for (const BoundedPoint& p : bounds.points) {
    const std::string where = at_place(p.at);
    rows.push_back({"s<sub>xx</sub>", where, &p.s_xx, dimension::stress});
    rows.push_back({"s<sub>yy</sub>", where, &p.s_yy, dimension::stress});
    rows.push_back({"s<sub>xy</sub>", where, &p.s_xy, dimension::stress});
    rows.push_back({"von Mises", where, &p.von_mises, dimension::stress});
    if (functional) rows.push_back({"T", where, &p.derivative, per_area(*functional)});
  }
  for (const BoundedMean& m : bounds.means) {
    const std::span<const NamedQuantity> names = quantities_of(m.of);
    for (std::size_t i = 0; i < m.quantities.size(); ++i)
      rows.push_back({with_index(names[i].name), where(m), &m.quantities[i], names[i].dimension});
  }
  return rows;
}

bool known(const Bounded& b) {
  return std::isfinite(b.lower) && std::isfinite(b.upper);
}

/// From 0 to the farthest end of all intervals of the quantity.
struct Span {
  double low = 0, high = 0;
};

/// The interval on that line, with a mark at 0.
std::string drawn(const Bounded& b, const Span& span) {
  constexpr double width = 160, least = 2;  // px
  const double scale = width / std::max(span.high - span.low, 1e-300);
  const double from = (b.lower - span.low) * scale, length = std::max(least, (b.upper - b.lower) * scale);
  return fmt::format(
      "<svg class=\"interval\" width=\"{0:.0f}\" height=\"12\" viewBox=\"0 0 {0:.0f} 12\" role=\"img\" "
      "aria-label=\"from {1} to {2}\"><line x1=\"0\" y1=\"6\" x2=\"{0:.0f}\" y2=\"6\" stroke=\"currentColor\" "
      "stroke-opacity=\".25\"/><line x1=\"{3:.1f}\" y1=\"1\" x2=\"{3:.1f}\" y2=\"11\" stroke=\"currentColor\" "
      "stroke-opacity=\".5\"/><rect x=\"{4:.1f}\" y=\"2\" width=\"{5:.1f}\" height=\"8\" fill=\"currentColor\"/></svg>",
      width, pretty(b.lower), pretty(b.upper), -span.low * scale, std::min(from, width - least), length);
}

}  // namespace

std::string bounds_section(const Result& r) {
  const std::vector<Row> rows = rows_of(*r.bounds, r.functional_dimension);
  std::map<std::string, Span> spans;
  std::size_t guaranteed = 0;
  std::vector<std::string> notes;
  for (const Row& row : rows) {
    const Bounded& b = *row.of;
    guaranteed += b.guaranteed;
    if (!b.note.empty() && std::ranges::find(notes, b.note) == notes.end()) notes.push_back(b.note);
    if (!known(b)) continue;
    Span& span = spans[row.quantity];
    span = {std::min(span.low, b.lower), std::max(span.high, b.upper)};
  }
  std::vector<std::vector<std::string>> cells;
  for (const Row& row : rows) {
    const Bounded& b = *row.of;
    if (!known(b)) {
      cells.push_back({row.quantity, row.where, "–", "–", "–", "", "no"});
      continue;
    }
    const std::string share =
        b.value != 0 ? fmt::format("{} %", pretty(50 * (b.upper - b.lower) / std::abs(b.value), 2)) : "–";
    cells.push_back({row.quantity, row.where, pretty(b.lower), with_unit(b.upper, r.units, row.dimension), share,
                     drawn(b, spans[row.quantity]), b.guaranteed ? "yes" : "no"});
  }
  std::string out = fmt::format(
      "<h2>Bounds</h2>\n<p>The quantity of the exact solution lies between lower and upper where it says guaranteed: "
      "{} "
      "of {}.</p>\n",
      guaranteed, rows.size());
  out += table({"quantity", "at", "lower", "upper", "±", "from 0", "guaranteed"}, cells);
  for (const std::string& text : notes) out += note(text);
  return out;
}

}  // namespace kerf
