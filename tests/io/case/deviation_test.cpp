// How far expressions are from polynomials over boxes: never further than is said, seen by differences that no
// polynomial has, and as near as their branches are smooth.

#include "io/case/formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::deviation_test {
namespace {

ExpressionContext context() {
  ExpressionContext c;
  // sqrt(z^2 - 1) as one writes it with real numbers: the heat beside a crack.
  c.definitions = {{"X", "x^2 - y^2 - 1"},
                   {"R", "sqrt(X^2 + 4*x^2*y^2)"},
                   {"flow", "X > 0 ? abs(x)*y/sqrt((R + X)/2) : (y > 0 ? 1 : -1)*sqrt((R - X)/2)"},
                   {"heat", "max(-sqrt(R), min(sqrt(R), flow))"},
                   {"r", "sqrt((x-1)^2+(y-0.3)^2)"}};
  c.young = 2;
  c.poisson = 0.3;
  return c;
}
Formula formula_of(const std::string& text) {
  return {parse_expression(text, context()), std::nullopt, syntax_of(text, context())};
}
double deviation_over(const std::string& text, const Vec2& middle, double wide, int degree = 7) {
  const Interval x{middle.x() - wide / 2, middle.x() + wide / 2}, y{middle.y() - wide / 2, middle.y() + wide / 2};
  return deviation(*syntax_of(text, context()), x, y, degree);
}

const std::vector<std::string> texts = {"1",
                                        "x^3-2*x*y+E*nu",
                                        "x<1 ? x : 2-x",
                                        "1<2<3",
                                        "x<0.5||y<0.5&&x<1 ? 1 : -1",
                                        "x!=1 ? (y==0.5 ? 2 : 3) : 4",
                                        "abs(x-1.1)-abs(y)",
                                        "min(x,y,1-x)+max(x*y,0.2)",
                                        "sign(x-y)*rint(3*x)",
                                        "sqrt(abs(x-1))",
                                        "(2-x)^(-0.4)",
                                        "x^1.5+(x+1)^y",
                                        "exp(-x)*sin(7*y)+cos(x*y)",
                                        "tan(x/2)+atan(3*y)+atan2(y+0.1,x-3)",
                                        "atan2(y-0.5,x-1)",
                                        "log(1+x)+ln(2+y)+log2(3+x)+log10(4+y)",
                                        "asin(x/3)+acos(y/3)+sinh(x)-cosh(y)+tanh(4*x-4)",
                                        "asinh(x)+acosh(2+y)+atanh(x/3)",
                                        "sum(x,y,1)/avg(x+1,2)",
                                        "exp(-(r/0.1)^2)*r",
                                        "r",
                                        "1/(1+100*(x-1)^2)",
                                        "1-(2.5-x)^0.5/(1+y)",
                                        "x>1 ? sqrt(x-1) : (1-x)^2",
                                        "(x-1)^65",
                                        "(1+x)^(-2)-x^0",
                                        "heat",
                                        "abs(heat-0.2)"};

// The difference of order n + 1 along a line is 0 of a polynomial of degree n: of f it is at most 2^(n + 1) deviations.
TEST(Deviation, IsNeverLargerThanSaid) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(0, 1);
  int bounded = 0;
  for (const std::string& text : texts) {
    const Formula f = formula_of(text);
    ASSERT_TRUE(f.syntax) << text;
    for (int trial = 0; trial < 80; ++trial) {
      const Vec2 low(1.9 * in(random), in(random));
      const double wide = std::pow(10, -3 * in(random));
      const Interval x{low.x(), std::min(low.x() + wide * in(random), 1.99)}, y{low.y(), low.y() + wide * in(random)};
      for (const int degree : {1, 4, 7}) {
        const double said = deviation(*f.syntax, x, y, degree);
        if (!std::isfinite(said)) continue;
        ++bounded;
        for (int line = 0; line < 4; ++line) {
          const auto inside = [&] {
            return Vec2(x.low + in(random) * (x.high - x.low), y.low + in(random) * (y.high - y.low));
          };
          const Vec2 a = inside(), b = inside();
          double sum = 0, size = 0, times = 1;
          for (int k = 0; k <= degree + 1; ++k) {
            const double v = f.value(a + double(k) / (degree + 1) * (b - a), Vec2::Zero());
            sum += (k % 2 == 0 ? 1 : -1) * times * v;
            size = std::max(size, times * std::abs(v));
            times *= double(degree + 1 - k) / (k + 1);
          }
          EXPECT_LE(std::abs(sum), std::ldexp(said, degree + 1) + 1e-13 * size) << text << " degree " << degree;
        }
      }
    }
  }
  EXPECT_GT(bounded, 5000);
}

// Where ranges settle the branch it is as smooth as the branch.
TEST(Deviation, OfASettledBranchIsThatOfTheBranch) {
  const Vec2 at(0.6, 0.4);
  const double smooth = deviation_over("exp(x)*sin(y)", at, 0.1);
  EXPECT_LT(smooth, 1e-11);
  for (const char* text : {"x < 1 ? exp(x)*sin(y) : 7", "max(exp(x)*sin(y), -1)", "abs(exp(x)*sin(y))",
                           "min(exp(x)*sin(y), 2 + x)", "y > 3 && x > 0 ? 1 : exp(x)*sin(y)"})
    EXPECT_LT(deviation_over(text, at, 0.1), 10 * smooth + 1e-14) << text;
  EXPECT_LT(deviation_over("sqrt((exp(x)*sin(y))^2)", at, 0.01), 1e-10);
}

// A kink leaves no more than what its branches differ by: a quarter of the box times the jump of the slope, at least an
// eighth; a jump leaves half of itself.
TEST(Deviation, OfKinksAndJumpsIsTheDifferenceOfTheBranches) {
  for (const double wide : {0.2, 0.02, 0.002}) {
    EXPECT_LE(deviation_over("exp(y)*abs(x - 1)", {1, 0}, wide), 0.6 * wide);
    EXPECT_LE(deviation_over("max(x, 2 - x)", {1, 0}, wide), 0.6 * wide);
    EXPECT_LE(deviation_over("x < 1 ? x : 2 - x", {1, 0}, wide), 0.6 * wide);
    EXPECT_LE(deviation_over("x < 1 ? sin(y) : sin(y) + 3", {1, 0}, wide), 1.5 * 1.01);
  }
}

// Two ways to write one smooth function, which a kink only touches: no order of the branches is lost.
TEST(Deviation, OfBranchesThatAreOneFunctionIsSmall) {
  // On X = 0, where the branches meet, and where max and min touch (x = 0).
  EXPECT_LT(deviation_over("heat", {std::sqrt(1 + 2.25), 1.5}, 0.1), 1e-8);
  EXPECT_LT(deviation_over("heat", {0, 2}, 0.1), 1e-5);
  EXPECT_LT(deviation_over("heat", {0.003, 2}, 0.01), 1e-8);
  const double coarse = deviation_over("heat", {std::sqrt(1 + 2.25), 1.5}, 0.2);
  EXPECT_LT(deviation_over("heat", {std::sqrt(1 + 2.25), 1.5}, 0.1), coarse / 64);
}

TEST(Deviation, OfPolynomialsIsRounding) {
  EXPECT_LT(deviation_over("x^3*y^4 - 2*x*y + 1", {1, 1}, 1), 1e-11);
  EXPECT_GT(deviation_over("x^3*y^4 - 2*x*y + 1", {1, 1}, 1, 4), 1e-6);
  EXPECT_LT(deviation_over("3", {1, 1}, 1), 1e-300);
}

TEST(Deviation, IsUnknownWhereNothingIsKnown) {
  for (const char* text : {"1/x", "log(x)", "nx*x", "tan(x*20)"})
    EXPECT_EQ(deviation_over(text, {0, 0.1}, 0.5), infinity) << text;
  // Its range is all that is known where a root begins.
  EXPECT_NEAR(deviation_over("sqrt(x)", {0.5, 0}, 1), 0.5, 1e-9);
}

}  // namespace
}  // namespace kerf::deviation_test
