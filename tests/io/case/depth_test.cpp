// Deep trees of expressions: long chains of operations, over definitions too, cost no stack; what lies within itself
// too often to be parsed is refused in words.

#include "io/case/syntax.hpp"
#include "tests/support/small_stack.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace kerf::depth_test {
namespace {

/// An operation, again and again on what was there before, and what comes of it after n times.
struct Repeated {
  const char *before, *after;
  double (*value)(double x, double y, int n);
};
constexpr Repeated repeated[] = {
    {"", "+x", [](double x, double, int n) { return (n + 1) * x; }},
    {"", "-(-y)", [](double x, double y, int n) { return x + n * y; }},
    {"", "*1", [](double x, double, int) { return x; }},
    {"", "/1", [](double x, double, int) { return x; }},
    {"", "+max(x,y)", [](double x, double y, int n) { return x + n * std::max(x, y); }},
    {"", "&&x>-1", [](double, double, int) { return 1.0; }},
    {"", "||x>-1", [](double, double, int) { return 1.0; }},
    {"min(", ",7)", [](double x, double, int) { return x; }},
    {"max(", ",x)", [](double x, double, int) { return x; }},
    {"abs(", ")", [](double x, double, int) { return x; }},
    {"-(-(", "))", [](double x, double, int) { return x; }},
    {"(x<-1 ? y : ", ")", [](double x, double, int) { return x; }},
    {"(x>-1 ? x : ", ")", [](double x, double, int) { return x; }},
    {"sqrt((", ")^2)", [](double x, double, int) { return x; }},
    {"atan2(0*(", "),1)+x", [](double x, double, int) { return x; }},
};

/// `times` in each of `definitions`, each of which begins with the one before.
ExpressionContext chain(const Repeated& r, int definitions, int times) {
  ExpressionContext c;
  for (int k = 0; k < definitions; ++k) {
    std::string text = k == 0 ? "x" : "d" + std::to_string(k - 1);
    std::string before, after;
    for (int i = 0; i < times; ++i) before += r.before, after += r.after;
    c.definitions.push_back({"d" + std::to_string(k), before + text + after});
  }
  return c;
}

TEST(Depth, ChainsAcrossDefinitionsCostNoStack) {
  for (const Repeated& r : repeated)
    for (const auto& [definitions, times] : {std::pair(1, 300), {3, 300}, {1000, 3}}) {
      SCOPED_TRACE(std::string(r.before) + "d" + r.after);
      const ExpressionContext c = chain(r, definitions, times);
      const std::string last = "d" + std::to_string(definitions - 1);
      const std::shared_ptr<const Syntax> syntax = syntax_of(last, c);
      ASSERT_TRUE(syntax);
      test::on_small_stack([&] {
        const double x = 0.5, y = 0.25, value = r.value(x, y, definitions * times), slack = 1e-8 * (1 + value);
        const Interval box = enclose(*syntax, exactly(x), exactly(y));
        EXPECT_LE(box.low, value + slack);
        EXPECT_GE(box.high, value - slack);
        EXPECT_LT(deviation(*syntax, {0.5, 0.5 + 1e-3}, {0.25, 0.25 + 1e-3}, 3), infinity);
        const EdgeLine edge{Vec2(0.5, 0.25), Vec2(0.75, 0.25), Vec2(0, 1)};
        const ScalarOnPiece piece = enclose(syntax, edge, 0, 0.5);
        EXPECT_LE(piece.value.low, value + slack);
        EXPECT_GE(piece.value.high, value - slack);
      });
    }
}

// Sums of thousands, in a definition and over them.
TEST(Depth, LongSumsCostNoStack) {
  for (const int definitions : {1, 3, 20}) {
    const ExpressionContext c = chain(repeated[0], definitions, 4000);
    const auto syntax = syntax_of("d" + std::to_string(definitions - 1) + "+sqrt(1-x)", c);
    ASSERT_TRUE(syntax);
    const auto under_root =
        syntax_of("sqrt(1-x)+" + std::string("x") + chain(repeated[0], 1, 4000).definitions[0].text.substr(1), c);
    ASSERT_TRUE(under_root);
    test::on_small_stack([&] {
      const double sum = definitions * 4000 + 1;
      const EdgeLine edge{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
      const Interval box = enclose(*syntax, exactly(0.5), exactly(0));
      EXPECT_NEAR(0.5 * (box.low + box.high), 0.5 * sum + std::sqrt(0.5), 1e-6);
      // Next to the place where the root vanishes it is told from the rest, with thousands of operations around it.
      const ScalarOnPiece piece = enclose(under_root, edge, 0.5, 1);
      ASSERT_TRUE(piece.power);
      EXPECT_EQ(piece.power->exponent, 0.5);
      const auto [regular, factor] = piece.power->at(0.75);
      EXPECT_NEAR(regular, 4001 * 0.75, 1e-8);
      EXPECT_NEAR(factor, 1, 1e-12);
    });
  }
}

// Each of a thousand definitions names those before it: what is found by its name is found at once.
TEST(Depth, ManyDefinitionsOfManyNamesTakeLinearTime) {
  ExpressionContext c;
  constexpr int names = 15;
  for (int k = 0; k < 1000; ++k) {
    std::string text = "1";
    for (int j = 0; k > 0 && j < names; ++j) text += "+0*d" + std::to_string(k - 1 - j % k);
    c.definitions.push_back({"d" + std::to_string(k), text});
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(wrong_definition(c));
  c.checked = true;
  EXPECT_EQ(parse_expression("x*d999", c)({2, 0}, {1, 0}), 2);
  ASSERT_TRUE(syntax_of("x*d999", c));
  EXPECT_EQ(definitions_under("x*d999", c).size(), 1000u);
  // 9 s and more when every name was compared with every other.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(8));
  c.definitions[50].text += "+d50";
  const std::optional<WrongDefinition> wrong = wrong_definition(c);
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->number, 50u);
  c.definitions[50].text = "1/0*d3";
  EXPECT_EQ(wrong_definition(c)->number, 50u);
}

TEST(Depth, WhatIsNestedTooDeepIsRefused) {
  const auto complaint = [](const std::string& text) -> std::string {
    try {
      syntax_of(text, {});
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Usage);
      return error.what();
    }
    return "none";
  };
  const auto nested = [](const std::string& open, const std::string& close, int n) {
    std::string text = "x";
    for (int k = 0; k < n; ++k) text = open + text + close;
    return text;
  };
  for (const auto& [open, close] : {std::pair("(", ")"), {"sin(", ")"}, {"-(", ")"}, {"(1+", ")"}, {"(x>1?y:", ")"}}) {
    EXPECT_EQ(complaint(nested(open, close, 300)), "none") << open;
    const std::string said = complaint(nested(open, close, 3000));
    EXPECT_NE(said.find("too many operations lie within each other; name parts of it in [define]"), said.npos) << said;
  }
  for (const std::string& chain : {nested("-", "", 9999), nested("", "^2", 4000), nested("x>1?y:", "", 2500)})
    EXPECT_NE(complaint(chain).find("lie within each other"), std::string::npos) << chain.substr(0, 20);
}

}  // namespace
}  // namespace kerf::depth_test
