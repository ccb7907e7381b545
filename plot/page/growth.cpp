// The section of cracks that grew: slots for lengths and K over the cycles or the steps, and a table of the steps.

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

namespace {

std::string growth_table(const GrowthResult& g) {
  const bool fatigue = g.law != "quasi-static";
  std::vector<std::vector<std::string>> rows;
  const std::size_t stride = (g.steps.size() + most_rows - 1) / most_rows;
  for (std::size_t i = 0; i < g.steps.size(); ++i) {
    const growth::GrowthStep& s = g.steps[i];
    if (i % stride != 0 && i + 1 != g.steps.size()) continue;
    for (const growth::GrownTip& t : s.tips)
      rows.push_back({std::to_string(s.number), pretty(fatigue ? s.cycles : s.load), escape_html(t.name),
                      at_place(t.at), pretty(t.a), pretty(t.K_I), pretty(t.K_II), pretty(t.dK), pretty(t.da)});
  }
  std::string out = table({"step", fatigue ? "cycles" : "load", "tip", "at", "a", "K<sub>I</sub>", "K<sub>II</sub>",
                           fatigue ? "&Delta;K" : "K", "grows by"},
                          rows);
  if (stride > 1) out += fmt::format("<p class=\"dim\">Every {} steps; all of them are in growth.csv.</p>\n", stride);
  return out;
}

}  // namespace

std::string growth_section(const GrowthResult& g, const PageData& data) {
  std::string out = "<h2>Growth</h2>\n";
  const auto bar = [](double error) {
    return std::isfinite(error) ? fmt::format(" &plusmn; {}", pretty(error, 2)) : std::string();
  };
  if (!g.steps.empty() && g.law != "quasi-static")
    out += fmt::format("<p>{} cycles{}: {}.</p>\n", pretty(g.steps.back().cycles), bar(g.cycles_error),
                       escape_html(g.ended));
  else
    out += fmt::format("<p>{}.</p>\n", escape_html(g.ended));
  if (std::isfinite(g.path_error)) out += fmt::format("<p>The path is known to{}.</p>\n", bar(g.path_error));
  for (const std::string& note : g.notes) out += fmt::format("<p class=\"note\">{}</p>\n", escape_html(note));
  if (g.bounds && g.bounds->guaranteed && std::isfinite(g.bounds->cycles.high))
    out +=
        fmt::format("<p>Guaranteed at every step: between {} and {} cycles if K changes one way between steps.</p>\n",
                    pretty(g.bounds->cycles.low), pretty(g.bounds->cycles.high));
  if (const NamedArray* shots = find_array(data.arrays, "growth.shots"))
    out += fmt::format(
        "<figure class=\"view\" id=\"growth\"><div class=\"stage\" role=\"group\" aria-label=\"The body, step by "
        "step\"></div>\n<figcaption>The body at {} of {} steps, its cracks red.</figcaption></figure>\n",
        shots->rows(), g.steps.size());
  if (g.steps.size() > 1) {
    out += "<div class=\"curves\">\n";
    for (const char* id : {"growth-length", "growth-K"})
      out += fmt::format("<figure id=\"history-{}\"><div class=\"plot\"></div></figure>\n", id);
    out += "</div>\n";
  }
  return out + folded("Every step", growth_table(g));
}

}  // namespace kerf
