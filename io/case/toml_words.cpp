// What toml++ says of a mistake, in the words of somebody who writes case files: from the parser's sentence, the line
// and the column where it stopped, the mistake that was probably made (a decimal comma, a unit after a number, text
// without quotes, a comment that begins with //) and how to write it right. A sentence that no rule knows is passed on.
// Sentences are matched by parts of them: with another version of toml++ fewer rules may match.

#include "io/case/toml_words.hpp"

#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <new>

namespace kerf {

namespace {

constexpr std::string_view spaces = " \t\r";

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// What was written where the parser stopped: up to the next separator on either side.
std::string_view word_at(std::string_view line, std::size_t at) {
  constexpr std::string_view separators = " \t\r,[]{}=#";
  const auto separates = [&](std::size_t k) { return separators.find(line[k]) != std::string_view::npos; };
  at = std::min(at, line.size());
  while (at > 0 && (at == line.size() || separates(at))) --at;
  std::size_t begin = at, end = at;
  while (begin > 0 && !separates(begin - 1)) --begin;
  while (end < line.size() && !separates(end)) ++end;
  return line.substr(begin, end - begin);
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// The line from where the parser stopped, without its comment.
std::string_view rest_of(std::string_view line, std::size_t at) {
  const std::string_view rest = line.substr(std::min(at, line.size()));
  return trim(rest.substr(0, rest.find('#')));
}

/// Characters that look like those of TOML and are others.
std::string look_alike(std::string_view line) {
  for (const std::string_view mark : {"\u201c", "\u201d", "\u201e", "\u2018", "\u2019", "\u00ab", "\u00bb"})
    if (has(line, mark)) return fmt::format("{} is no quotation mark of TOML; write \"...\"", mark);
  if (has(line, "\u2212") || has(line, "\u2013")) return "this minus sign is a dash; write -";
  if (has(line, "\u00a0")) return "there is a space that is none (U+00A0); type it anew";
  return "";
}

std::string after_value(std::string_view line, std::size_t at) {
  const std::size_t equals = line.find('=');
  const std::string_view value = rest_of(line, equals == std::string_view::npos ? 0 : equals + 1);
  const std::string_view rest = rest_of(line, at);
  if (const std::string number = with_decimal_point(value); !number.empty())
    return fmt::format("{}: a decimal comma? write {}", quote(value), number);
  if (rest.starts_with("//") || rest.starts_with("%")) return "a comment begins with #";
  if (rest.starts_with(";")) return "no ; is needed at the end of a line";
  if (rest.starts_with("]") || rest.starts_with("}")) return fmt::format("one {} too many", rest[0]);
  if (rest.starts_with(",")) return "one key per line, without a comma between them";
  return fmt::format("{} after the value: text needs quotes, a number stands alone (no unit, no spaces in it)",
                     quote(rest));
}

/// Whether that is a number; result_out_of_range: one that is too large or too small.
std::errc as_number(std::string_view word) {
  std::string digits;
  for (const char c : word)
    if (c != '_' && !(c == '+' && digits.empty())) digits += c;
  double x = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
  return end == digits.data() + digits.size() ? error : std::errc::invalid_argument;
}

std::string about_number(std::string_view word) {
  if (word.empty()) return "a number has digits after its point and its e, as in 0.5 and 1e-3";
  if (word.back() == ';') return "entries of a list are separated by commas; at the end of a line stands nothing";
  if (is_digit(word.front()) && word.size() > 1 && word.back() == '.')
    return fmt::format("a number needs a digit after its point: {}0", word);
  if (word.front() == '.' || word.starts_with("-.") || word.starts_with("+."))
    return fmt::format("a number needs a digit before its point: {}0{}", word.substr(0, word.find('.')),
                       word.substr(word.find('.')));
  if (as_number(word) == std::errc::result_out_of_range)
    return fmt::format("{} is beyond the range of numbers, 1e-308 to 1e308", quote(word));
  return fmt::format("{} is no number; an expression needs quotes, a number stands alone (no unit)", quote(word));
}

std::string about_value(std::string_view line, std::size_t at, std::string_view word) {
  const std::string_view rest = rest_of(line, at);
  if (rest.starts_with("=")) return "one = is enough: key = value";
  if (rest.starts_with("(")) return "a list stands in brackets: [0, 1]";
  return fmt::format("text needs quotes: \"{}\"", word.empty() ? rest : word);
}

std::string about_key(std::string_view line, std::size_t at, std::string_view says) {
  const std::string_view rest = rest_of(line, at);
  if (rest.starts_with(":")) return "a key and its value are joined by =, not by a colon";
  if (has(says, "saw ','") || rest.starts_with("}")) return "in braces stand keys with values: { x = 0, y = 1 }";
  if (!rest.empty() && static_cast<unsigned char>(rest[0]) > 127) return "keys have English letters, digits, _ and -";
  return "between a key and its value stands =: key = value; a key is one word";
}

std::string about_repetition(std::string_view says) {
  const std::size_t first = says.find('\''), last = says.find('\'', first + 1);
  const std::string name(says.substr(first + 1, last - first - 1));
  if (has(says, "as array-of-tables")) return fmt::format("both [{0}] and [[{0}]]: use one of them", name);
  if (has(says, "table header"))
    return fmt::format("[{0}] stands twice; put its keys together ([[{0}]] begins one more where there may be several)",
                       name);
  return fmt::format("{} stands twice", name);
}

}  // namespace

std::string with_decimal_point(std::string_view text) {
  text = trim(text);
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || comma == 0 || comma + 1 >= text.size()) return "";
  if (!is_digit(text[comma - 1]) || !is_digit(text[comma + 1])) return "";
  for (std::size_t k = 0; k < text.size(); ++k)
    if (k != comma && !is_digit(text[k]) && std::string_view("+-eE").find(text[k]) == std::string_view::npos) return "";
  std::string out(text);
  out[comma] = '.';
  return out;
}

std::string plain_words(std::string_view says, std::string_view line, std::size_t column) {
  const std::size_t at = column > 0 ? column - 1 : 0;
  const std::string_view word = word_at(line, at);
  const auto is = [&](std::string_view part) { return has(says, part); };
  if (const std::string mark = look_alike(line.substr(0, line.find('#'))); !mark.empty() && !is("redefine"))
    return mark;
  if (is("redefine")) return about_repetition(says);
  if (is("expected a comment or whitespace")) return after_value(line, at);
  if (is("could not determine value type")) return about_value(line, at, word);
  if (is("expected '='")) return about_key(line, at, says);
  if (is("leading zero")) return "a number does not begin with 0";
  // The stream that toml++ reads numbers with does not say when there is no memory for it.
  if (is("could not be interpreted") && as_number(word) == std::errc()) throw std::bad_alloc();
  if (is("not representable in 64 bits"))
    return fmt::format("{} is too large for a whole number; with a point, {}.0, it is any number", quote(word), word);
  if (is("floating-point") || is("integer")) return about_number(word);
  if (is("boolean"))
    return lower(word) == "true" || lower(word) == "false" ? "true and false are written in small letters"
                                                           : fmt::format("text needs quotes: \"{}\"", word);
  if (is("escape sequence")) return "a \\ in a text is written \\\\, or the text stands in '...'";
  if (is(" string: ") && (is("control characters") || is("end-of-file")))
    return "the text does not end on its line: its second quotation mark is missing";
  if (is("parsing array"))
    return is("end-of-file") ? "a list does not end: ] is missing" : "entries of a list are separated by commas";
  if (is("table header")) return "a header ends with its bracket: [mesh], [[crack]]";
  if (is("inline table")) return "a table in braces stands on one line; use [header] for a long one";
  if (is("expected value") || (is("key-value pair") && is("end-of-file"))) return "a value is missing";
  if (is("expected keys, tables")) return "a line begins with a key, a [table], or # for a comment";
  if (is("utf-8")) return "the file is no UTF-8 text; save it as UTF-8";
  return fmt::format("not valid TOML: {}", says);
}

}  // namespace kerf
