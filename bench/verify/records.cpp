// Numbers of a run from its files, for the manual: "/state/energy" is a place in result.json, "file.csv:row:column" a
// cell of a table (bench/verify/manual.hpp), "path:..." one of a crack that has grown; and the manual's results as a
// table and as JSON. An empty cell is NaN; a place that is not there is an error. Lines of the tables are split at
// commas: the manual names no column with quotes.

#include "bench/verify/records.hpp"

#include "bench/verify/paths.hpp"
#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/words.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <sstream>

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

double read_pointer(const std::filesystem::path& folder, const std::string& where) {
  const Json result = Json::parse(read_file(folder / "result.json"));
  const Json::json_pointer pointer(where);
  if (!result.contains(pointer) || !result[pointer].is_number())
    throw Error(Fault::Usage, fmt::format("result.json has no number at {}", where));
  return result[pointer].get<double>();
}

std::vector<std::string> split(const std::string& line, char at) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, at);) cells.push_back(cell);
  return cells;
}

/// Not a number where there is none.
double number_in(const std::string& text) {
  double value = nan;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Rows of cells by the names of their columns.
struct CsvTable {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  explicit CsvTable(const std::string& text) {
    std::istringstream in(text);
    std::string line;
    std::getline(in, line);
    names = split(line, ',');
    while (std::getline(in, line))
      if (auto cells = split(line, ','); !cells.empty()) rows.push_back(std::move(cells));
  }

  std::size_t column(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
  /// A last cell that is empty is none: NaN stands for it, so that rows keep their numbers. No such column: empty.
  std::vector<double> values(const std::string& name) const {
    std::vector<double> out;
    const std::size_t k = column(name);
    if (k < names.size())
      for (const auto& cells : rows) out.push_back(k < cells.size() ? number_in(cells[k]) : nan);
    return out;
  }
  void keep_tip(const std::string& tip) {
    const std::size_t k = column("tip");
    std::erase_if(rows, [&](const auto& cells) { return k >= cells.size() || cells[k] != tip; });
  }
};

/// Linear between the first two rows around x = value.
double interpolated(const std::vector<double>& x, const std::vector<double>& y, double value) {
  for (std::size_t i = 0; i + 1 < std::min(x.size(), y.size()); ++i) {
    const double from = x[i] - value, to = x[i + 1] - value;
    if (from * to <= 0 && from != to) return y[i] + from / (from - to) * (y[i + 1] - y[i]);
  }
  return nan;
}

double read_cell(const std::filesystem::path& folder, const std::string& where) {
  const std::size_t first = where.find(':'), last = where.rfind(':');
  if (last == std::string::npos || first == last)
    throw Error(Fault::Usage, fmt::format("{} is no place in a file", quote(where)));
  CsvTable table(read_file(folder / where.substr(0, first)));
  std::string row = where.substr(first + 1, last - first - 1);
  if (const std::size_t at = row.find('@'); at != std::string::npos) {
    table.keep_tip(row.substr(0, at));
    row = row.substr(at + 1);
  }
  const std::vector<double> values = table.values(where.substr(last + 1));
  std::vector<double> known;
  std::ranges::copy_if(values, std::back_inserter(known), [](double v) { return std::isfinite(v); });
  if (!known.empty() && row == "max") return *std::ranges::max_element(known);
  if (!known.empty() && row == "min") return *std::ranges::min_element(known);
  double value = nan;
  if (const std::size_t equal = row.find('='); equal != std::string::npos) {
    value = interpolated(table.values(row.substr(0, equal)), values, number_in(row.substr(equal + 1)));
  } else {
    const double number = row == "last" ? static_cast<double>(values.size()) - 1 : number_in(row);
    if (number >= 0 && number < static_cast<double>(values.size())) value = values[static_cast<std::size_t>(number)];
  }
  if (std::isnan(value)) throw Error(Fault::Usage, fmt::format("there is no cell {}", quote(where)));
  return value;
}

const char* relation(const ManualValue& value) {
  return value.relation == ManualValue::Relation::Equal     ? "equal"
         : value.relation == ManualValue::Relation::AtLeast ? "at least"
                                                            : "at most";
}

Json value_record(const ManualValue& value, const VerifiedValue& found) {
  Json out{{"name", value.name},
           {"published", value.published ? Json(*value.published) : Json(nullptr)},
           {"measured", number_or_null(found.measured)},
           {"error_bar", number_or_null(found.error_bar)},
           {"deviation", number_or_null(found.deviation)}};
  if (value.published && value.tolerance > 0) {
    out["tolerance"] = value.tolerance;
    out["absolute"] = value.absolute;
    out["relation"] = relation(value);
    out["reason"] = value.reason;
    out["within"] = found.within;
  }
  return out;
}

}  // namespace

double read_number(const std::filesystem::path& folder, const std::string& where,
                   const std::vector<ManualReference>& references) {
  return where.starts_with("/")       ? read_pointer(folder, where)
         : where.starts_with("path:") ? read_path_number(folder, where, references)
                                      : read_cell(folder, where);
}

void write_verify_csv(const std::filesystem::path& path, const VerifyBench& bench) {
  fmt::memory_buffer out;
  fmt::format_to(fmt::appender(out), "id,value,published,measured,error_bar,deviation,tolerance,absolute,verdict\n");
  for (const VerifiedEntry& e : bench.entries)
    for (std::size_t k = 0; k < e.entry.values.size(); ++k) {
      const ManualValue& value = e.entry.values[k];
      const VerifiedValue found = k < e.values.size() ? e.values[k] : VerifiedValue{};
      fmt::format_to(fmt::appender(out), "{},{}", e.entry.id, csv_text(value.name));
      const double tolerance = value.published && value.tolerance > 0 ? value.tolerance : nan;
      for (const double cell :
           {value.published.value_or(nan), found.measured, found.error_bar, found.deviation, tolerance}) {
        out.push_back(',');
        append_cell(out, cell);
      }
      const char* verdict = k >= e.values.size() ? e.verdict.c_str()
                            : !value.published   ? ""
                            : found.within       ? "within"
                                                 : "outside";
      fmt::format_to(fmt::appender(out), ",{},{}\n", value.absolute, verdict);
    }
  write_file(path, fmt::to_string(out));
}

void write_verify_json(const std::filesystem::path& path, const VerifyBench& bench) {
  Json all{{"schema", 1}, {"status", bench.stopped ? "stopped" : "ok"}, {"benchmarks", Json::array()}};
  for (const VerifiedEntry& e : bench.entries) {
    Json record{{"id", e.entry.id},         {"title", e.entry.title},   {"group", e.entry.group},
                {"source", e.entry.source}, {"check", e.entry.check},   {"verdict", e.verdict},
                {"quick", e.entry.quick},   {"triangles", e.triangles}, {"cpu_s", e.seconds}};
    if (!e.entry.impossible.empty()) record["because"] = e.entry.impossible;
    if (!e.trouble.empty()) record["because"] = e.trouble;
    record["values"] = Json::array();
    for (std::size_t k = 0; k < e.entry.values.size(); ++k)
      record["values"].push_back(value_record(e.entry.values[k], k < e.values.size() ? e.values[k] : VerifiedValue{}));
    all["benchmarks"].push_back(std::move(record));
  }
  write_file(path, all.dump(1) + "\n");
}

}  // namespace kerf
