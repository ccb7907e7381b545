#include "growth/spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::growth::spectrum_test {
namespace {

bool operator==(const LoadCycle& a, const LoadCycle& b) {
  return a.max == b.max && a.min == b.min && a.count == b.count;
}

// The example of the standard, A to I.
const std::vector<double> example = {-2, 1, -3, 5, -1, 3, -4, 4, -2};

TEST(Rainflow, IsTheExampleOfTheStandard) {
  const std::vector<LoadCycle> wanted = {{1, -2, 0.5}, {1, -3, 0.5}, {3, -1, 1},  {5, -3, 0.5},
                                         {5, -4, 0.5}, {4, -4, 0.5}, {4, -2, 0.5}};
  const std::vector<LoadCycle> found = rainflow(example);
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_TRUE(found[i] == wanted[i]) << i;
  // Repeated: ranges 4, 3, 7, 9, one each.
  const std::vector<LoadCycle> whole = {{3, -1, 1}, {1, -2, 1}, {4, -3, 1}, {5, -4, 1}};
  const std::vector<LoadCycle> block = rainflow_of_block(example);
  ASSERT_EQ(block.size(), whole.size());
  for (const LoadCycle& w : whole)
    EXPECT_TRUE(std::any_of(block.begin(), block.end(), [&](const LoadCycle& c) { return c == w; })) << w.max;
  EXPECT_TRUE(block.back() == whole.back());
}

TEST(Rainflow, TurningPointsAlone) {
  const std::vector<double> points = turning_points(std::vector<double>{0, 0, 1, 2, 2, 3, 1, 1, 0.5, 2, 2});
  EXPECT_EQ(points, (std::vector<double>{0, 3, 0.5, 2}));
  EXPECT_EQ(turning_points(std::vector<double>{2, 2, 2}), (std::vector<double>{2}));
  EXPECT_TRUE(rainflow(std::vector<double>{2, 2}).empty());
  EXPECT_TRUE(rainflow_of_block(std::vector<double>{2, 2}).empty());
  EXPECT_THROW(turning_points(std::vector<double>{1}), Error);
  EXPECT_THROW(rainflow(std::vector<double>{1, nan}), Error);
  const std::vector<LoadCycle> simple = rainflow_of_block(std::vector<double>{0, 1});
  ASSERT_EQ(simple.size(), 1u);
  EXPECT_TRUE(simple[0] == (LoadCycle{1, 0, 1}));
}

// Ways add up: a cycle goes there and back, a half one goes there. A block has the same cycles wherever it begins,
// those of its mirror image are mirrored, and many blocks one after another have as many of each.
TEST(Rainflow, KeepsTheWayOfTheLoad) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> history;
    for (int j = 0; j < 3 + i; ++j) history.push_back(static_cast<int>(random() % 21) - 10);
    double way = 0, counted = 0, closed = std::abs(history.front() - history.back()), block_way = 0;
    for (std::size_t j = 0; j + 1 < history.size(); ++j) way += std::abs(history[j + 1] - history[j]);
    for (const LoadCycle& c : rainflow(history)) counted += 2 * c.count * (c.max - c.min);
    EXPECT_EQ(counted, way);
    const std::vector<LoadCycle> block = merged(rainflow_of_block(history));
    for (const LoadCycle& c : block) block_way += 2 * c.count * (c.max - c.min);
    EXPECT_EQ(block_way, way + closed);
    std::vector<double> later = history, mirrored;
    std::rotate(later.begin(), later.begin() + static_cast<int>(random() % history.size()), later.end());
    for (const double v : history) mirrored.push_back(-v);
    const std::vector<LoadCycle> rotated = merged(rainflow_of_block(later)),
                                 image = merged(rainflow_of_block(mirrored));
    ASSERT_EQ(rotated.size(), block.size());
    ASSERT_EQ(image.size(), block.size());
    for (std::size_t j = 0; j < block.size(); ++j) {
      EXPECT_TRUE(rotated[j] == block[j]);
      EXPECT_TRUE(std::any_of(image.begin(), image.end(), [&](const LoadCycle& c) {
        return c == LoadCycle{-block[j].min, -block[j].max, block[j].count};
      }));
    }
    std::vector<double> many;
    for (int k = 0; k < 50; ++k) many.insert(many.end(), history.begin(), history.end());
    const std::vector<LoadCycle> total = merged(rainflow(many));
    for (const LoadCycle& c : block) {
      double count = 0;
      for (const LoadCycle& t : total) count += t.max == c.max && t.min == c.min ? t.count : 0;
      EXPECT_NEAR(count, 50 * c.count, 1.5);
    }
  }
}

TEST(LoadCurve, IsExactWithoutContactAndWhereOneLevelCloses) {
  const auto tips = [](const std::vector<double>& levels, auto K) {
    std::vector<TipLoad> all;
    for (const double v : levels) all.push_back({K(v), -0.3 * v, 2 * v});
    return all;
  };
  const auto linear = [](double v) { return 7 * v; };
  const std::vector<double> few = {-0.5, 0.3, 1};
  const LoadCurve line(few, tips(few, linear));
  for (const double v : {-0.5, -0.1, 0.3, 0.77, 1.}) {
    EXPECT_NEAR(line.at(v).K_I, 7 * v, 1e-14);
    EXPECT_NEAR(line.at(v).K_II, -0.3 * v, 1e-14);
    EXPECT_NEAR(line.at(v).T, 2 * v, 1e-14);
  }
  EXPECT_NEAR(line.doubt().difference, 0, 1e-14);
  EXPECT_THROW(line.at(1.1), Error);
  // Closed below 0.
  const auto closing = [](double v) { return 7 * std::max(v, 0.); };
  const std::vector<double> levels = {-1, -0.5, 0, 0.5, 1};
  const LoadCurve kinked(levels, tips(levels, closing));
  for (int i = -10; i <= 10; ++i) EXPECT_NEAR(kinked.at(i / 10.).K_I, closing(i / 10.), 1e-14);
  EXPECT_GT(kinked.doubt().difference, 0);
  const LoadCurve known = LoadCurve::homogeneous(2, {14, 3, 1}, {0, 8, 0});
  EXPECT_EQ(known.at(1).K_I, 7);
  EXPECT_EQ(known.at(-0.5).K_I, 0);
  EXPECT_EQ(known.at(-0.5).K_II, 2);
  EXPECT_EQ(known.doubt().difference, 0);
  EXPECT_THROW(LoadCurve({1, 1}, {{}, {}}), Error);
  EXPECT_THROW(LoadCurve({1}, {{}}), Error);
}

// Faces that open progressively: K is smooth and rises. Levels where the doubt is lead to it.
TEST(LoadCurve, KnowsWhereALevelIsMissing) {
  const auto K = [](double v) { return v < 0.2 ? 0. : v < 0.7 ? (v - 0.2) * (v - 0.2) : 0.25 + v - 0.7; };
  std::vector<double> levels = {0, 0.5, 1};
  double before = infinity;
  for (int n = 0; n < 12; ++n) {
    std::vector<TipLoad> tips;
    for (const double v : levels) tips.push_back({K(v), 0, 0});
    const LoadCurve curve(levels, tips);
    double error = 0, last = -1e-15;
    for (int i = 0; i <= 1000; ++i) {
      const double v = curve.at(i / 1000.).K_I;
      error = std::max(error, std::abs(v - K(i / 1000.)));
      EXPECT_GE(v, last - 1e-15);
      last = v;
    }
    before = error;
    const LevelDoubt doubt = curve.doubt();
    EXPECT_LE(error, doubt.difference);
    levels.insert(std::upper_bound(levels.begin(), levels.end(), doubt.level), doubt.level);
  }
  EXPECT_LT(before, 1e-3);
}

TEST(Block, OfOneCycleIsTheLifeInCycles) {
  const GrowthLaw law{Paris{1e-11, 3}};
  std::vector<double> a;
  std::vector<LoadCurve> curves;
  for (int i = 0; i <= 6; ++i) {
    a.push_back(0.001 * std::pow(10, i / 6.));
    const double K = 100 * std::sqrt(pi * a.back());
    curves.emplace_back(std::vector<double>{-1, 0, 1}, std::vector<TipLoad>{{0, 0, 0}, {0, 0, 0}, {K, 0, 0}});
  }
  const std::vector<double> history = {0, 1, 0};
  const Life one = block_life(law, rainflow_of_block(history), a, curves, Equivalence::Opening);
  EXPECT_NEAR(one.cycles(), 776634.44, 0.01);
  // The faces close below 0: what a block does there changes nothing.
  const Life closed = block_life(law, rainflow_of_block(std::vector<double>{-1, 1}), a, curves, Equivalence::Opening);
  EXPECT_NEAR(closed.cycles(), 776634.44, 0.01);
  // Two cycles of half the load in between are 1/4 more growth.
  const Life three =
      block_life(law, rainflow_of_block(std::vector<double>{0, 1, 0, 0.5, 0, 0.5}), a, curves, Equivalence::Energy);
  EXPECT_NEAR(three.cycles(), 776634.44 / 1.25, 0.01);
  EXPECT_LT(three.error(), 1);
  EXPECT_THROW(block_life(law, rainflow(history), std::vector<double>{1, 2}, curves, Equivalence::Energy), Error);
}

}  // namespace
}  // namespace kerf::growth::spectrum_test
