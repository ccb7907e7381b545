#include "cases/sections.hpp"
#include "cases/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

namespace {

constexpr int most_points = 1000000;

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  const std::string_view spaces = " \t\r\"";
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    const std::size_t first = std::min(cell.find_first_not_of(spaces), cell.size());
    cell = cell.substr(first);
    cells.push_back(cell.substr(0, cell.find_last_not_of(spaces) + 1));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// A comma-separated table whose first line names its columns; x and y are taken, others are left alone.
std::vector<Vec2> read_points(const std::filesystem::path& path, const Field& field) {
  std::string text;
  try {
    text = read_text(path);
  } catch (const Error& e) {
    throw Error(e.fault, fmt::format("{}: {}: {}", to_string(field.node->position), field.name, e.what()));
  }
  const auto bad = [&](int line, const std::string& what) {
    throw Error(Fault::Usage, fmt::format("{}:{}:1: {}", path.string(), line, what));
  };
  std::vector<Vec2> points;
  std::size_t columns = 0, column[2] = {0, 0};
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const auto cells = split(line);
    if (columns == 0) {
      columns = cells.size();
      for (const int d : {0, 1}) {
        const auto found = std::find(cells.begin(), cells.end(), d == 0 ? "x" : "y");
        if (found == cells.end()) bad(number, "the first line must name the columns, x,y among them");
        column[d] = static_cast<std::size_t>(found - cells.begin());
      }
      continue;
    }
    if (cells.size() != columns) bad(number, fmt::format("{} cells instead of {}", cells.size(), columns));
    Vec2 point;
    for (const int d : {0, 1}) {
      const std::string_view cell = cells[column[d]];
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), point[d]);
      if (error != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(point[d]))
        bad(number, fmt::format("{} is not a finite number", quote(cell)));
    }
    points.push_back(point);
  }
  if (points.empty()) bad(std::max(number, 1), "there is no point; give a line x,y and a line per point");
  return points;
}

}  // namespace

void read_probes(const Field& document, const std::filesystem::path& folder, Case& c) {
  for (const Field& entry : find_tables(document, "probe")) {
    allow_only(entry, {"name", "points", "from", "to", "count", "file"});
    const Field name = need(entry, "name");
    Probe probe{safe_name(name), {}};
    for (const Probe& other : c.probes)
      if (other.name == probe.name)
        fail(name.node->position,
             fmt::format("{}: the name {} is taken; give each its own", name.name, quote(probe.name)));
    const std::string kind = one_of(entry, {"points", "from", "file"});
    for (const char* key : {"to", "count"})
      if (const auto extra = find(entry, key); extra && kind != "from")
        fail(extra->node->position, fmt::format("{} goes with from, not with {}", extra->name, kind));
    if (kind == "points") {
      probe.points = points(need(entry, "points"), 1);
    } else if (kind == "file") {
      const Field file = need(entry, "file");
      probe.points = read_points(folder / text(file), file);
    } else {
      const Vec2 from = point(need(entry, "from")), to = point(need(entry, "to"));
      const int count = whole_number(need(entry, "count"), 2, most_points);
      for (int k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) / (count - 1);
        probe.points.push_back((1 - t) * from + t * to);
      }
    }
    c.probes.push_back(std::move(probe));
  }
}

}  // namespace kerf
