// The section of a history of loads: slots for its curves and a table of its steps.

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

namespace kerf {

namespace {

std::string steps_table(const std::vector<StepResult>& steps) {
  std::vector<std::string> heads{"step", "name"};
  for (const auto& [name, value] : steps.front().values) heads.push_back(escape_html(name));
  for (const char* head : {"strain energy", "work", "taken by friction", "open", "closed", "sticks", "slides"})
    heads.emplace_back(head);
  for (const StepResult::Tip& tip : steps.front().tips) {
    const std::string of = fmt::format(" of {} at {}", escape_html(tip.crack), at_place(tip.at));
    heads.push_back("K<sub>I</sub>" + of);
    heads.push_back("K<sub>II</sub>" + of);
  }
  const std::vector<double> places = places_in_history(steps);
  const std::size_t stride = (steps.size() + most_rows - 1) / most_rows;
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const StepResult& s = steps[i];
    if (i % stride != 0 && i + 1 != steps.size()) continue;
    std::vector<std::string> row{pretty(places[i]), escape_html(s.name)};
    for (const auto& [name, value] : s.values) row.push_back(pretty(value));
    for (const double value :
         {s.strain_energy, s.work, s.dissipation, s.open_length, s.closed_length, s.stick_length, s.slip_length})
      row.push_back(pretty(value));
    for (const StepResult::Tip& tip : s.tips)
      for (const auto& K : {tip.K_I, tip.K_II}) row.push_back(number_or_dash(K));
    rows.push_back(std::move(row));
  }
  std::string out = table(heads, rows);
  if (stride > 1) out += fmt::format("<p class=\"dim\">Every {} steps; all of them are in steps.csv.</p>\n", stride);
  return out;
}

}  // namespace

std::string steps_section(const Result& r) {
  std::string out = "<h2>Steps</h2>\n";
  if (r.steps.size() > 1) {
    out += "<div class=\"curves\">\n";
    std::vector<const char*> ids{"step-energy", "step-length"};
    if (!r.steps.front().tips.empty()) ids.insert(ids.end(), {"step-K_I", "step-K_II"});
    for (const char* id : ids)
      out += fmt::format("<figure id=\"history-{}\"><div class=\"plot\"></div></figure>\n", id);
    out += "</div>\n";
  }
  return out + folded("Every step", steps_table(r.steps));
}

}  // namespace kerf
