// Times of the phases of a run as bars.

#include "plot/page/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

std::string time_bars(const Seconds& s) {
  std::vector<std::pair<std::string, double>> phases;
  for (const TimedPhase& phase : timed_phases)
    if (const double value = s.*phase.of; std::isfinite(value) && value > 0) phases.emplace_back(phase.name, value);
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
    out += fmt::format("<rect x=\"104\" y=\"{}\" width=\"{:.1f}\" height=\"20\" rx=\"2\"/>", y + 5, width);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{}\">{:.3f} s<tspan class=\"dim\"> · {:.0f} %</tspan></text>\n",
                       112 + width, y + 20, value, 100 * value / total);
    y += row;
  }
  return out + "</svg>\n";
}

}  // namespace kerf
