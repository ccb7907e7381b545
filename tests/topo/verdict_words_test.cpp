// The words of verdicts, from series made up so that one thing alone is in the way.

#include "tests/topo/validation.hpp"
#include "topo/validate/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace kerf::verdict_words_test {
namespace {

using namespace scenes;

struct Series {
  std::function<double(double)> quotient;  // of the radius
  std::vector<double> radii = usual_radii;
  double claimed = 1, clear = 0.8;
  std::size_t moved = 0;  // radii, of the largest ones, at which contact moves
  Perturbation::Kind kind = Perturbation::Kind::Hole;
};

Validation judged(const Series& s) {
  Validation v;
  v.coefficient = s.claimed;
  v.size = 2;
  v.plateau = 3e-4;
  std::vector<double> scales;
  for (const double eps : s.radii) {
    scales.push_back(s.kind == Perturbation::Kind::ClampedHole ? 1 : pi * eps * eps);
    v.rows.push_back(
        {.radius = eps, .J = 1, .difference = scales.back() * s.quotient(eps), .predicted = scales.back()});
    v.rows.back().predicted *= s.claimed;
    v.rows.back().same_contact = v.rows.size() > s.moved;
  }
  judge(v, {.kind = s.kind}, scales, s.clear);
  return v;
}

void expect(const Series& s, Verdict verdict, const std::string& words) {
  const Validation v = judged(s);
  EXPECT_EQ(v.verdict, verdict) << text(v);
  EXPECT_NE(v.reason.find(words), std::string::npos) << v.reason;
}

double one(double) {
  return 1;
}

TEST(VerdictWords, OfEveryVerdict) {
  EXPECT_EQ(word(Verdict::Holds), "holds");
  EXPECT_EQ(word(Verdict::Fails), "fails");
  EXPECT_EQ(word(Verdict::Vanishes), "vanishes");
  EXPECT_EQ(word(Verdict::OutOfRange), "out of range");
  EXPECT_EQ(word(Verdict::NothingSaid), "nothing can be said");
}

TEST(VerdictWords, RadiiAndNumbersOutOfRange) {
  expect({.quotient = one, .radii = {0.08}}, Verdict::OutOfRange,
         "fewer than two radii fit: the nearest boundary, crack or other feature is 0.8 away; use radii below 0.2");
  // Areas below all numbers.
  expect({.quotient = one, .radii = {1e-170, 1e-171}}, Verdict::NothingSaid,
         "the prediction and the differences leave the range of numbers, or are null");
  // The coefficient is wrong, but the nearest feature is but three of the smallest radii away.
  expect({.quotient = one, .claimed = 1.02, .clear = 0.03}, Verdict::OutOfRange,
         "the radii are too large: the nearest feature is 0.03 away; use radii below 0.0075");
  // Odd powers of the radius are no series of a hole: what is left halves with the radius.
  expect({.quotient = [](double eps) { return 1 + 8 * eps; }}, Verdict::OutOfRange,
         "the remainder is still 0.08 of the prediction and falling; use smaller radii");
}

TEST(VerdictWords, ContactThatMoves) {
  const auto wrong = [](double eps) { return 1.02 + eps * eps; };
  expect({.quotient = wrong, .moved = 2}, Verdict::OutOfRange,
         "the contact set changes at larger radii; use more and smaller ones");
  expect({.quotient = wrong, .moved = 4}, Verdict::OutOfRange, "the contact set changes even at the smallest radius");
  expect({.quotient = one, .moved = 2}, Verdict::Holds, "contact moves with the larger radii");
  expect({.quotient = one, .moved = 4}, Verdict::Holds, "contact moves with every radius");
}

// The second term is that of contact as it is: where every radius moves it, another c2 of the series is no fault of it.
TEST(VerdictWords, ContactThatMovesWithEveryRadiusHasNoSecondTerm) {
  const auto series = [](std::size_t moved) {
    Validation v;
    v.coefficient = 1;
    v.size = 2;
    v.plateau = 3e-4;
    v.logarithm = Logarithm::Absent;
    v.c2_predicted = v.c2_on_mesh = 1.5;
    std::vector<double> scales;
    for (const double eps : usual_radii) {
      const double square = eps * eps;
      scales.push_back(pi * square);
      v.rows.push_back({.radius = eps, .J = 1, .difference = pi * square * (1 + 3 * square), .predicted = pi * square});
      v.rows.back().same_contact = v.rows.size() > moved;
    }
    judge(v, {}, scales, 0.8);
    return v;
  };
  for (const std::size_t moved : {0, 2}) EXPECT_EQ(series(moved).verdict, Verdict::Fails) << series(moved).reason;
  const Validation all = series(4);
  EXPECT_EQ(all.verdict, Verdict::Holds) << all.reason;
  EXPECT_NE(all.reason.find("c2 is 1.5 by the formula and 3 by the series, which says nothing of the formula"),
            std::string::npos)
      << all.reason;
}

TEST(VerdictWords, NothingFailsBeyondWhatTheBodyAnswers) {
  const Series wrong{.quotient = [](double eps) { return 1.02 + eps * eps; }};
  ASSERT_EQ(judged(wrong).verdict, Verdict::Fails);
  for (const double answered : {nan, infinity, 0.8, 0.041}) {
    Validation v = judged(wrong);
    withdraw(v, answered, 0.8);
    EXPECT_EQ(v.verdict, Verdict::Fails) << answered;
  }
  Validation near = judged(wrong);  // a body bounded close by answers so, too, and has words of its own
  withdraw(near, 0.039, 0.1);
  EXPECT_EQ(near.verdict, Verdict::Fails);
  Validation v = judged(wrong);  // the smallest radius is 0.01
  withdraw(v, 0.039, 0.8);
  EXPECT_EQ(v.verdict, Verdict::OutOfRange);
  EXPECT_NE(v.reason.find("it answers a change of radius 0.039 by as much stress"), std::string::npos) << v.reason;
  EXPECT_NE(v.reason.find("use radii below 0.0097"), std::string::npos) << v.reason;
  Validation holds = judged({.quotient = one});
  withdraw(holds, 1e-6, 0.8);
  EXPECT_EQ(holds.verdict, Verdict::Holds);
}

/// Of a clamped hole the series is that of difference over prediction, whose limit is 1.
TEST(VerdictWords, ClampedHoles) {
  const auto kind = Perturbation::Kind::ClampedHole;
  expect({.quotient = [](double eps) { return 1 + 2 * eps * eps; }, .kind = kind}, Verdict::Holds,
         "the remainder falls like eps^2.00");
  expect({.quotient = [](double eps) { return 1.05 + 2 * eps * eps; }, .kind = kind}, Verdict::Fails,
         "the differences tend to 1.05 of the prediction");
  // Other orders are no slope of it, but what has fallen far enough holds.
  expect({.quotient = [](double eps) { return 1 + 300 * std::pow(eps, 4); }, .kind = kind}, Verdict::Holds,
         "the remainder has fallen to what the mesh leaves");
  expect(
      {.quotient = [](double eps) { return 1 + 5 * eps * eps * std::log(eps); }, .radii = {0.08, 0.04}, .kind = kind},
      Verdict::OutOfRange, "of the prediction 1; use four");
}

/// Nor is the sixth order that of a hole whose area is divided by.
TEST(VerdictWords, ASlopeThatIsTooSteep) {
  const Series steep{.quotient = [](double eps) { return 1 + 300 * std::pow(eps, 4); }};
  EXPECT_NEAR(judged(steep).order, 6, 1e-6);
  expect(steep, Verdict::Holds, "the remainder has fallen to what the mesh leaves");
}

/// T = 1 by the series; the change that was drawn has the area 2 and the difference 2, so that it says 1, too.
Validation drawn() {
  Validation v;
  v.coefficient = v.on_mesh = 1;
  v.plateau = 3e-4;
  v.verdict = Verdict::Holds;
  v.reason = "the series holds";
  v.drawn = {.radius = 0.01, .difference = 2, .rest = 0, .coefficient = 1};
  v.modes = {{"trace", 0.99}, {"deviator", 0.01}};
  return v;
}

// A wrong formula is as wrong on another mesh; what one mesh leaves is not.
TEST(VerdictWords, FailsIsConfirmedByADrawnChange) {
  Validation wrong = judged({.quotient = [](double eps) { return 1.02 + eps * eps; }});
  ASSERT_EQ(wrong.verdict, Verdict::Fails);
  EXPECT_EQ(wrong.drawn.radius, 0.08);
  EXPECT_NEAR(wrong.drawn.apart, 0.02, 1e-4);
  EXPECT_NEAR(wrong.drawn.rest, 0.0064, 1e-4);
  for (const double formula : {1.0, 1.009, 1.012, 1.02, 1.05}) {
    Validation v = wrong;
    v.on_mesh = 1;
    v.drawn.difference = 2 * (1.02 + 0.0064);
    v.drawn.coefficient = formula;
    conclude(v, 2, false);
    EXPECT_EQ(v.verdict, formula < 1.01 ? Verdict::Fails : Verdict::NothingSaid) << formula << ' ' << v.reason;
    if (formula == 1.02) {
      EXPECT_NE(
          v.reason.find("; but a change of radius 0.08 drawn on another mesh says 1.02, and the formula there 1.02"),
          std::string::npos)
          << v.reason;
    }
  }
}

TEST(VerdictWords, WhatADrawnChangeAdds) {
  Validation good = drawn();
  conclude(good, 2, false);
  EXPECT_EQ(good.verdict, Verdict::Holds);
  EXPECT_EQ(good.drawn.intercept, 1);
  EXPECT_EQ(good.reason.find("the series holds; a change of radius 0.01 drawn on another mesh says 1, the map 1 +- 0"),
            0u)
      << good.reason;
  EXPECT_NE(good.reason.find("hardly tested: deviator (1.0 % of T)"), std::string::npos) << good.reason;

  Validation other = drawn();  // the formula on the mesh of the change says 1.1
  other.drawn.coefficient = 1.1;
  conclude(other, 2, false);
  EXPECT_EQ(other.verdict, Verdict::NothingSaid);
  EXPECT_NE(other.reason.find("drawn on another mesh says 1, the formula there 1.1, here 1; use a smaller mesh.size"),
            std::string::npos)
      << other.reason;

  Validation coarse = drawn();  // the map says 1.05, and 3 times its distance is more than 10 %
  coarse.on_mesh = 1.05;
  conclude(coarse, 2, false);
  EXPECT_EQ(coarse.verdict, Verdict::NothingSaid);
  EXPECT_NEAR(coarse.bar, 0.15, 1e-12);
  EXPECT_NE(coarse.reason.find("the value depends on the mesh: 1.05 on that of the case, 1 by a change"),
            std::string::npos)
      << coarse.reason;

  Validation clamped = drawn();  // no area, and no parts of a formula
  clamped.drawn.difference = clamped.drawn.predicted = 1;
  conclude(clamped, 2, true);
  EXPECT_EQ(clamped.verdict, Verdict::Holds);
  EXPECT_EQ(clamped.drawn.intercept, 1);
  EXPECT_EQ(clamped.reason.find("hardly"), std::string::npos) << clamped.reason;
}

}  // namespace
}  // namespace kerf::verdict_words_test
