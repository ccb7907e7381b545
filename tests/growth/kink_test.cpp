#include "growth/kink.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::growth::kink_test {
namespace {

constexpr double degrees = 180 / pi;

struct Golden {
  double ratio, symmetry, energy, hoop, release;
};
// Angles in degrees and G_max/G by the series, for K_I = 1; the last row is K_I = 0, K_II = 1.
const Golden table[] = {{0.01, 1.1457, 1.1457, 1.1456, 1.0002},   {0.1, 11.2515, 11.2514, 11.2029, 1.01959},
                        {0.2, 21.4031, 21.3995, 21.0888, 1.0739}, {0.5, 42.1259, 42.0294, 40.2078, 1.3343},
                        {1, 56.9580, 56.5654, 53.1301, 1.6680},   {2, 66.5735, 65.7769, 61.3418, 1.8123},
                        {5, 72.9273, 71.7241, 66.7596, 1.7137},   {infinity, 77.3301, 75.7566, 70.5288, 1.5172}};

TEST(Kink, AnglesAreThoseOfTheTable) {
  for (const Golden& g : table)
    for (const double side : {-1., 1.}) {
      const bool shear = std::isinf(g.ratio);
      const TipLoad tip{shear ? 0. : 1., side * (shear ? 1 : g.ratio), 0};
      EXPECT_NEAR(symmetric_direction(tip).angle * degrees, -side * g.symmetry, 5.1e-5) << g.ratio;
      EXPECT_NEAR(energetic_direction(tip).angle * degrees, -side * g.energy, 5.1e-5) << g.ratio;
      EXPECT_NEAR(hoop_direction(tip).angle * degrees, -side * g.hoop, 5.1e-5) << g.ratio;
      const double ratio = release_rate(energetic_direction(tip).k, 1) / release_rate({tip.K_I, tip.K_II}, 1);
      EXPECT_NEAR(ratio, g.release, 6e-5) << g.ratio;
      EXPECT_NEAR(symmetric_direction(tip).k.k_2, 0, 1e-14);
    }
}

TEST(Kink, SmallAnglesAreThoseOfCotterellAndRice) {
  for (const double angle : {0.01, -0.02, 0.05, -0.1}) {
    const double c1 = std::cos(angle / 2), c3 = std::cos(1.5 * angle), s1 = std::sin(angle / 2),
                 s3 = std::sin(1.5 * angle);
    const KinkLoad one = kink({1, 0, 0}, angle), two = kink({0, 1, 0}, angle);
    const double square = angle * angle, cube = std::abs(angle * square);
    EXPECT_NEAR(one.k_1, (3 * c1 + c3) / 4, 0.1 * square * square);
    EXPECT_NEAR(two.k_1, -0.75 * (s1 + s3), 0.3 * cube);
    EXPECT_NEAR(one.k_2, (s1 + s3) / 4, 0.1 * cube);
    // Their F22 is not that of the second order, by 4 m^2: it multiplies K_II, which is small with the angle.
    EXPECT_NEAR(two.k_2, (c1 + 3 * c3) / 4, 0.5 * square);
  }
  // theta = -2 K_II/K_I, to the last digits for ratios that no table has.
  for (const double ratio : {1e-6, 1e-10, 1e-100, 1e-300}) {
    EXPECT_NEAR(symmetric_direction({1, ratio, 0}).angle / ratio, -2, 1e-9);
    EXPECT_NEAR(energetic_direction({1, ratio, 0}).angle / ratio, -2, 1e-5);
    EXPECT_NEAR(hoop_direction({1, ratio, 0}).angle / ratio, -2, 1e-9);
  }
}

TEST(Kink, IsOddInShearAndKnowsNoUnits) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    const double unit = std::exp(20 * normal(random)), length = i % 3 == 0 ? 0 : std::exp(normal(random));
    const TipLoad tip{unit * normal(random), unit * std::exp(2 * normal(random)), 0.1 * unit * normal(random)};
    const TipLoad other{tip.K_I, -tip.K_II, tip.T}, twice{1024 * tip.K_I, 1024 * tip.K_II, 1024 * tip.T};
    for (const Criterion c : {Criterion::LocalSymmetry, Criterion::Energy, Criterion::HoopStress}) {
      const Direction a = direction(c, tip, length), b = direction(c, other, length);
      EXPECT_EQ(a.angle, -b.angle);
      EXPECT_EQ(a.k.k_1, b.k.k_1);
      EXPECT_EQ(a.k.k_2, -b.k.k_2);
      EXPECT_LE(a.angle, 0);
      EXPECT_GE(a.angle, -largest_kink);
      // Local symmetry has its root within 90 degrees unless T turns the crack by more than K does.
      if (c != Criterion::Energy && tip.T * std::sqrt(length) < 0.9 * tip.K_II) {
        EXPECT_FALSE(a.at_limit);
      }
      EXPECT_NEAR(direction(c, twice, length).angle, a.angle, 1e-12);
      EXPECT_FALSE(a.rival);
    }
    const Direction a = energetic_direction(tip, length, [](double t) { return 1 + std::cos(t); });
    EXPECT_EQ(a.angle, -energetic_direction(other, length, [](double t) { return 1 + std::cos(t); }).angle);
    // No kink on its side has more than what is found, and without T none on the other side either.
    for (const TipLoad& load : {tip, TipLoad{tip.K_I, tip.K_II, 0}}) {
      const double most = release_rate(energetic_direction(load, length).k, 1) * (1 + 1e-12);
      const double widest = opening_direction(load, length).k.k_1 + 1e-12 * unit;
      for (int j = -90; j <= (load.T == 0 ? 90 : 0); ++j) {
        const KinkLoad k = kink(load, j / degrees, length);
        EXPECT_LE(release_rate(k, 1), most);
        EXPECT_LE(k.k_1, widest);
      }
    }
  }
}

TEST(Kink, OverlapCountsAsClosed) {
  const TipLoad closed{0, 1, 0}, overlaps{-3, 1, 0};
  EXPECT_EQ(symmetric_direction(overlaps).angle, symmetric_direction(closed).angle);
  EXPECT_EQ(energetic_direction(overlaps).k.k_1, energetic_direction(closed).k.k_1);
  EXPECT_EQ(hoop_direction(overlaps).angle, hoop_direction(closed).angle);
  EXPECT_EQ(release_rate({-2, 1}, 4), 0.25);
  const Direction nothing = energetic_direction({-1, 0, 0});
  EXPECT_EQ(nothing.angle, 0);
  EXPECT_EQ(nothing.k.k_1, 0);
}

TEST(Kink, WingOfAClosedCrack) {
  const Direction wing = opening_direction({0, 1, 0});
  EXPECT_GT(wing.angle * degrees, -77.33);
  EXPECT_LT(wing.angle * degrees, -70);
  EXPECT_NEAR(kink({0, 1, 0}, -77.3301 / degrees).k_1, 1.2315, 5e-5);
  // 2.1683 of a crack of half length 1 at the angle of the hoop stress.
  EXPECT_NEAR(kink({0, std::sqrt(pi), 0}, -70.53 / degrees).k_1, 2.1683, 5e-5);
  EXPECT_TRUE(grows_by_shear({-5, 3, 0}, 4, 2));
  EXPECT_FALSE(grows_by_shear({-5, 3, 0}, 3, 2));
  EXPECT_FALSE(grows_by_shear({-5, 3, 0}, 4, 3.5));
}

TEST(Kink, TurnsWithTheStressAlongIt) {
  // T > 0 turns further away, T < 0 back.
  const double without = std::abs(symmetric_direction({1, 0.1, 0}, 0.01).angle);
  EXPECT_GT(std::abs(symmetric_direction({1, 0.1, 1}, 0.01).angle), without);
  EXPECT_LT(std::abs(symmetric_direction({1, 0.1, -1}, 0.01).angle), without);
  // G_p of order m^1 and m^2: -2 sqrt(2 pi) theta/pi and (2 pi)^1.5 theta^2/pi^2.
  const KinkLoad k = kink({0, 0, 1}, 1e-3, 4);
  EXPECT_NEAR(k.k_2, -4 * std::sqrt(2 * pi) * 1e-3 / pi, 1e-8);
  EXPECT_NEAR(k.k_1, 2 * std::pow(2 * pi, 1.5) * 1e-6 / (pi * pi), 1e-10);
  // A straight crack with a large T is unstable: straight on, and a rival.
  EXPECT_FALSE(symmetric_direction({1, 0, 0.3}, 1).rival);
  const Direction unstable = symmetric_direction({1, 0, 0.6}, 1);
  EXPECT_EQ(unstable.angle, 0);
  ASSERT_TRUE(unstable.rival);
  EXPECT_NEAR(kink({1, 0, 0.6}, *unstable.rival, 1).k_2, 0, 1e-13);
  EXPECT_NEAR(symmetric_direction({1, -1e-9, 0.6}, 1).angle, *unstable.rival, 1e-6);
  const Direction torn = energetic_direction({1, 0, 0.6}, 1);
  ASSERT_TRUE(torn.rival);
  EXPECT_EQ(*torn.rival, -torn.angle);
}

TEST(Kink, FollowsAWeakPlane) {
  const auto weak = [](double at, double depth) {
    return [=](double angle) { return 1 - depth * std::exp(-std::pow((angle - at) * 20, 2)); };
  };
  EXPECT_NEAR(energetic_direction({1, 0, 0}, 0, weak(0.5, 0.5)).angle, 0.5, 0.02);
  EXPECT_NEAR(energetic_direction({1, 0, 0}, 0, weak(-0.7, 0.01)).angle, 0, 1e-6);
  // One toughness is none.
  for (const double ratio : {0., 0.3, -2.}) {
    const TipLoad tip{1, ratio, 0};
    EXPECT_NEAR(energetic_direction(tip, 0, [](double) { return 7.; }).angle, energetic_direction(tip).angle, 1e-7);
  }
  // Cleavage to both sides: either is as good, and that is said.
  const Direction d = energetic_direction({1, 0, 0}, 0, [](double t) { return 1.1 - std::pow(std::sin(2 * t), 2); });
  ASSERT_TRUE(d.rival);
  EXPECT_NEAR(*d.rival, -d.angle, 1e-6);
  EXPECT_THROW(energetic_direction({1, 0, 0}, 0, [](double) { return 0.; }), Error);
}

TEST(Kink, ModulusOfThePlane) {
  EXPECT_EQ(effective_modulus(3, 0.5, true), 4);
  EXPECT_EQ(effective_modulus(3, 0.5, false), 3);
}

TEST(Kink, WhatIsNoNumberIsRefused) {
  EXPECT_THROW(kink({nan, 0, 0}, 0), Error);
  EXPECT_THROW(kink({1, 0, 0}, 1.6), Error);
  EXPECT_THROW(kink({1, 0, 0}, 0, -1), Error);
  EXPECT_THROW(symmetric_direction({1, infinity, 0}), Error);
  EXPECT_THROW(slightly_curved_path(-1, 1, 1), Error);
}

TEST(Path, IsTheClosedFormOfCotterellAndRice) {
  struct Row {
    double beta, y[3];
  };
  const double x[] = {0.1, 0.5, 1};
  for (const Row& row : {Row{-2, {0.066814, 0.232993, 0.378039}}, Row{-1, {0.080403, 0.321041, 0.555963}},
                         Row{1, {0.129939, 0.976401, 2.880601}}})
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(slightly_curved_path(x[i], 1, row.beta), row.y[i], 6e-7) << row.beta;
  // One function where the ways to compute it meet, straight without T, and far behind: 2 sqrt(x/pi)/|beta|.
  for (const double beta : {-1., 1., -20., 0.3}) {
    const double at = beta == -20 ? 1 : 1 / (beta * beta), h = 1e-6;
    const double below = slightly_curved_path(at * (1 - h), 1, beta),
                 above = slightly_curved_path(at * (1 + h), 1, beta);
    EXPECT_NEAR((above - below) / (2 * h * at), slightly_curved_slope(at, 1, beta),
                1e-8 * slightly_curved_slope(at, 1, beta) + 1e-9);
  }
  EXPECT_EQ(slightly_curved_path(3, 0.1, 0), 0.1 * 3);
  EXPECT_NEAR(slightly_curved_path(1e8, 1, -1) / (2e4 / std::sqrt(pi)), 1, 1e-4);
}

}  // namespace
}  // namespace kerf::growth::kink_test
