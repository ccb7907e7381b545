// Changes that know nothing of TOML.

#include "tests/fuzz/input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace kerf::fuzz {

namespace {

const std::vector<std::string> snippets = {std::string(1, '\0'),
                                           "\xff\xfe",
                                           "\xef\xbb\xbf",
                                           "\xc3",
                                           "\r\n",
                                           "\t",
                                           "\"",
                                           "'''",
                                           "\"\"\"",
                                           "[[[[[[[[",
                                           "{{{{",
                                           "]]",
                                           "#",
                                           "=",
                                           "\\u0000",
                                           "\\",
                                           "..",
                                           "-",
                                           "\xed\xa0\x80",
                                           "\xf4\x90\x80\x80",
                                           "99999999999999999999",
                                           "1e999"};

/// Where the number that holds or follows `at` begins and ends.
std::pair<std::size_t, std::size_t> number_at(const std::string& text, std::size_t at) {
  const auto part = [&](std::size_t i) {
    const auto c = static_cast<unsigned char>(text[i]);
    return std::isdigit(c) || c == '.' || c == '-' || c == '+' || c == 'e';
  };
  while (at < text.size() && !std::isdigit(static_cast<unsigned char>(text[at]))) ++at;
  std::size_t begin = at, end = at;
  while (begin > 0 && part(begin - 1)) --begin;
  while (end < text.size() && part(end)) ++end;
  return {begin, end};
}

}  // namespace

void damage(Dice& dice, std::string& bytes) {
  const int times = 1 + static_cast<int>(dice.below(3));
  for (int k = 0; k < times; ++k) {
    const std::size_t at = dice.below(bytes.size() + 1),
                      length = dice.below(std::min<std::size_t>(bytes.size() - at + 1, 60));
    switch (dice.below(7)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << dice.below(8)));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 3:
        bytes.insert(at, dice.one_of(snippets));
        break;
      case 4:
        if (at < bytes.size()) bytes[at] = static_cast<char>(dice.bits());
        break;
      case 5:
        if (dice.chance(0.3)) bytes.resize(at);
        break;
      default:
        bytes.insert(at, std::string(dice.below(3000), "[{(\"x 1"[dice.below(7)]));
        break;
    }
  }
}

void damage_lines(Dice& dice, std::string& text) {
  const int times = 1 + static_cast<int>(dice.below(4));
  for (int k = 0; k < times; ++k) {
    const std::size_t at = dice.below(text.size() + 1);
    if (dice.chance(0.6)) {
      const auto [begin, end] = number_at(text, at);
      const std::string old = text.substr(begin, end - begin);
      text.replace(begin, end - begin, odd_number(dice, old));
    } else if (dice.chance(0.15)) {
      damage(dice, text);
    } else {
      const std::size_t before = text.rfind('\n', at), begin = before == std::string::npos ? 0 : before + 1,
                        after = text.find('\n', at), end = after == std::string::npos ? text.size() : after + 1;
      if (begin > end) continue;
      const std::string line = text.substr(begin, end - begin);
      if (dice.chance(0.5))
        text.erase(begin, end - begin);
      else
        text.insert(dice.chance(0.5) ? begin : text.find('\n', dice.below(text.size())) + 1, line);
    }
  }
}

}  // namespace kerf::fuzz
