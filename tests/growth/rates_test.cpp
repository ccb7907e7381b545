#include "growth/rates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::growth::rates_test {
namespace {

TEST(Newman, IsTheTable) {
  struct Row {
    double alpha, f[7];
  };
  const double R[] = {-1, -0.5, 0, 0.1, 0.3, 0.5, 0.7};
  for (const Row& row : {Row{1, {0.37349, 0.42509, 0.47669, 0.49070, 0.54189, 0.62624, 0.74647}},
                         Row{2, {0.24376, 0.28471, 0.32566, 0.34217, 0.42035, 0.54807, 0.71250}},
                         Row{3, {0.18478, 0.21508, 0.24538, 0.26242, 0.35428, 0.50526, 0.70000}}})
    for (int i = 0; i < 7; ++i) EXPECT_NEAR(opening_ratio(R[i], row.alpha, 0.3), row.f[i], 5.1e-6) << row.alpha << R[i];
  EXPECT_EQ(opening_ratio(-5, 2, 0.3), opening_ratio(-2, 2, 0.3));
  EXPECT_NEAR(opening_ratio(1, 2, 0.3), 1, 1e-14);
}

TEST(Rate, IsThatOfTheFormulas) {
  EXPECT_NEAR(rate({Paris{1e-11, 3}}, 20, 10, 1) / 1e-8, 1, 1e-14);
  EXPECT_NEAR(rate({Walker{1e-11, 3, 0.5}}, 20, 10, 1) / (1e-8 * std::pow(2, 1.5)), 1, 1e-14);
  // easigrow on K = -2 .. 4: the whole range, and what is left of it where contact closes the tip.
  EXPECT_NEAR(rate({Forman{1e-10, 3}, 60}, 4, -2, 1), 2.571e-10, 5e-14);
  EXPECT_NEAR(rate({Forman{1e-10, 3}, 60}, 4, 0, 1), 1.143e-10, 5e-14);
  Nasgro n{1e-11, 3, 0.5, 1, 2, 0.3, 3, 0.1, 1.2, 0.1};
  const GrowthLaw law{n, 100};
  // By hand at R = 0.5: f = 0.54807.
  const double f = 0.54807, dK_th = 3 * std::sqrt(2 / 2.1) / std::pow((1 - f) / ((1 - 0.32566) * 0.5), 1.6);
  EXPECT_NEAR(threshold(law, 0.5, 2) / dK_th, 1, 1e-4);
  EXPECT_NEAR(rate(law, 40, 20, 2) / (1e-11 * std::pow((1 - f) / 0.5 * 20, 3) * std::sqrt(1 - dK_th / 20) / (1 - 0.4)),
              1, 1e-4);
  EXPECT_NEAR(threshold(law, 0, 2), 3 * std::sqrt(2 / 2.1), 1e-12);
  // Without p, q and with f = R, as for large R, all is Paris' law.
  EXPECT_NEAR(rate({Nasgro{1e-11, 3, 0, 0, 3}, 100}, 40, 36, 1) / (1e-11 * 64), 1, 1e-12);
}

TEST(Rate, RestsAndRuns) {
  for (const GrowthLaw& law :
       {GrowthLaw{Paris{1e-11, 3}, 50, 5}, GrowthLaw{Walker{1e-11, 3, 0.5}, 50, 5}, GrowthLaw{Forman{1e-10, 3}, 50, 5},
        GrowthLaw{Nasgro{1e-11, 3, 0.5, 0.5, 2, 0.3, 5}, 50}}) {
    check(law);
    EXPECT_EQ(rate(law, 5, 0, 1), 0);
    EXPECT_GT(rate(law, 5.01, 0, 1), 0);
    EXPECT_EQ(rate(law, 50, 0, 1), infinity);
    EXPECT_LT(rate(law, 49.9, 0, 1), infinity);
    EXPECT_EQ(rate(law, 7, 7, 1), 0);
    EXPECT_EQ(rate(law, 0, 0, 1), 0);
    EXPECT_EQ(rate(law, -1, -30, 1), 0);
    EXPECT_THROW(rate(law, 1, 2, 1), Error);
    EXPECT_THROW(rate(law, nan, 2, 1), Error);
    EXPECT_FALSE(name(law).empty());
  }
}

// What bounds of a life stand on: no law falls with K_max or rises with K_min.
TEST(Rate, RisesWithTheMaximumAndFallsWithTheMinimum) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 3000; ++i) {
    const double m = 1 + 4 * unit(random), p = unit(random), alpha = 1 + 2 * unit(random);
    for (const GrowthLaw& law : {GrowthLaw{Paris{1, m}, 100, 5}, GrowthLaw{Walker{1, m, unit(random)}, 100, 5},
                                 GrowthLaw{Forman{1, m}, 100, 5},
                                 GrowthLaw{Nasgro{1, m, p, p, alpha, 0.9 * unit(random), 5, 0.1, 0, 0}, 100}}) {
      const double K_max = 99 * unit(random), K_min = K_max * (3 * unit(random) - 2), more = K_max + unit(random);
      EXPECT_LE(rate(law, K_max, K_min, 1), rate(law, more, K_min, 1) * (1 + 1e-12))
          << name(law) << K_max << " " << K_min;
      EXPECT_GE(rate(law, K_max, K_min - unit(random), 1), rate(law, K_max, K_min, 1) * (1 - 1e-12)) << name(law);
    }
  }
}

TEST(Law, WhatIsWrongIsSaid) {
  const auto said = [](const GrowthLaw& law) -> std::string {
    try {
      check(law);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(said({Paris{1e-11, 3}}), "");
  EXPECT_EQ(said({Paris{0, 3}}), "C = 0 of the law of Paris; a positive number is wanted");
  EXPECT_EQ(said({Paris{nan, 3}}), "C = nan of the law of Paris; a positive number is wanted");
  EXPECT_EQ(said({Paris{1, -3}}), "m = -3 of the law of Paris; an exponent above 0, at most 100 is wanted");
  EXPECT_EQ(said({Paris{1, 3}, infinity, -1}), "threshold = -1 of the law of Paris; 0 or a positive number is wanted");
  EXPECT_EQ(said({Paris{1, 3}, 0}), "K_c = 0 of the law of Paris; a positive number is wanted");
  EXPECT_EQ(said({Walker{1, 3, 1.5}}), "gamma = 1.5 of the law of Walker; a number from 0 to 1 is wanted");
  EXPECT_EQ(said({Forman{1, 3}}), "the law of Forman wants K_c, at which the crack runs; there is none");
  EXPECT_EQ(said({Nasgro{1, 3, 0, 0, 4}, 9}),
            "alpha = 4 of the law of NASGRO; a number from 1 (plane stress) to 3 (plane strain) is wanted");
  EXPECT_EQ(said({Nasgro{1, 3}, 9, 1}), "threshold = 1: the law of NASGRO has its own by dK_0");
  EXPECT_NE(said({Nasgro{1, 3, 0, 0, 1, 1.0}, 9}), "");
  // C of MPa m^1/2 and m, K in Pa m^1/2.
  EXPECT_EQ(doubt({Paris{1e-11, 3}}, 20, 2, 0.01), "");
  EXPECT_NE(doubt({Paris{1e-11, 3}}, 20e6, 2e6, 0.01), "");
  EXPECT_NE(doubt({Paris{1e-29, 3}}, 20, 2, 0.01), "");
}

TEST(Equivalent, OfPlainModes) {
  for (const Equivalence how : {Equivalence::Opening, Equivalence::Energy, Equivalence::Tanaka}) {
    const EquivalentCycle c = equivalent(how, {10, 0, 0}, {4, 0, 0});
    EXPECT_NEAR(c.K_max, 10, 1e-12);
    EXPECT_NEAR(c.K_min, 4, 1e-12);
    EXPECT_EQ(c.angle, 0);
    // A gap that keeps the faces apart: what is below 0 is none.
    EXPECT_NEAR(equivalent(how, {10, 0, 0}, {-4, 0, 0}).K_min, 0, 1e-12);
    EXPECT_EQ(equivalent(how, {-1, 0, 0}, {-4, 0, 0}).K_max, 0);
  }
  EXPECT_NEAR(equivalent(Equivalence::Energy, {3, 4, 0}, {0, 0, 0}).K_max, 5, 1e-12);
  EXPECT_NEAR(equivalent(Equivalence::Tanaka, {0, 1, 0}, {0, 0, 0}).K_max, std::pow(8, 0.25), 1e-12);
  const EquivalentCycle shear = equivalent(Equivalence::Opening, {0, 1, 0}, {0, 0, 0});
  EXPECT_NEAR(shear.K_max, opening_direction({0, 1, 0}).k.k_1, 1e-12);
  EXPECT_NEAR(shear.angle, opening_direction({0, 1, 0}).angle, 1e-6);
  EXPECT_EQ(shear.K_min, 0);
  // Reversed in full: each half opens its own kink, and neither has the sum.
  const EquivalentCycle reversed = equivalent(Equivalence::Opening, {0, 1, 0}, {0, -1, 0});
  EXPECT_NEAR(reversed.K_max, shear.K_max, 1e-12);
  EXPECT_NEAR(reversed.angle, shear.angle, 1e-6);
  ASSERT_TRUE(reversed.rival);
  EXPECT_NEAR(*reversed.rival, -shear.angle, 1e-6);
  const EquivalentCycle energy = equivalent(Equivalence::Energy, {0, 1, 0}, {0, -1, 0});
  EXPECT_EQ(energy.K_max, 1);
  EXPECT_EQ(energy.K_min, -1);
}

TEST(Equivalent, OpeningIsTheLargestAndProportional) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const TipLoad most{std::abs(normal(random)), normal(random), 0};
    const double R = 0.9 * std::abs(std::sin(i));
    const EquivalentCycle c = equivalent(Equivalence::Opening, most, {R * most.K_I, R * most.K_II, 0});
    EXPECT_NEAR(c.K_min, R * c.K_max, 1e-12);
    EXPECT_NEAR(c.K_max, opening_direction(most).k.k_1, 1e-9);
    EXPECT_GE(c.K_max - c.K_min, (1 - R) * most.K_I - 1e-12);
    const TipLoad other{std::abs(normal(random)), normal(random), 0};
    const EquivalentCycle mixed = equivalent(Equivalence::Opening, most, other);
    for (int j = -90; j <= 90; ++j) {
      const double angle = j * pi / 180;
      EXPECT_LE(std::abs(std::max(kink(most, angle).k_1, 0.) - std::max(kink(other, angle).k_1, 0.)),
                mixed.K_max - mixed.K_min + 1e-4);
    }
    // Which of the two is called the largest changes nothing of the range.
    const EquivalentCycle turned = equivalent(Equivalence::Opening, other, most);
    EXPECT_NEAR(turned.K_max - turned.K_min, mixed.K_max - mixed.K_min, 1e-9);
  }
}

}  // namespace
}  // namespace kerf::growth::rates_test
