// Numbers of a run from its files, for the manual: "/state/energy" is a place in result.json, "file.csv:row:column" a
// cell of a table, the row by its number from 0, or max or min of the column; and the manual's results as a table and
// as JSON. An empty cell is NaN; a place that is not there is an error. Lines of the tables are split at commas: the
// manual names no column with quotes.

#include "bench/verify/records.hpp"

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

double read_cell(const std::filesystem::path& folder, const std::string& where) {
  const std::vector<std::string> parts = split(where, ':');
  if (parts.size() != 3) throw Error(Fault::Usage, fmt::format("{} is no place in a file", quote(where)));
  std::istringstream in(read_file(folder / parts[0]));
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = split(line, ',');
  const auto column = static_cast<std::size_t>(std::ranges::find(names, parts[2]) - names.begin());
  std::vector<double> values;  // a last cell that is empty is none: NaN stands for it, so that rows keep their numbers
  while (column < names.size() && std::getline(in, line))
    if (const auto cells = split(line, ','); !cells.empty())
      values.push_back(column < cells.size() ? number_in(cells[column]) : nan);
  std::vector<double> known;
  std::ranges::copy_if(values, std::back_inserter(known), [](double v) { return std::isfinite(v); });
  if (!known.empty() && parts[1] == "max") return *std::ranges::max_element(known);
  if (!known.empty() && parts[1] == "min") return *std::ranges::min_element(known);
  const double row = number_in(parts[1]);
  if (!(row >= 0 && row < static_cast<double>(values.size())) || std::isnan(values[static_cast<std::size_t>(row)]))
    throw Error(Fault::Usage, fmt::format("there is no cell {}", quote(where)));
  return values[static_cast<std::size_t>(row)];
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

double read_number(const std::filesystem::path& folder, const std::string& where) {
  return where.starts_with("/") ? read_pointer(folder, where) : read_cell(folder, where);
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
