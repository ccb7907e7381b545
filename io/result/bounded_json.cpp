// JSON from files that may be anybody's: its length and its depth are bounded before it is taken apart.

#include "io/result/bounded_json.hpp"

#include "io/files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace kerf {

namespace {

/// Of lists and objects within each other; brackets in texts do not count.
int depth_of_json(std::string_view text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '{' || c == '['))
      deepest = std::max(deepest, ++depth);
    else if (!quoted && (c == '}' || c == ']'))
      --depth;
  }
  return deepest;
}

}  // namespace

Error damaged_result(const std::filesystem::path& path) {
  return {Fault::Files, fmt::format("{} is damaged, or no result that kerf has written", path.string())};
}

nlohmann::ordered_json read_json(const std::filesystem::path& path) {
  constexpr std::uintmax_t longest = 256u << 20;
  constexpr int deepest = 64;  // kerf's own are not half as deep
  const std::string text = read_file(path, longest);
  if (depth_of_json(text) > deepest) throw damaged_result(path);
  nlohmann::ordered_json all = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!all.is_object()) throw damaged_result(path);
  return all;
}

}  // namespace kerf
