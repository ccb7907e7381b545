// What series of differences say, from rows made up by closed forms: D = T + c eps^2.

#include "topo/validate/verdict.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::verdict_test {
namespace {

using namespace scenes;

struct Made {
  double T = 1, slope = 3;       // of the body
  double claimed = 1, size = 2;  // coefficient; what T could be
  std::vector<double> radii = usual_radii;
  bool contact_moves = false;
};

Validation judged(const Made& m) {
  Validation v;
  v.coefficient = m.claimed;
  v.size = m.size;
  v.plateau = 3e-4;
  std::vector<double> scales;
  for (const double eps : m.radii) {
    scales.push_back(pi * eps * eps);
    ValidationRow row{.radius = eps, .J = 1};
    row.difference = scales.back() * (m.T + m.slope * eps * eps * (1 + 0.3 * std::log(eps)));
    row.predicted = scales.back() * m.claimed;
    row.same_contact = !m.contact_moves;
    v.rows.push_back(row);
  }
  judge(v, {}, scales, 0.8);
  return v;
}

// D = T + c2 eps^2 + c4 eps^4 (+ c3 eps^2 ln eps), where the formula says T = 1 and a c2.
struct Even {
  double T = 1, c2 = 3, c4 = 5, c3 = 0;
  double claimed = 1, second = 3;
  std::vector<double> radii = {0.16, 0.08, 0.04, 0.02, 0.01};
};
Validation judged_even(const Even& m) {
  Validation v;
  v.coefficient = m.claimed;
  v.size = 2;
  v.plateau = 3e-4;
  v.logarithm = m.c3 == 0 ? Logarithm::Absent : Logarithm::Known;
  v.c3 = m.c3;
  v.c2_predicted = v.c2_on_mesh = m.c3 == 0 ? m.second : nan;
  std::vector<double> scales;
  for (const double eps : m.radii) {
    scales.push_back(pi * eps * eps);
    const double square = eps * eps;
    ValidationRow row{.radius = eps, .J = 1};
    row.difference = scales.back() * (m.T + m.c2 * square + m.c4 * square * square + m.c3 * square * std::log(eps));
    row.predicted = scales.back() * m.claimed;
    v.rows.push_back(row);
  }
  judge(v, {}, scales, 0.8);
  return v;
}

TEST(Verdict, OfTwoTermsAsksForTheSecondAsWell) {
  const Validation right = judged_even({});
  EXPECT_EQ(right.verdict, Verdict::Holds) << right.reason;
  EXPECT_NEAR(right.intercept, 1, 1e-12);
  EXPECT_NEAR(right.c2, 3, 1e-9);
  EXPECT_NEAR(right.c4, 5, 1e-6);
  EXPECT_EQ(right.c3, 0);
  EXPECT_NEAR(right.rows[0].order_second, 6, 1e-6);
  EXPECT_NEAR(right.order_second, 6, 1e-6);
  EXPECT_NEAR(right.rows[0].remainder_second / right.rows[0].remainder, 5 * 0.0256 / (3 + 5 * 0.0256), 1e-9);
  EXPECT_NE(right.reason.find("eps^{6.00}"), std::string::npos) << right.reason;
  for (const double wrong : {2.7, 3.3, 0., -3.}) {
    const Validation v = judged_even({.second = wrong});
    EXPECT_EQ(v.verdict, Verdict::Fails) << wrong << ' ' << v.reason;
    EXPECT_NE(v.reason.find("second term"), std::string::npos) << v.reason;
  }
  // A second term that is too small to be seen says nothing.
  EXPECT_EQ(judged_even({.c2 = 0.01, .second = 0.02}).verdict, Verdict::Holds);
}

TEST(Verdict, OfTwoTermsFailsForHalfAPercentOfTheFirst) {
  for (const double c2 : {-10., -3., -1., 0.5, 1., 3., 10.})
    for (const double claimed : {0.995, 1.005}) {
      const Validation v = judged_even({.c2 = c2, .claimed = claimed, .second = c2});
      EXPECT_EQ(v.verdict, Verdict::Fails) << c2 << ' ' << claimed << ' ' << v.reason;
    }
  for (const double c2 : {-30., -3., 0.5, 3., 30.})
    for (const double first : {0.16, 0.08, 0.04}) {
      const Validation v = judged_even({.c2 = c2, .second = c2, .radii = {first, first / 2, first / 4}});
      EXPECT_NE(v.verdict, Verdict::Fails) << c2 << ' ' << first << ' ' << v.reason;
    }
}

TEST(Verdict, AKnownLogarithmIsNotFitted) {
  const Validation v = judged_even({.c3 = -2});
  EXPECT_EQ(v.verdict, Verdict::Holds) << v.reason;
  EXPECT_EQ(v.c3, -2);
  EXPECT_NEAR(v.c2, 3, 1e-9);
  EXPECT_NEAR(v.intercept, 1, 1e-12);
}

TEST(Verdict, HoldsForARightCoefficient) {
  EXPECT_EQ(judged({}).verdict, Verdict::Holds);
  EXPECT_EQ(judged({.slope = -20}).verdict, Verdict::Holds);
  EXPECT_EQ(judged({.contact_moves = true}).verdict, Verdict::Holds) << "contact that moves smoothly is part of it";
}

TEST(Verdict, ThreeRadiiOfARightCoefficientNeverFail) {
  for (const double slope : {-30., -3., 0.5, 3., 30.})
    for (const double first : {0.16, 0.08, 0.04}) {
      const Validation v = judged({.slope = slope, .radii = {first, first / 2, first / 4}});
      EXPECT_NE(v.verdict, Verdict::Fails) << slope << ' ' << first << ' ' << v.reason;
    }
}

// The remainder of a coefficient that is too large crosses zero at one radius: one settled radius is no evidence.
TEST(Verdict, HalfAPercentFailsWhereverItCrosses) {
  for (const double slope : {-10., -3., -1., 0.5, 1., 3., 10.})
    for (const double wrong : {0.995, 1.005}) {
      const Validation v = judged({.slope = slope, .claimed = wrong});
      EXPECT_EQ(v.verdict, Verdict::Fails) << slope << ' ' << wrong << ' ' << v.reason;
    }
}

TEST(Verdict, VanishesInsteadOfFailing) {
  EXPECT_EQ(judged({.T = 0, .slope = 0, .claimed = 0}).verdict, Verdict::Vanishes);
  EXPECT_EQ(judged({.T = 0, .slope = 1e-6, .claimed = 1e-5}).verdict, Verdict::Vanishes);
  EXPECT_EQ(judged({.T = 1e-5, .slope = 0.1, .claimed = -1e-5}).verdict, Verdict::Vanishes);
}

TEST(Verdict, CancellationIsNotBlamedWhereContactMoved) {
  const Made cancels{.T = 0.05, .claimed = 0.0505, .size = 2};
  EXPECT_EQ(judged(cancels).verdict, Verdict::NothingSaid);
  Made moves = cancels;
  moves.contact_moves = true;
  const Validation v = judged(moves);
  EXPECT_EQ(v.verdict, Verdict::OutOfRange);
  EXPECT_EQ(v.reason.find("cancels"), std::string::npos) << v.reason;
  EXPECT_NE(v.reason.find("contact set changes"), std::string::npos) << v.reason;
}

TEST(Verdict, RoundingSaysNothing) {
  Validation v;
  v.coefficient = v.size = 1;
  v.plateau = 3e-4;
  std::vector<double> scales;
  for (const double eps : usual_radii) {
    scales.push_back(pi * eps * eps);
    const double noise = (v.rows.size() % 2 ? -1 : 1) * 3e-5;
    v.rows.push_back({.radius = eps, .J = 1, .difference = scales.back() + noise, .predicted = scales.back()});
  }
  judge(v, {}, scales, 0.8);
  EXPECT_EQ(v.verdict, Verdict::NothingSaid) << v.reason;
}

// Stress like d^(-1/2) at a tip: its fourth power is not integrable.
TEST(Verdict, AnInfiniteFunctionalNeverHolds) {
  for (const double p : {4., 8.}) {
    const Body b{cracked_square(), pulled(plane_strain(1, 0.3), opens), {.size = 0.3}, element("bdms", 1)};
    const Validation v = validated(b, {"", {stress_pnorm(p, {}, true)}}, {0.15, 0.45});
    EXPECT_EQ(v.verdict, Verdict::NothingSaid) << v.reason;
    EXPECT_NE(v.reason.find("not integrable"), std::string::npos) << v.reason;
  }
}

// At a point of pure shear the trace part of the form is not seen, and the reason says so.
TEST(Verdict, NamesThePartsThatAPointDoesNotSee) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.tractions = {{0, [](const Vec2&, const Vec2&) { return Vec2(-1, 0); }},
                 {1, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }},
                 {2, [](const Vec2&, const Vec2&) { return Vec2(1, 0); }},
                 {3, [](const Vec2&, const Vec2&) { return Vec2(0, -1); }}};
  const Body b{rectangle({-1, -1}, {1, 1}), s, {.size = 0.4}, element("bdms", 1)};
  const Validation v = validated(b, {"", {energy()}}, {0, 0}, {}, {0.08, 0.04, 0.02, 0.01});
  EXPECT_EQ(v.verdict, Verdict::Holds) << text(v);
  EXPECT_NE(v.reason.find("hardly tested: trace"), std::string::npos) << v.reason;
  ASSERT_EQ(v.modes.size(), 2u);
  EXPECT_NEAR(v.modes[1].value, v.coefficient, 1e-6 * std::abs(v.coefficient));
}

}  // namespace
}  // namespace kerf::verdict_test
