// Expressions against the same formulas in C++; mistakes against their column and message.

#include "io/case/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

namespace kerf::expression_test {
namespace {

double value(std::string_view text, const Vec2& x = {0.3, -0.7}, const ExpressionContext& context = {}) {
  return parse_expression(text, context)(x, Vec2(0.6, 0.8));
}

std::string error(std::string_view text, const ExpressionContext& context = {}) {
  try {
    parse_expression(text, context);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    return e.what();
  }
  return "no error";
}

struct Example {
  const char* text;
  double value;
};
void PrintTo(const Example& e, std::ostream* out) {
  *out << e.text;
}

class Values : public testing::TestWithParam<Example> {};

TEST_P(Values, AreThoseOfTheMathematics) {
  EXPECT_DOUBLE_EQ(value(GetParam().text), GetParam().value) << GetParam().text;
}

constexpr double x = 0.3, y = -0.7;
INSTANTIATE_TEST_SUITE_P(
    Expression, Values,
    testing::Values(Example{"1 + x", 1.3}, Example{"-x^2", -0.09}, Example{"2^3^2", 512}, Example{"2^-1", 0.5},
                    Example{"x*-y", 0.21}, Example{"x - -y", -0.4}, Example{"log(100)", 2 * std::numbers::ln10},
                    Example{"ln(100)", 2 * std::numbers::ln10}, Example{"log10(100)", 2},
                    Example{"sin(pi*x)", std::sin(pi* x)}, Example{"atan2(y, x)", std::atan2(y, x)},
                    Example{"tan(x)+cos(y)+exp(x)+atan(y)", std::tan(x) + std::cos(y) + std::exp(x) + std::atan(y)},
                    Example{"abs(y) + sqrt(4)", 2.7}, Example{"min(x, y, 2) + max(x, y)", -0.4},
                    Example{"sign(y) + sign(x) + sign(0)", 0}, Example{"x > 0 ? -1 : 1", -1},
                    Example{"x>0?y>0?1:2:3", 2}, Example{"x < y ? 1 : x == 0.3 ? 2 : 3", 2},
                    Example{"(x >= 0.3) + (y != 0) + (x <= 0) + (y < 0)", 3}, Example{"x > 0 && y > 0 || y < 0", 1},
                    Example{"nx + 10*ny", 8.6}, Example{"1e-3 + .5 + 2.", 2.501}, Example{" 1\n+\t1 ", 2},
                    Example{"6/3/2 - 1 - 1", -1}, Example{"((((x))))", 0.3}, Example{"1e2^0.5", 10}));

TEST(Expression, KnowsTheMaterial) {
  const ExpressionContext context{{}, 1000, 0.3};
  EXPECT_DOUBLE_EQ(value("E/(2*(1+nu))", {}, context), 1000 / 2.6);
  EXPECT_DOUBLE_EQ(value("pi", {}, context), pi);
}

TEST(Expression, UsesDefinitionsInOrder) {
  const ExpressionContext context{
      {{"r", "sqrt(x^2 + y^2)"}, {"s", "2*r"}, {"unused", "log(-x)"}, {"t", "r + s"}}, 0, 0};
  EXPECT_DOUBLE_EQ(value("t", {3, 4}, context), 15);
  EXPECT_DOUBLE_EQ(value("s*r", {3, 4}, context), 50);
}

TEST(Expression, RefusesBadDefinitions) {
  EXPECT_EQ(error("b", {{{"b", "c"}, {"c", "b"}}, 0, 0}),
            "expression \"c\", column 1: \"c\" is defined here or later; a definition may use only those before it");
  EXPECT_EQ(
      error("b", {{{"b", "1 + b"}}, 0, 0}),
      "expression \"1 + b\", column 5: \"b\" is defined here or later; a definition may use only those before it");
  EXPECT_EQ(error("x1", {{{"x1", "1/0"}}, 0, 0}), "expression \"1/0\", column 1: the value is not finite (inf)");
  for (const char* name : {"x", "pi", "E", "sin"}) {
    const ExpressionContext context{{{name, "1"}}, 1, 0};
    EXPECT_TRUE(wrong_definition(context)) << name;
  }
  for (const char* name : {"", "2a", "a b", "a-b", "a.b"}) {
    const ExpressionContext context{{{name, "1"}}, 1, 0};
    EXPECT_TRUE(wrong_definition(context)) << name;
  }
  EXPECT_TRUE(wrong_definition({{{"a", "1"}, {"a", "2"}}, 1, 0}));
}

TEST(Expression, NamesTheColumnAndTheNearestName) {
  EXPECT_EQ(error("1 + xx"), "expression \"1 + xx\", column 5: unknown name \"xx\"; did you mean \"x\"?");
  EXPECT_EQ(error("2*sine(x)"), "expression \"2*sine(x)\", column 3: unknown function \"sine\"; did you mean \"sin\"?");
  EXPECT_EQ(error("x*r1", {{{"r2", "x"}}, 0, 0}),
            "expression \"x*r1\", column 3: unknown name \"r1\"; did you mean \"r2\"?");
  EXPECT_EQ(error("velocity"),
            "expression \"velocity\", column 1: unknown name \"velocity\"; known: x, y, nx, ny, pi, E, nu");
}

struct Bad {
  const char* text;
  int column;
  const char* words;
};
void PrintTo(const Bad& b, std::ostream* out) {
  *out << b.text;
}
class Mistakes : public testing::TestWithParam<Bad> {};

TEST_P(Mistakes, AreFoundAtTheirColumn) {
  const std::string message = error(GetParam().text);
  EXPECT_NE(message.find(", column " + std::to_string(GetParam().column) + ": "), std::string::npos) << message;
  EXPECT_NE(message.find(GetParam().words), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(Expression, Mistakes,
                         testing::Values(Bad{"x = 5", 3, "write == to compare"}, Bad{"1 +", 4, "ends too early"},
                                         Bad{"(1", 3, "parenthesis"}, Bad{"1)", 2, "unexpected parenthesis"},
                                         Bad{"2x", 2, "operator such as *"}, Bad{"x y", 3, "operator such as *"},
                                         Bad{"x**2", 3, "write powers as x^2"}, Bad{"x*/2", 3, "unexpected operator"},
                                         Bad{"1,5", 2, "written with a point"}, Bad{"sin", 1, "sin(...)"},
                                         Bad{"sin(1,2)", 8, "too many arguments"},
                                         Bad{"atan2(1)", 8, "too few arguments"}, Bad{"x > 1 ? 2", 1, "c ? a : b"},
                                         Bad{"1/0", 1, "not finite (inf)"}, Bad{"log(-1)", 1, "not finite"},
                                         Bad{"1e999", 1, "does not fit"}, Bad{"x & y", 3, "&& ||"},
                                         Bad{"!x", 1, "&& ||"}, Bad{"$x", 1, "unexpected character"},
                                         Bad{"x \xC3\xA9", 3, "\"\xC3\xA9\""}, Bad{"\"x\"", 1, "unexpected character"},
                                         Bad{"x(1)", 1, "not a function"}, Bad{"_pi", 1, "unknown"},
                                         Bad{"inf", 1, "unknown name"}, Bad{"x;y", 2, "unexpected character"},
                                         Bad{"1 ? 2 : 3 : 4", 11, "misplaced ? or :"}, Bad{": 1", 1, "c ? a : b"},
                                         Bad{"sin(x,)", 7, "unexpected"}, Bad{",x", 1, "written with a point"}));

TEST(Expression, RefusesEmptyText) {
  for (const char* text : {"", "  ", "\n"}) EXPECT_NE(error(text).find("empty"), std::string::npos);
}

TEST(Expression, RefusesTheNormalInsideTheBody) {
  const ExpressionContext context{{{"t", "2*nx"}}, 0, 0, false};
  EXPECT_NE(error("ny", context).find("no normal inside the body"), std::string::npos);
  EXPECT_NE(error("x + t", context).find("no normal inside the body"), std::string::npos);
  EXPECT_DOUBLE_EQ(value("x + y", {1, 2}, context), 3);
}

TEST(Expression, ValueThatIsNotFiniteIsAnError) {
  const Expression f = parse_expression("log(x)", {});
  EXPECT_DOUBLE_EQ(f({1, 0}, {1, 0}), 0);
  try {
    f({-1, 2}, {1, 0});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_NE(std::string(e.what()).find("expression \"log(x)\" is not finite"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("at (-1, 2)"), std::string::npos) << e.what();
  }
  EXPECT_DOUBLE_EQ(f({1, 0}, {1, 0}), 0);  // and goes on
}

TEST(Expression, NotANumberIsNotSwallowed) {
  for (const char* text : {"min(1, log(x))", "min(log(x), 1)", "max(log(x), 1)", "max(1, log(x), 2)", "sign(log(x))"})
    EXPECT_THROW(value(text, {-1, 0}), Error) << text;
  EXPECT_THROW(parse_expression("min()", {}), Error);
}

TEST(Expression, BranchNotTakenDoesNoHarm) {
  const ExpressionContext context{{{"l", "log(x)"}}, 0, 0};
  EXPECT_DOUBLE_EQ(value("x > 0 ? l : 0", {-1, 0}, context), 0);
}

TEST(Expression, ThreadsDoNotDisturbEachOther) {
  const Expression f = parse_expression("a*cos(b) + y", {{{"b", "3*x"}, {"a", "b^2 + nx"}}, 0, 0});
  std::vector<int> wrong(8, 0);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 8; ++t)
      threads.emplace_back([&f, &wrong, t] {
        for (int k = 0; k < 20000; ++k) {
          const Vec2 at(0.001 * k, t);
          const double b = 3 * at.x(), expected = (b * b + 0.5) * std::cos(b) + t;
          if (std::abs(f(at, {0.5, 0}) - expected) > 1e-12 * (1 + std::abs(expected))) ++wrong[t];
        }
      });
  }
  for (const int count : wrong) EXPECT_EQ(count, 0);
}

TEST(Expression, ListsItsNames) {
  EXPECT_EQ(names_in("a + sin(b*x) - a/2e3"), (std::vector<std::string>{"a", "b", "x"}));
}

}  // namespace
}  // namespace kerf::expression_test
