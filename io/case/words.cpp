// Words in messages: quoted without control characters, the word that kerf has for one of other programs or else the
// nearest known one by edit distance, names that are safe for files.

#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

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

/// What papers and other programs call it, in small letters and without _ and -.
struct Synonym {
  std::string_view other, here, how = "";
};
constexpr std::array<Synonym, 57> synonyms{{{"e", "young"},
                                            {"youngsmodulus", "young"},
                                            {"youngmodulus", "young"},
                                            {"modulus", "young"},
                                            {"elasticmodulus", "young"},
                                            {"nu", "poisson"},
                                            {"poissonratio", "poisson"},
                                            {"poissonsratio", "poisson"},
                                            {"g", "shear"},
                                            {"kic", "toughness"},
                                            {"fracturetoughness", "toughness"},
                                            {"gc", "release_rate"},
                                            {"gic", "release_rate"},
                                            {"yieldstress", "yield"},
                                            {"yieldstrength", "yield"},
                                            {"sigmay", "yield"},
                                            {"diameter", "radius", "half of the diameter"},
                                            {"d", "radius", "half of the diameter"},
                                            {"r", "radius"},
                                            {"h", "size"},
                                            {"lc", "size"},
                                            {"elementsize", "size"},
                                            {"meshsize", "size"},
                                            {"fixed", "displacement", "[0, 0]"},
                                            {"fix", "displacement", "[0, 0]"},
                                            {"clamped", "displacement", "[0, 0]"},
                                            {"encastre", "displacement", "[0, 0]"},
                                            {"roller", "displacement_normal", "0"},
                                            {"ux", "displacement_x"},
                                            {"uy", "displacement_y"},
                                            {"u", "displacement"},
                                            {"stress", "traction"},
                                            {"p", "pressure"},
                                            {"p", "force"},
                                            {"load", "force"},
                                            {"load", "traction"},
                                            {"force", "traction", "a force per length and thickness"},
                                            {"points", "path"},
                                            {"coordinates", "path"},
                                            {"vertices", "outline"},
                                            {"polygon", "outline"},
                                            {"free", "open"},
                                            {"frictionless", "unilateral"},
                                            {"tied", "bonded"},
                                            {"glued", "bonded"},
                                            {"mu", "friction"},
                                            {"objective", "functional"},
                                            {"geometry", "domain"},
                                            {"bc", "boundary"},
                                            {"void", "hole"},
                                            {"cavity", "hole"},
                                            {"vonmises", "max_stress"},
                                            {"mises", "max_stress"},
                                            {"stiffness", "compliance", "which is least for the stiffest body"},
                                            {"strainenergy", "energy"},
                                            {"volumefraction", "volume"},
                                            {"simp", "level-set"}}};

/// The known word for that of others, with what to know about it.
std::string translated(std::string_view word, std::span<const std::string> known) {
  std::string plain;
  for (const char c : word)
    if (c != '_' && c != '-' && c != ' ') plain += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  for (const Synonym& s : synonyms)
    if (s.other == plain && contains(known, s.here))
      return fmt::format("it is called \"{}\" here{}{}", s.here, s.how.empty() ? "" : ": ", s.how);
  return {};
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
  if (const std::string here = translated(word, known); !here.empty()) return here;
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
