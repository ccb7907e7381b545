// Numbers, expressions and values that hurt.

#include "tests/fuzz/input.hpp"

#include "io/case/keys.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace kerf::fuzz {

namespace {

const std::vector<std::string> numbers = {"0",
                                          "-0.0",
                                          "1",
                                          "-1",
                                          "0.5",
                                          "0.3",
                                          "2",
                                          "10",
                                          "1e-3",
                                          "1e-6",
                                          "1e-9",
                                          "1e-12",
                                          "1e-15",
                                          "1e-100",
                                          "1e-300",
                                          "5e-324",
                                          "2.2e-308",
                                          "1e3",
                                          "1e6",
                                          "1e9",
                                          "1e12",
                                          "1e15",
                                          "1e100",
                                          "1e300",
                                          "1e308",
                                          "-1e308",
                                          "1.8e308",
                                          "nan",
                                          "inf",
                                          "-inf",
                                          "2147483647",
                                          "2147483648",
                                          "-2147483648",
                                          "4294967296",
                                          "9007199254740993",
                                          "9223372036854775807",
                                          "9223372036854775808",
                                          "0.1",
                                          "0.49999",
                                          "0.4999999999999999",
                                          "0.5000000000000001",
                                          "90",
                                          "180",
                                          "360",
                                          "1e5",
                                          "0x7f",
                                          "1_000",
                                          "1e",
                                          ".5",
                                          "3.",
                                          "+1",
                                          "00",
                                          "1979-05-27",
                                          "07:32:00",
                                          "true",
                                          "false",
                                          "''",
                                          "[]",
                                          "{}"};

const std::vector<std::string> names = {"x", "y", "nx", "ny", "pi", "E", "nu", "r1", "t", "z", "_pi", "X", "xx"};
const std::vector<std::string> functions = {"sqrt", "exp",  "log", "sin",  "cos",  "tan", "abs",
                                            "sign", "atan", "ln",  "tanh", "rint", "foo"};
const std::vector<std::string> operators = {
    " + ", " - ", "*", "/", "^", " < ", " > ", " <= ", " >= ", " == ", " != ", " && ", " || ", "=", " "};

std::string constant(Dice& dice) {
  if (dice.chance(0.6)) return fmt::format("{:.3g}", dice.between(-3, 3));
  return dice.one_of(numbers);
}

bool parse(const std::string& text, double& x) {
  const char* begin = text.data() + (!text.empty() && text[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), x);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(x);
}

}  // namespace

std::string odd_number(Dice& dice, const std::string& like) {
  double x = 0;
  if (like.empty() || !parse(like, x) || dice.chance(0.15)) return dice.one_of(numbers);
  const auto shortest = [](double value) { return fmt::format("{}", value); };
  switch (dice.below(8)) {
    case 0:
      return shortest(-x);
    case 1:
      return shortest(x * std::pow(10, std::floor(dice.chance(0.3) ? dice.between(-12, 13) : dice.between(-3, 4))));
    case 2:
      return shortest(x + (x == 0 ? 1 : x) * std::pow(10, dice.between(-16, 0)));
    case 3:
      return shortest(std::nextafter(x, dice.chance(0.5) ? 1e300 : -1e300));
    case 4:
      return shortest(std::round(x));
    case 5:
      return shortest(x * dice.between(0.3, 3));
    case 6:
      return shortest(x + dice.between(-1, 1));
    default:
      return shortest(1 - x);
  }
}

std::string odd_expression(Dice& dice, int depth) {
  if (depth <= 0 || dice.chance(0.15)) return dice.chance(0.5) ? constant(dice) : dice.one_of(names);
  const auto below = [&] { return odd_expression(dice, depth - 1); };
  switch (dice.below(8)) {
    case 0:
    case 1:
    case 2: {
      const std::string a = below(), o = dice.one_of(operators);
      return a + o + below();
    }
    case 3: {
      const std::string f = dice.one_of(functions);
      return f + "(" + below() + ")";
    }
    case 4: {
      const std::string a = below(), b = below();
      return "(" + a + " < " + b + " ? " + below() + " : " + below() + ")";
    }
    case 5: {
      const std::string f = dice.chance(0.3) ? "atan2" : dice.chance(0.5) ? "min" : "max", a = below();
      return f + "(" + a + ", " + below() + ")";
    }
    case 6:
      return fmt::format("-{}", below());
    default:
      return fmt::format("({})", below());
  }
}

Value value_for(Dice& dice, std::string_view path) {
  const Key* key = find_key(path);
  if (!key) return token(odd_number(dice, ""));
  const KeyRules& rules = key->rules;
  if (!rules.words.empty() && dice.chance(0.8)) return text(std::string(rules.words[dice.below(rules.words.size())]));
  if (!key->example.empty() && dice.chance(0.7)) return token(std::string(key->example));  // as TOML writes it
  if (has(key->type, KeyType::Formula) && dice.chance(0.6)) return text(odd_expression(dice, 3));
  if (std::isfinite(rules.range.most) && dice.chance(0.5)) return token(fmt::format("{}", rules.range.most));
  if (std::isfinite(rules.range.least) && dice.chance(0.5)) return token(fmt::format("{}", rules.range.least));
  return token(odd_number(dice, ""));
}

}  // namespace kerf::fuzz
