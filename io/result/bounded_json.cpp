// JSON from files that may be anybody's: its length, its depth and its objects are bounded before it is taken apart.

#include "io/result/bounded_json.hpp"

#include "io/files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <vector>

namespace kerf {

namespace {

constexpr std::size_t deepest = 64;         // lists and objects within each other: kerf's own are not half as deep
constexpr std::size_t most_members = 2000;  // of an object: those of a step of loads are up to 1,000

/// Whether it may be taken apart in time and stack that its length bounds: an object looks at all its members for each
/// more. Brackets and commas in texts do not count.
bool is_bounded(std::string_view text) {
  struct Open {
    bool object;
    std::size_t members;
  };
  std::vector<Open> open;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (quoted)
      continue;
    else if (c == '{' || c == '[')
      open.push_back({c == '{', 1});
    else if ((c == '}' || c == ']') && !open.empty())
      open.pop_back();
    else if (c == ',' && !open.empty())
      ++open.back().members;
    if (open.size() > deepest || (!open.empty() && open.back().object && open.back().members > most_members))
      return false;
  }
  return true;
}

}  // namespace

Error damaged_result(const std::filesystem::path& path) {
  return {Fault::Files, fmt::format("{} is damaged, or no result that kerf has written", path.string())};
}

nlohmann::ordered_json read_json(const std::filesystem::path& path) {
  constexpr std::uintmax_t longest = 256u << 20;
  const std::string text = read_file(path, longest);
  if (!is_bounded(text)) throw damaged_result(path);
  nlohmann::ordered_json all = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!all.is_object()) throw damaged_result(path);
  return all;
}

}  // namespace kerf
