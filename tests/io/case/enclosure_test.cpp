// What is proved of expressions: sampled values lie in their enclosures, and integrals are right to the proved error.

#include "io/case/formula.hpp"
#include "solver/data.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::enclosure_test {

namespace {

ExpressionContext context() {
  ExpressionContext c;
  c.definitions = {{"r", "sqrt((x-1)^2+(y-0.3)^2)"}, {"bump", "exp(-(r/0.1)^2)"}};
  c.young = 2;
  c.poisson = 0.3;
  return c;
}

Formula formula_of(const std::string& text) {
  return {parse_expression(text, context()), std::nullopt, syntax_of(text, context())};
}

const std::vector<std::string> texts = {
    "1",
    "x",
    "-x^2",
    "2^-x^2",
    "-2^2*x",
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
    "log(1+x)+ln(2+y)+log2(3+x)+log10(4+y)",
    "asin(x/3)+acos(y/3)+sinh(x)-cosh(y)+tanh(4*x-4)",
    "asinh(x)+acosh(2+y)+atanh(x/3)",
    "sum(x,y,1)/avg(x+1,2)",
    "bump*r+bump",
    "r",
    "1/(1+100*(x-1)^2)",
    "nx*x+ny",
    "x<=0.7 ? x : 1-y",
    "y>=0.4 ? x*y : 2",
    "x+y<=5 ? x : y",
    "x+y>=5 ? x : y",
    "x+y<=-5 ? x : y",
    "0*(1+x)",
    "-(2-x)^(-0.4)",
    "1-(2.5-x)^0.5/(1+y)",
    "1/(3-x)^(0.4)",
    "x<9 ? (2-x)^(-0.4) : 7",
    "(1+x)^(-2)-x^0",
    "x>0.2 ? x : 1-y",
    "sign(abs(x-1))-sign(-abs(y-0.5))",
    "x-1.9 ? (2-x)^(-0.4) : 7",
    "sin((2-x)^0.5)",
};

}  // namespace

TEST(Enclosure, HoldsEveryValue) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(0, 1);
  for (const std::string& text : texts) {
    const Formula f = formula_of(text);
    ASSERT_TRUE(f.syntax) << text;
    for (int trial = 0; trial < 60; ++trial) {
      const EdgeLine edge{Vec2(2 * in(random), in(random)), Vec2(2 * in(random), in(random)), Vec2(0.6, 0.8)};
      const double from = 0.9 * in(random), to = from + (1 - from) * std::pow(in(random), 3);
      const ScalarOnPiece piece = enclose(f.syntax, edge, from, to);
      Interval x{infinity, -infinity}, y = x;
      double low = infinity, high = -infinity;
      for (int k = 0; k <= 20; ++k) {
        const Vec2 p = edge.a + (from + (to - from) * k / 20) * (edge.b - edge.a);
        x = hull(x, exactly(p.x()));
        y = hull(y, exactly(p.y()));
        const double v = f.value(p, edge.n);
        low = std::min(low, v);
        high = std::max(high, v);
      }
      const double slack = 1e-14 * (1 + std::abs(low) + std::abs(high));
      EXPECT_LE(piece.value.low, low + slack) << text;
      EXPECT_GE(piece.value.high, high - slack) << text;
      const Interval box = enclose(*f.syntax, x, y);
      EXPECT_LE(box.low, low + slack) << text;
      EXPECT_GE(box.high, high - slack) << text;
      if (piece.cut) {
        EXPECT_GE(piece.cut->low, from);
        EXPECT_LE(piece.cut->high, to);
      }
    }
  }
}

// Eight divided differences of f over the piece are f^(8)/8! somewhere in it.
TEST(Enclosure, HoldsTheEighthDerivative) {
  for (const std::string& text : texts) {
    const Formula f = formula_of(text);
    const EdgeLine edge{Vec2(0.2, 0.1), Vec2(1.7, 0.9), Vec2(0.6, 0.8)};
    for (const double from : {0.0, 0.3, 0.7}) {
      const double to = from + 0.25;
      const ScalarOnPiece piece = enclose(f.syntax, edge, from, to);
      if (!std::isfinite(piece.eighth)) continue;
      std::vector<double> s, d;
      double size = 0;
      for (int k = 0; k <= 8; ++k) {
        s.push_back(0.5 * (from + to) - 0.5 * (to - from) * std::cos(pi * (k + 0.5) / 9));
        d.push_back(f.value(edge.a + s.back() * (edge.b - edge.a), edge.n));
        size = std::max(size, std::abs(d.back()));
      }
      for (int order = 1; order <= 8; ++order)
        for (int k = 8; k >= order; --k) d[k] = (d[k] - d[k - 1]) / (s[k] - s[k - order]);
      EXPECT_LE(std::abs(d[8]), piece.eighth * (1 + 1e-6) + 1e-10 * size / std::pow(to - from, 8)) << text;
    }
  }
}

TEST(Enclosure, KnowsPolynomials) {
  EXPECT_EQ(degree_of(*syntax_of("x^3-2*x*y+E*nu", context())), 3);
  EXPECT_EQ(degree_of(*syntax_of("(x+y)^2/4", context())), 2);
  EXPECT_EQ(degree_of(*syntax_of("nx*x", context())), 1);
  EXPECT_EQ(degree_of(*syntax_of("sin(2)", context())), 0);
  EXPECT_EQ(degree_of(*syntax_of("x/y", context())), -1);
  EXPECT_EQ(degree_of(*syntax_of("abs(x)", context())), -1);
  EXPECT_EQ(degree_of(*syntax_of("-x^2", context())), 2);
  EXPECT_EQ(degree_of(*syntax_of("(1+x)^16", context())), 16);
  EXPECT_EQ(degree_of(*syntax_of("2^3*x", context())), 1);
  // No polynomials, or none of a degree that would help.
  for (const char* text : {"x^17", "x^-1", "x^0.5", "x^y", "abs(x)^2", "x/(1+x)", "abs(x)/2", "abs(x)*2", "2-abs(x)"})
    EXPECT_EQ(degree_of(*syntax_of(text, context())), -1) << text;
}

TEST(Enclosure, OfBothComponents) {
  const VectorField both = body_field(formula_of("x*y"), formula_of("1-x"));
  const std::array<Interval, 2> over = both.known()->over({0, 1}, {1, 2});
  EXPECT_LE(over[0].low, 0);
  EXPECT_NEAR(over[0].high, 2, 1e-12);
  EXPECT_GE(over[0].high, 2);
  EXPECT_NEAR(over[1].low, 0, 1e-12);
  EXPECT_NEAR(over[1].high, 1, 1e-12);
  EXPECT_EQ(both.known()->degree(), 2);
  EXPECT_EQ(body_field(formula_of("abs(x)"), formula_of("x")).known()->degree(), -1);
  EXPECT_EQ(body_field(formula_of("x"), formula_of("abs(x)")).known()->degree(), -1);
  // Inside there is no normal to turn a pressure by.
  const BoundaryField pressure = pressure_field(formula_of("x^3"));
  EXPECT_EQ(pressure.known()->degree(), 3);
  for (const Interval& any : pressure.known()->over({0, 1}, {0, 1})) EXPECT_FALSE(is_bounded(any));
}

struct Load {
  std::string text;
  double truth;      // from 0 to 2
  double tolerance;  // relative
};

void PrintTo(const Load& l, std::ostream* out) {
  *out << l.text;
}

class Integration : public testing::TestWithParam<Load> {};

// The integral over 0 <= x <= 2 from ten edges.
TEST_P(Integration, IsRightToTheProvedError) {
  const Load& load = GetParam();
  const BoundaryField f = vector_field(formula_of(load.text), nothing());
  const EdgeRule rule = gauss(data_points);
  double total = 0, proved = 0, size = 0;
  const auto edge = [](int k) {
    return EdgeLine{Vec2(2 - 0.2 * k, 1), Vec2(k == 9 ? 0 : 1.8 - 0.2 * k, 1), Vec2(0, 1)};
  };
  for (int k = 0; k < 10; ++k) size = std::max(size, size_on(f, edge(k)));
  for (int k = 0; k < 10; ++k) {
    const EdgeValues v = edge_values(f, edge(k), "load", size);
    EXPECT_EQ(v.how, Resolution::Proved) << k;
    total += 0.2 * v.at.row(0).dot(rule.w.transpose());
    proved += 0.2 * v.error[0];
  }
  EXPECT_NEAR(total, load.truth, proved + 1e-14 * std::abs(load.truth) + 1e-16 * size);
  EXPECT_NEAR(total, load.truth, load.tolerance * std::abs(load.truth));
}

INSTANTIATE_TEST_SUITE_P(
    Loads, Integration,
    testing::Values(Load{"abs(x-1.513)<0.005 ? -100 : 0", -1, 1e-11}, Load{"abs(x-1.513)<0.1 ? -100 : 0", -20, 1e-12},
                    Load{"abs(x-1.513)<0.05 ? -100 : 0", -10, 1e-12}, Load{"abs(x-1.513)<0.025 ? -100 : 0", -5, 1e-12},
                    Load{"abs(x-1.513)<0.01 ? -100 : 0", -2, 1e-11}, Load{"abs(x-1.513)<5e-10 ? -100 : 0", -1e-7, 1e-5},
                    Load{"exp(-((x-1.513)/1e-3)^2)", 1e-3 * std::sqrt(pi), 1e-10},
                    Load{"exp(-((x-1.513)/1e-6)^2)", 1e-6 * std::sqrt(pi), 1e-9},
                    Load{"(2-x)^(-0.4)", std::pow(2, 0.6) / 0.6, 1e-10},
                    Load{"(2-x)^(-0.8)", std::pow(2, 0.2) / 0.2, 1e-10},
                    Load{"1+x*(2-x)^(-0.8)", 2 + 2 * std::pow(2, 0.2) / 0.2 - std::pow(2, 1.2) / 1.2, 1e-10},
                    Load{"1e-4/((x-1.513)^2+1e-8)", std::atan(0.487e4) + std::atan(1.513e4), 1e-9},
                    Load{"abs(32*x-rint(32*x))<0.00032 ? 1 : 0", 64 * 2e-5, 1e-8},
                    Load{"(x-1.2)^2<1e-10 ? 1 : 0", 2e-5, 1e-9}, Load{"max(0,x-1.31)", 0.5 * 0.69 * 0.69, 1e-12},
                    Load{"-(2-x)^(-0.4)", -std::pow(2, 0.6) / 0.6, 1e-10},
                    Load{"1-(2-x)^(-0.4)", 2 - std::pow(2, 0.6) / 0.6, 1e-10},
                    Load{"(2-x)^(-0.4)/4", std::pow(2, 0.6) / 2.4, 1e-10},
                    Load{"x<9 ? (2-x)^(-0.4) : 7", std::pow(2, 0.6) / 0.6, 1e-10},
                    Load{"x>9 ? 7 : 3*(2-x)^(-0.4)", std::pow(2, 0.6) / 0.2, 1e-10}, Load{"x<=0.7 ? 1 : 0", 0.7, 1e-12},
                    Load{"x>=0.7 ? 1 : 0", 1.3, 1e-12}, Load{"sqrt(2-x)", std::pow(2, 1.5) / 1.5, 1e-10},
                    Load{"exp(x)", std::exp(2) - 1, 1e-10}, Load{"1+1/(2-x)^(-0.4)", 2 + std::pow(2, 1.4) / 1.4, 1e-9},
                    Load{"x-1.9 ? (2-x)^(-0.3) : 7", std::pow(2, 0.7) / 0.7, 1e-9}));

// Both components at once: of the same power, of another one, and of none.
TEST(Integration, ComponentsWithPowersOfTheirOwn) {
  const EdgeRule rule = gauss(data_points);
  const EdgeLine edge{Vec2(2, 1), Vec2(0, 1), Vec2(0, 1)};  // half the mean is the integral over it
  const auto of = [](double exponent) { return std::pow(2, 1 + exponent) / (1 + exponent); };
  for (const auto& [second, truth] : {std::pair("3*(2-x)^(-0.4)", 3 * of(-0.4)), std::pair("(2-x)^(-0.3)", of(-0.3)),
                                      std::pair("1+x", 4.0), std::pair("3", 6.0)})
    for (const Index other : {1, 0}) {
      const Formula power = formula_of("(2-x)^(-0.4)"), beside = formula_of(second);
      const EdgeValues v =
          edge_values(other == 1 ? vector_field(power, beside) : vector_field(beside, power), edge, "load", 10);
      const Vec2 total = 2 * v.at * rule.w;
      EXPECT_NEAR(total[1 - other], of(-0.4), 2 * v.error[1 - other] + 1e-13) << second;
      EXPECT_NEAR(total[other], truth, 2 * v.error[other] + 1e-13) << second;
      if (v.how != Resolution::Open) {
        EXPECT_NEAR(total[other], truth, 1e-8 * truth) << second;
      }
    }
}

// A square that is not integrable is said; an integral that is not known is open, not wrong.
TEST(Integration, SaysWhatItCannotKnow) {
  const EdgeLine edge{Vec2(2, 1), Vec2(1.8, 1), Vec2(0, 1)};
  const EdgeValues steep = edge_values(vector_field(formula_of("(2-x)^(-0.8)"), nothing()), edge, "load");
  EXPECT_EQ(steep.rest[0], infinity);
  const EdgeValues log = edge_values(vector_field(formula_of("log(2-x)"), nothing()), edge, "load");
  EXPECT_EQ(log.how, Resolution::Open);
  for (const char* text : {"((2-x)^(-0.3))^2", "1+1/(2-x)^0.4"})
    EXPECT_EQ(edge_values(vector_field(formula_of(text), nothing()), edge, "load").how, Resolution::Open) << text;
}

// One look for smooth loads; the values are those at the points.
TEST(Integration, CostsNothingForPolynomials) {
  int calls = 0;
  Formula f = formula_of("1+x^3-2*x");
  f.value = [value = f.value, &calls](const Vec2& x, const Vec2& n) { return ++calls, value(x, n); };
  const EdgeLine edge{Vec2(2, 1), Vec2(1.8, 1), Vec2(0, 1)};
  const EdgeValues v = edge_values(vector_field(f, nothing()), edge, "load");
  EXPECT_EQ(calls, data_points);
  EXPECT_EQ(v.error[0], 0);
  EXPECT_EQ(v.rest[0], 0);
  const EdgeRule rule = gauss(data_points);
  for (int q = 0; q < data_points; ++q) EXPECT_EQ(v.at(0, q), f.value(edge.a + rule.s[q] * (edge.b - edge.a), edge.n));
}

// Pressures and loads on rollers keep what is known.
TEST(Integration, FollowsTheNormal) {
  const EdgeLine edge{Vec2(2, 0), Vec2(1, 1), Vec2(1, 1).normalized()};
  const EdgeRule rule = gauss(data_points);
  const BoundaryField p = pressure_field(formula_of("abs(x-1.513)<0.005 ? 100 : 0"));
  const EdgeValues v = edge_values(p, edge, "load");
  EXPECT_NEAR(v.at.row(0).dot(rule.w.transpose()), -1 / std::sqrt(2), 1e-11);
  EXPECT_NEAR(v.at.row(1).dot(rule.w.transpose()), -1 / std::sqrt(2), 1e-11);
  EXPECT_EQ(v.how, Resolution::Proved);
  const EdgeValues none_left = edge_values(without_normal_part(p), edge, "load");
  EXPECT_NEAR(none_left.at.norm(), 0, 1e-10);
  const EdgeValues y = edge_values(without_component(p, 0), edge, "load");
  EXPECT_EQ(y.at.row(0).norm(), 0);
  EXPECT_NEAR(y.at.row(1).dot(rule.w.transpose()), -1 / std::sqrt(2), 1e-11);
}

// A pressure that grows without bound towards a corner keeps its power, whatever the normal does to it.
TEST(Integration, PressuresOfPowers) {
  const EdgeLine edge{Vec2(2, 0), Vec2(0, 2), Vec2(1, 1).normalized()};
  const EdgeRule rule = gauss(data_points);
  const EdgeValues v = edge_values(pressure_field(formula_of("(2-x)^(-0.4)")), edge, "load", 10);
  EXPECT_EQ(v.how, Resolution::Proved);
  const Vec2 total = 2 * v.at * rule.w;  // over x from 0 to 2
  for (const Index d : {0, 1}) EXPECT_NEAR(total[d], -std::pow(2, 0.6) / 0.6 / std::sqrt(2), 1e-9);
}

}  // namespace kerf::enclosure_test
