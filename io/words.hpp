#pragma once
// What error messages are made of: quoted user text, and the known word that an unknown one was probably meant to be.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// "text" on one line: control characters become spaces, and what is longer than 60 bytes is cut.
std::string quote(std::string_view text);

/// `it is called "young" here` for the words of other programs, `did you mean "young"?` when one of the known words is
/// near (edit distance with transpositions, at most a third of the longer word), else `known: young, poisson`.
std::string suggest(std::string_view word, std::span<const std::string> known);

bool contains(std::span<const std::string> words, std::string_view word);

bool is_digit(char c);

/// Without blanks, tabs and line ends on either side.
std::string_view trim(std::string_view text);

/// Usable inside a file name on every system: letters, digits, _ . - and at most 100 of them.
bool is_safe_name(std::string_view text);

}  // namespace kerf
