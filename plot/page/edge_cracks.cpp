// The section of edge cracks: the worst places of the boundary, critical lengths, cycles and intervals between
// inspections, what is not covered, and the cracks that were drawn to prove it.

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

namespace {

std::string worst_table(const EdgeCrackResult& e, const Units& units) {
  const std::string of_K = unit(units, dimension::stress_intensity);
  std::vector<std::string> head{"",
                                "at",
                                "K" + (of_K.empty() ? "" : " [" + escape_html(of_K) + "]"),
                                "K<sub>I</sub>",
                                "K<sub>II</sub>",
                                "degrees",
                                "faces",
                                "good up to"};
  if (!e.law.empty())
    for (const char* column : {"critical length", "cycles", "inspect every"}) head.emplace_back(column);
  std::vector<std::vector<std::string>> rows;
  for (const EdgeCrackResult::Row& row : e.worst) {
    const inspect::EdgeCrack& crack = row.crack;
    const bool masked = crack.masked != inspect::Masked::No;
    std::vector<std::string>& cells = rows.emplace_back();
    cells = {std::to_string(rows.size()),
             at_place(crack.at),
             pretty(crack.K),
             pretty(crack.K_I),
             pretty(crack.K_II),
             fmt::format("{:.0f}{}", crack.angle * 180 / pi, crack.flattest() && !e.angle ? " or flatter" : ""),
             masked         ? fmt::format("masked: {}", word(crack.masked))
             : crack.closed ? "closed"
                            : "open",
             pretty(crack.valid_length)};
    if (e.law.empty()) continue;
    const inspect::Tolerance& t = row.tolerance;
    const bool rests = t.how == inspect::Tolerated::Rests;
    const std::string at_least = t.how == inspect::Tolerated::AtLeast ? "&ge; " : "";
    const auto cycles = [&](double n) {
      return rests ? std::string("rests") : std::isfinite(n) ? at_least + pretty(n) : std::string();
    };
    cells.push_back(std::isfinite(t.critical_length) ? pretty(t.critical_length) : std::string());
    cells.push_back(cycles(t.cycles));
    cells.push_back(cycles(t.interval));
  }
  return table(head, rows);
}

std::string drawn_table(const EdgeCrackResult& e) {
  std::vector<std::vector<std::string>> rows;
  for (const inspect::DrawnPlace& place : e.drawn)
    for (const inspect::DrawnEdge& row : place.rows)
      rows.push_back({at_place(place.crack.at), pretty(row.length), pretty(row.K_I), pretty(row.predicted_I),
                      pretty(row.K_II), pretty(row.predicted_II), pretty(row.first_order),
                      std::isfinite(row.error) ? fmt::format("{:.2g} %", 100 * row.error) : std::string(),
                      row.valid ? std::string(word(place.verdict)) : "too long"});
  return table({"at", "length", "K<sub>I</sub> drawn", "predicted", "K<sub>II</sub> drawn", "predicted", "first order",
                "off by", ""},
               rows);
}

}  // namespace

std::string edge_cracks_section(const EdgeCrackResult& e, const Units& units) {
  std::string out = "<h2>Edge cracks</h2>\n";
  out += fmt::format(
      "<p>A crack of length {} that begins at any of {} places of the boundary{}; {:.0f} % of the boundary is masked "
      "(corners, supports, narrow parts). edge_cracks.csv has all places, edge_cracks.png shows them.</p>\n",
      pretty(e.length), e.places,
      e.angle ? fmt::format(", at {:g} degrees to it", *e.angle * 180 / pi) : ", in the worst direction",
      100 * e.masked_share);
  if (!e.law.empty())
    out += e.safe ? fmt::format(
                        "<p>No crack shorter than <b>{}</b> is critical, first at {}; on {:.0f} % of the "
                        "boundary that is not known. Law: {}; intervals are cycles over {:g}.</p>\n",
                        pretty(e.safe->value), at_place(e.safe->at), 100 * e.open_share, escape_html(e.law), e.factor)
                  : fmt::format(
                        "<p>No crack is critical as far as the expansion holds; on {:.0f} % of the boundary "
                        "nothing is known. Law: {}; intervals are cycles over {:g}.</p>\n",
                        100 * e.open_share, escape_html(e.law), e.factor);
  if (!e.worst.empty()) out += worst_table(e, units);
  if (!e.inside.empty()) {
    const inspect::InteriorCrack& worst = e.inside.front();
    out += fmt::format(
        "<p>Inside the body, two lengths from all sides, the worst crack of that length has K {} at {}, direction "
        "{:.0f} degrees{}.</p>\n",
        pretty(worst.K), at_place(worst.at), worst.direction * 180 / pi, worst.closed ? ", closed" : "");
  }
  if (!e.drawn.empty()) {
    out += "<h3>Cracks that were drawn</h3>\n" + drawn_table(e);
    for (const inspect::DrawnPlace& place : e.drawn)
      out +=
          fmt::format("<p>{}: {}: {}.</p>\n", at_place(place.crack.at), word(place.verdict), escape_html(place.reason));
  }
  return out;
}

}  // namespace kerf
