// Every number of result.json under its path, for the table of a sweep; entries with names are called by them.

#include "io/result_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

#include "io/result/bounded_json.hpp"

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

bool is_left_out(const std::string& path) {
  static constexpr std::array<std::string_view, 7> whole{"schema", "version", "case",      "title",
                                                         "units",  "reason",  "mesh.adapt"};
  static constexpr std::array<std::string_view, 6> parts{".notes",      ".rows",   ".reason",
                                                         ".covariance", ".starts", ".names"};
  return std::ranges::find(whole, path) != whole.end() ||
         std::ranges::any_of(parts, [&](std::string_view part) { return path.ends_with(part); }) ||
         (path.starts_with("time_s.") && path != "time_s.total");
}

void walk(const Json& value, const std::string& path, std::vector<Leaf>& out) {
  constexpr std::size_t most_entries = 16, coordinates = 3;
  if (is_left_out(path)) return;
  if (value.is_object()) {
    for (const auto& [key, below] : value.items()) walk(below, path.empty() ? key : path + "." + key, out);
  } else if (value.is_array()) {
    const bool tables = !value.empty() && value[0].is_object();
    if (value.size() > (tables ? most_entries : coordinates)) return;
    for (std::size_t k = 0; k < value.size(); ++k) {
      const Json& item = value[k];
      const bool named = item.is_object() && item.contains("name") && item["name"].is_string();
      walk(item, named ? path + "." + item["name"].get<std::string>() : fmt::format("{}[{}]", path, k), out);
    }
  } else if (!path.ends_with(".name")) {
    out.push_back({path,
                   value.is_string() ? value.get<std::string>()
                   : value.is_null() ? ""
                                     : value.dump(),
                   value.is_number()});
  }
}

}  // namespace

std::vector<Leaf> leaves_of_result(const std::filesystem::path& path) {
  const Json all = read_json(path);
  // What every result has: with another status it would pass for one that is good.
  for (const char* key : {"version", "case", "status"})
    if (!all.contains(key) || !all[key].is_string()) throw damaged_result(path);
  std::vector<Leaf> out;
  walk(all, "", out);
  if (all.contains("reason") && all["reason"].is_string()) out.push_back({"reason", all["reason"].get<std::string>()});
  return out;
}

}  // namespace kerf
