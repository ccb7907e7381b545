#pragma once
// What is wrong with a line that is no TOML, in the words of who wrote it.

#include <string>
#include <string_view>

namespace kerf {

/// What the parser says of `line` (without its end; `column` counts from 1) in plain words, with what would be right:
/// "a decimal comma? write 0.02". Of what is not known here: "not valid TOML: " and the parser's own words.
/// Throws std::bad_alloc where the parser refuses a number that is one.
std::string plain_words(std::string_view parser_says, std::string_view line, std::size_t column);

/// A number with a comma where its point should be, with the point; empty for everything else.
std::string with_decimal_point(std::string_view text);

}  // namespace kerf
