// Words in messages: quoted without control characters, the nearest known word by edit distance, names that are safe
// for files.

#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

/// Insertions, deletions, substitutions and swaps of neighbors that turn a into b (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = last;
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

/// Without what a terminal would obey.
std::string printable(std::string_view text) {
  std::string out(text);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char byte) { return byte < 32 || byte == 127; }, ' ');
  return out;
}

}  // namespace

std::string quote(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::size_t end = std::min(text.size(), longest);
  // Not in the middle of a UTF-8 sequence.
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return fmt::format("\"{}{}\"", printable(text.substr(0, end)), end < text.size() ? "..." : "");
}

std::string suggest(std::string_view word, std::span<const std::string> known) {
  constexpr std::size_t longest = 100;  // nobody mistypes more, and the table is quadratic
  const std::string* best = nullptr;
  std::size_t best_distance = longest;
  if (word.size() <= longest)
    for (const std::string& candidate : known) {
      const std::size_t distance = edit_distance(word, candidate);
      if (distance < best_distance && 3 * distance <= std::max(word.size(), candidate.size()) + 1) {
        best = &candidate;
        best_distance = distance;
      }
    }
  if (best) return fmt::format("did you mean \"{}\"?", printable(*best));
  return known.empty() ? "none is known here" : "known: " + printable(fmt::format("{}", fmt::join(known, ", ")));
}

bool contains(std::span<const std::string> words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view spaces = " \t\r\n";
  const std::size_t first = std::min(text.find_first_not_of(spaces), text.size());
  text.remove_prefix(first);
  return text.substr(0, text.find_last_not_of(spaces) + 1);
}

bool is_safe_name(std::string_view text) {
  const auto safe = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '.' || c == '-';
  };
  return !text.empty() && text.size() <= 100 && std::all_of(text.begin(), text.end(), safe);
}

}  // namespace kerf
