// Columns of numbers from a CSV file, picked by the names in its first line; every cell must be a finite number.

#include "io/case/table.hpp"

#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

namespace {

std::vector<std::string_view> split_cells(std::string_view line) {
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

}  // namespace

std::vector<std::vector<double>> read_table(const std::filesystem::path& path, const Value& field,
                                            const std::vector<std::string>& wanted) {
  std::string text;
  try {
    text = read_text(path);
  } catch (const Error& e) {
    throw Error(e.fault, fmt::format("{}: {}: {}", to_string(field.node->position), field.name, e.what()));
  }
  const auto bad = [&](int line, const std::string& what) {
    throw Error(Fault::Usage, fmt::format("{}:{}:1: {}", path.string(), line, what));
  };
  const std::string names = fmt::format("{}", fmt::join(wanted, ","));
  std::vector<std::vector<double>> rows;
  std::size_t columns = 0;
  std::vector<std::size_t> column;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const auto cells = split_cells(line);
    if (columns == 0) {
      columns = cells.size();
      for (const std::string& name : wanted) {
        const auto found = std::find(cells.begin(), cells.end(), name);
        if (found == cells.end() && columns == 1 && line.find(';') != std::string_view::npos)
          bad(number, "cells are separated by commas here, and numbers have points: 0.5,1");
        if (found == cells.end())
          bad(number, fmt::format("the first line must name the columns, {} among them", names));
        column.push_back(static_cast<std::size_t>(found - cells.begin()));
      }
      continue;
    }
    if (cells.size() != columns)
      bad(number, fmt::format("{} cells instead of {}{}", cells.size(), columns,
                              cells.size() == 2 * columns ? "; decimal commas? write points: 0.5,1" : ""));
    std::vector<double> row;
    for (const std::size_t k : column) {
      const std::string_view cell = cells[k];
      double value = 0;
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(value))
        bad(number, fmt::format("{} is not a finite number", quote(cell)));
      row.push_back(value);
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty())
    bad(std::max(number, 1), fmt::format("there is no point; give a line {} and a line per point", names));
  return rows;
}

}  // namespace kerf
