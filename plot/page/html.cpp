// Pieces of HTML: tables, folded sections, facts, notes, numbers with units.

#include "plot/page/html.hpp"

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

std::string at_place(const Vec2& p) {
  return fmt::format("({}, {})", pretty(p.x()), pretty(p.y()));
}

std::string number_or_dash(const std::optional<double>& v) {
  return v ? pretty(*v) : "–";
}

std::string with_unit(double value, const Units& units, const std::optional<Dimension>& dimension) {
  return pretty(value) + escape_html(with_blank(dimension ? unit(units, *dimension) : std::string()));
}

void Facts::add(const std::string& name, const std::string& value) {
  html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape_html(name), value);
}

std::string Facts::table() const {
  return fmt::format("<div class=\"scroll\"><table class=\"facts\">\n{}</table></div>\n", html);
}

std::string table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& rows,
                  std::span<const std::size_t> words) {
  std::string out = "<div class=\"scroll\"><table>\n<tr>";
  for (const auto& head : heads) out += fmt::format("<th scope=\"col\">{}</th>", head);
  out += "</tr>\n";
  for (const auto& row : rows) {
    out += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k) {
      const bool wraps = std::find(words.begin(), words.end(), k) != words.end();
      out += fmt::format("<td{}>{}</td>", wraps ? " class=\"words\"" : "", row[k]);
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string folded(const std::string& summary, const std::string& html) {
  return fmt::format("<details><summary>{}</summary>\n{}</details>\n", escape_html(summary), html);
}

std::string folded_section(const std::string& title, const std::string& summary, const std::string& html) {
  return fmt::format(
      "<details class=\"section\"><summary><h2>{}</h2> <span class=\"dim\">{}</span></summary>\n{}</details>\n",
      escape_html(title), escape_html(summary), html);
}

void add_peak(Facts& facts, const std::string& name, const Peak& peak, const Units& units, const Dimension& of) {
  const auto placed = [&](const PlacedValue& v) {
    const std::string margin = v.margin && std::isfinite(*v.margin) ? fmt::format(" ± {:.2g}", *v.margin) : "";
    return with_unit(v.value, units, of) + margin + " at " + at_place(v.at);
  };
  if (!peak.singular) return facts.add(name, placed(peak.largest));
  facts.add(name, peak.regular ? placed(*peak.regular) : "only near singular points");
  facts.add(name + ", singular", placed(peak.largest) + " (larger on finer meshes)");
}

void add_reserve(Facts& facts, const ReserveResult& r, const Units& units) {
  const ReserveWords words = words_of(r.of);
  std::string name = fmt::format("reserve against {}", words.against);
  if (!r.region.empty()) name += " in region " + r.region;
  if (!r.crack.empty()) name += ", crack " + r.crack;
  facts.add(name, fmt::format("<b>{}</b>: {} {} of {} at {}", pretty(r.factor, 3), words.quantity, pretty(r.value, 4),
                              with_unit(r.limit, units, words.dimension), at_place(r.at)));
}

std::string note(const std::string& text, bool bad) {
  return fmt::format("<p class=\"note{}\">{}</p>\n", bad ? " bad" : "", escape_html(text));
}

}  // namespace kerf
