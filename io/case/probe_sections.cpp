// [[probe]]: points by a list, by a file, or evenly along a line.

#include "io/case/sections.hpp"
#include "io/case/table.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

void read_probes(const Value& document, const std::filesystem::path& folder, Case& c) {
  for (const Value& entry : find_tables(document, "probe")) {
    allow_only(entry);
    Probe probe{new_name(need(entry, "name"), c.probes), {}};
    const std::string kind = one_of(entry);
    for (const char* key : {"to", "count"})
      if (const auto extra = find(entry, key); extra && kind != "from")
        fail(extra->node->position, fmt::format("{} goes with from, not with {}", extra->name, kind));
    if (kind == "points") {
      probe.points = points(need(entry, "points"), 1);
    } else if (kind == "file") {
      const Value file = need(entry, "file");
      for (const std::vector<double>& row : read_table(folder / text(file), file, {"x", "y"}))
        probe.points.emplace_back(row[0], row[1]);
    } else {
      const Vec2 from = point(need(entry, "from")), to = point(need(entry, "to"));
      const int count = whole_number(need(entry, "count"));
      for (int k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) / (count - 1);
        probe.points.push_back((1 - t) * from + t * to);
      }
    }
    take(entry, "bounds", probe.bounds);
    if (probe.bounds && probe.points.size() > Probe::most_bounded)
      fail(need(entry, "bounds").node->position, fmt::format("bounds in [[probe]] is for {} points at most, not {}",
                                                             Probe::most_bounded, probe.points.size()));
    c.probes.push_back(std::move(probe));
  }
}

}  // namespace kerf
