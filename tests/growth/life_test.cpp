#include "growth/life.hpp"

#include "growth/numeric/cubic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace kerf::growth::life_test {
namespace {

const GrowthLaw paris{Paris{1e-11, 3}};

// Lengths from a to b in n steps, equal in ln a.
std::vector<double> lengths(double a, double b, int n) {
  std::vector<double> all;
  for (int i = 0; i <= n; ++i) all.push_back(i == n ? b : a * std::pow(b / a, static_cast<double>(i) / n));
  return all;
}

std::vector<PathPoint> path(const std::vector<double>& a, const std::function<double(double)>& K, double R = 0) {
  std::vector<PathPoint> points;
  for (const double v : a) points.push_back({v, K(v) / (1 - R), R * K(v) / (1 - R)});
  return points;
}

double infinite_plate(double a) {
  return 100 * std::sqrt(pi * a);
}
// Tada's formula of 0.5 %, W = 50 mm.
double edge_strip(double a) {
  const double x = pi * a / (2 * 0.05), s = 1 - std::sin(x);
  return 100 * std::sqrt(pi * a) * std::sqrt(std::tan(x) / x) * (0.752 + 2.02 * a / 0.05 + 0.37 * s * s * s) /
         std::cos(x);
}
// The secant with Tada's correction, 2 b = 100 mm.
double center_strip(double a) {
  const double x = a / 0.05;
  return 100 * std::sqrt(pi * a / std::cos(pi * x / 2)) * (1 - 0.025 * x * x + 0.06 * x * x * x * x);
}

struct Body {
  const char* name;
  double (*K)(double);
  double end, cycles;
};
const Body bodies[] = {{"infinite plate", infinite_plate, 0.01, 776634.44},
                       {"edge strip", edge_strip, 0.01, 493408},
                       {"center strip", center_strip, 0.02, 858664}};

TEST(Life, IsThatOfThreeBodies) {
  for (const Body& b : bodies) {
    const Life life(paris, path(lengths(0.001, b.end, 12), b.K));
    EXPECT_NEAR(life.cycles() / b.cycles, 1, 1e-5) << b.name;
    EXPECT_EQ(life.end(), LifeEnd::Reached);
    EXPECT_EQ(life.end_length(), b.end);
    EXPECT_LT(life.error() / b.cycles, 1e-4) << b.name;
  }
  EXPECT_NEAR(Life(paris, path(lengths(0.001, 0.01, 1), infinite_plate)).cycles(), 776634.44, 0.005);
  EXPECT_NEAR(Life(paris, path(lengths(0.001, 0.01, 5), infinite_plate)).cycles(), 776634.44, 0.005);
  EXPECT_TRUE(std::isnan(Life(paris, path(lengths(0.001, 0.01, 1), infinite_plate)).error()));
}

// The error falls like the fourth power of the step or faster, and is below what two resolutions say.
TEST(Life, ErrorIsSeenByTwoResolutions) {
  for (const Body& b : {bodies[1], bodies[2]}) {
    const double exact = Life(paris, path(lengths(0.001, b.end, 400), b.K)).cycles();
    EXPECT_NEAR(exact / b.cycles, 1, 1e-6);
    double first = 0;
    for (const int n : {4, 8, 16, 32}) {
      const Life life(paris, path(lengths(0.001, b.end, n), b.K));
      const double error = std::abs(life.cycles() - exact);
      EXPECT_LT(error, life.error()) << b.name << n;
      if (n == 4) first = error;
      if (n == 32) {
        EXPECT_LT(error, first / 4096) << b.name;
      }
    }
  }
}

TEST(Life, TakesUnequalSteps) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Body& b : bodies)
    for (int i = 0; i < 30; ++i) {
      std::vector<double> a = {0.001};
      while (a.back() < b.end) a.push_back(a.back() * (1 + 0.3 * unit(random)));
      a.back() = b.end;
      const Life life(paris, path(a, b.K));
      EXPECT_NEAR(life.cycles() / b.cycles, 1, 1e-4) << b.name;
      EXPECT_LT(std::abs(life.cycles() - b.cycles), life.error() + 1e-6 * b.cycles) << b.name;
    }
}

TEST(Life, LengthAfterCyclesIsTheInverse) {
  const Life life(paris, path(lengths(0.001, 0.01, 10), edge_strip));
  for (int i = 0; i <= 20; ++i) {
    const double cycles = life.cycles() * i / 20;
    EXPECT_NEAR(life.cycles_at(life.length_at(cycles)), cycles, 1e-7 * life.cycles());
  }
  EXPECT_EQ(life.length_at(0), 0.001);
  EXPECT_EQ(life.length_at(1e9), 0.01);
  EXPECT_EQ(life.cycles_at_points().front(), 0);
  EXPECT_EQ(life.cycles_at_points().back(), life.cycles());
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_NEAR(life.cycles_at(lengths(0.001, 0.01, 10)[i]), life.cycles_at_points()[i], 1e-6);
  // In closed form: a^(1 - m/2) falls linearly.
  const Life plate(paris, path(lengths(0.001, 0.01, 3), infinite_plate));
  const double slope = (std::pow(0.01, -0.5) - std::pow(0.001, -0.5)) / 776634.44;
  EXPECT_NEAR(plate.length_at(3e5), std::pow(std::pow(0.001, -0.5) + slope * 3e5, -2), 1e-11);
}

TEST(Life, EndsWhereTheCrackRunsOrRests) {
  // K_c = 15: a = 0.00716.
  const double critical = 15. * 15 / (1e4 * pi);
  GrowthLaw law = paris;
  law.K_c = 15;
  const Life runs(law, path(lengths(0.001, 0.01, 7), infinite_plate));
  EXPECT_EQ(runs.end(), LifeEnd::Runs);
  EXPECT_NEAR(runs.end_length(), critical, 1e-12);
  EXPECT_NEAR(runs.cycles(), Life(paris, path(lengths(0.001, critical, 7), infinite_plate)).cycles(), 1e-3);
  EXPECT_NEAR(*length_at_K(path(lengths(0.001, 0.01, 7), infinite_plate), 15), critical, 1e-12);
  EXPECT_FALSE(length_at_K(path(lengths(0.001, 0.01, 7), infinite_plate), 50));
  EXPECT_EQ(runs.cycles_at_points().back(), runs.cycles());
  EXPECT_EQ(runs.cycles_at(0.01), runs.cycles());
  EXPECT_EQ(runs.length_at(1e9), runs.end_length());
  // The rate of Forman's law goes to infinity there.
  EXPECT_NEAR(Life({Forman{1e-10, 3}, 15}, path(lengths(0.001, 0.01, 7), infinite_plate)).end_length(), critical,
              1e-12);
  // A crack that grows into the shade of a hole: K falls through the threshold at 0.004.
  law = paris;
  law.threshold = 5;
  const auto shade = [](double a) { return 5 * std::pow(0.004 / a, 0.3); };
  const Life rests(law, path(lengths(0.001, 0.01, 7), shade));
  EXPECT_EQ(rests.end(), LifeEnd::Rests);
  EXPECT_NEAR(rests.end_length(), 0.004, 1e-12);
  EXPECT_EQ(rests.cycles(), infinity);
  EXPECT_EQ(rests.error(), 0);
  EXPECT_EQ(rests.cycles_at(0.0041), infinity);
  EXPECT_LT(rests.cycles_at(0.0039), infinity);
  EXPECT_NEAR(rests.length_at(1e30), 0.004, 1e-12);
  // Closed from some length on.
  std::vector<PathPoint> closes = path(lengths(0.001, 0.01, 7), infinite_plate);
  closes[5].K_max = closes[6].K_max = closes[7].K_max = 0;
  EXPECT_EQ(Life(paris, closes).end(), LifeEnd::Rests);
  EXPECT_GT(Life(paris, closes).end_length(), closes[4].a);
  EXPECT_LE(Life(paris, closes).end_length(), closes[5].a);
  // At once.
  law.threshold = 100;
  EXPECT_EQ(Life(law, closes).end_length(), 0.001);
  law.K_c = 1;
  EXPECT_EQ(Life(law, closes).cycles(), 0);
  EXPECT_EQ(Life(law, closes).end(), LifeEnd::Runs);
}

TEST(Life, ByRates) {
  const std::vector<double> a = lengths(0.001, 0.01, 6);
  std::vector<double> rates;
  for (const double v : a) rates.push_back(rate(paris, infinite_plate(v), 0, v));
  EXPECT_NEAR(Life::of_rates(a, rates).cycles(), 776634.44, 0.005);
  rates[4] = rates[5] = rates[6] = infinity;
  EXPECT_EQ(Life::of_rates(a, rates).end(), LifeEnd::Runs);
  EXPECT_NEAR(Life::of_rates(a, rates).end_length(), a[4], 1e-12);
  rates[3] = 0;
  EXPECT_EQ(Life::of_rates(a, rates).end(), LifeEnd::Rests);
}

TEST(Life, RatioCountsByTheLaw) {
  const auto points = path(lengths(0.001, 0.01, 6), infinite_plate, 0.5);
  EXPECT_NEAR(Life(paris, points).cycles(), 776634.44, 0.005);
  EXPECT_NEAR(Life({Walker{1e-11, 3, 0.5}}, points).cycles(), 776634.44 / std::pow(2, 1.5), 0.005);
}

TEST(Life, BoundsHoldWhatIsWithin) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  const GrowthLaw laws[] = {
      paris, {Walker{1e-11, 3, 0.4}}, {Forman{1e-9, 3}, 40}, {Nasgro{1e-11, 3, 0.5, 0.5, 2, 0.3, 1}, 40}};
  for (const GrowthLaw& law : laws)
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> a = lengths(0.001, 0.01, 30);
      std::vector<BoundedCycle> bounds;
      std::vector<PathPoint> truth;
      const double width = 0.05 * unit(random), R = 0.5 * unit(random), where = unit(random);
      for (const double v : a) {
        const double K = edge_strip(v) / (1 - R);
        truth.push_back({v, K, R * K});
        const double low = 1 - width * where, high = low + width;
        bounds.push_back({v, low * K, high * K, low * R * K, high * R * K});
      }
      const double cycles = Life(law, truth).cycles();
      const LifeBounds smooth = bound_life(law, bounds, BetweenPoints::Smooth);
      const LifeBounds monotone = bound_life(law, bounds, BetweenPoints::Monotone);
      EXPECT_LE(smooth.lower, cycles) << name(law);
      EXPECT_GE(smooth.upper, cycles) << name(law);
      EXPECT_LE(monotone.lower, smooth.lower) << name(law);
      EXPECT_GE(monotone.upper, smooth.upper) << name(law);
      EXPECT_LT(smooth.upper / smooth.lower, 1 + 12 * width / (1 - R) + 1e-3) << name(law);
    }
  // A crack that may rest, and one that may run.
  GrowthLaw law{Paris{1e-11, 3}, 25, 6};
  std::vector<BoundedCycle> wide;
  for (const double v : lengths(0.001, 0.01, 10)) wide.push_back({v, 0.9 * edge_strip(v), 1.1 * edge_strip(v), 0, 0});
  for (const BetweenPoints between : {BetweenPoints::Smooth, BetweenPoints::Monotone}) {
    const LifeBounds b = bound_life(law, wide, between);
    EXPECT_EQ(b.upper, infinity);
    EXPECT_GT(b.lower, 0);
    EXPECT_LT(b.lower, 493408);
  }
}

TEST(Cubic, DoesNotTurnBetweenPoints) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> x = {0}, y = {0};
    for (int j = 0; j < 6; ++j)
      x.push_back(x.back() + 0.01 + unit(random)), y.push_back(y.back() + std::pow(unit(random), 6));
    const MonotoneCubic f(x, y);
    double before = 0;
    for (int j = 0; j <= 500; ++j) {
      const double value = f(x.back() * j / 500);
      EXPECT_GE(value, before - 1e-14);
      before = value;
    }
    for (std::size_t j = 0; j < x.size(); ++j) EXPECT_NEAR(f(x[j]), y[j], 1e-14);
  }
  // A cubic that rises is itself.
  const auto cubic = [](double t) { return 1 + t + t * t * t; };
  const std::vector<double> x = {-1, -0.2, 0.3, 1, 2};
  std::vector<double> y;
  for (const double t : x) y.push_back(cubic(t));
  for (const double t : {-0.7, 0.1, 0.5, 1.9}) EXPECT_NEAR(MonotoneCubic(x, y)(t), cubic(t), 1e-13);
}

TEST(Life, WhatIsWrongIsSaid) {
  EXPECT_THROW(Life(paris, std::vector<PathPoint>{{1, 1, 0}}), Error);
  EXPECT_THROW(Life(paris, std::vector<PathPoint>{{1, 1, 0}, {1, 1, 0}}), Error);
  EXPECT_THROW(Life(paris, std::vector<PathPoint>{{0, 1, 0}, {1, 1, 0}}), Error);
  EXPECT_THROW(Life(paris, std::vector<PathPoint>{{1, 1, 0}, {2, 1, 3}}), Error);
  EXPECT_THROW(Life(paris, std::vector<PathPoint>{{1, nan, 0}, {2, 1, 0}}), Error);
  const Life life(paris, std::vector<PathPoint>{{1, 1, 0}, {2, 1, 0}});
  EXPECT_THROW(life.cycles_at(3), Error);
  EXPECT_THROW(life.length_at(-1), Error);
  EXPECT_THROW(bound_life(paris, std::vector<BoundedCycle>{{1, 2, 1, 0, 0}, {2, 1, 2, 0, 0}}, BetweenPoints::Monotone),
               Error);
}

}  // namespace
}  // namespace kerf::growth::life_test
