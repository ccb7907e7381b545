// Several designs to begin with: what the map promises of them against holes that are really made, and what they end
// at.

#include "optimize/parametric/starts.hpp"
#include "optimize/parametric/promise.hpp"
#include "tests/optimize/inverse.hpp"

#include "kerf/analysis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace kerf::starts_test {
namespace {

using Eigen::VectorXd;
using inverse::Plate;

Problem stiff(double size) {
  Plate plate;
  plate.size = size;
  Problem p = plate.frame();
  p.objective = {"compliance", {compliance()}};
  return p;
}

double objective(const Problem& p, const Design& d, const VectorXd& x) {
  DrawnBody body = body_of(d, x, p);
  const Model m = prepare(triangulate(body.shape, p.sizing), p.element, body.scene, 1);
  return analyze(p.objective, m, solve(m), true).value;
}

// J with small holes that are really drawn, less J without, over their area: to the order of the radius.
TEST(Starts, TheMapPromisesWhatSmallHolesDo) {
  const Problem p = stiff(0.05);
  const Plate plate;
  OptimizeRequest r{.method = OptimizeMethod::Slsqp};
  r.design.drawn = {plate.circle("a"), plate.circle("b")};
  std::vector<VectorXd> designs;
  for (const Vec2& at : {Vec2(0.25, 0.3), Vec2(0.5, 0.75), Vec2(0.6, 0.45)}) {
    designs.emplace_back(6);
    designs.back() << at, 0.02, Vec2(0.8, 0.5), 0.03;
  }
  const std::vector<double> promise = promises(p, r, designs);
  ASSERT_EQ(promise.size(), designs.size());
  const Model m = prepare(triangulate(p.frame, p.sizing), p.element, p.scene, 1);
  const double before = analyze(p.objective, m, solve(m), true).value;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const double change = (objective(p, r.design, designs[i]) - before) / (pi * (0.02 * 0.02 + 0.03 * 0.03));
    EXPECT_NEAR(promise[i], change, 0.06 * std::abs(change)) << i;
  }
}

TEST(Starts, MoveAndComeToDistinctEnds) {
  const Problem p = stiff(0.12);
  const Plate plate;
  OptimizeRequest r{.method = OptimizeMethod::Slsqp, .max_iterations = 60, .min_distance = 0.03};
  r.volume_at_most = 0.94;
  r.design.drawn = {plate.circle("a"), plate.circle("b")};
  r.design.drawn[0].start = Eigen::Vector3d(0.3, 0.5, 0.08);
  r.design.drawn[1].start = Eigen::Vector3d(0.7, 0.5, 0.08);
  r.starts = 8;
  const std::vector<StartTried> all = try_starts(p, r, start_of(r.design), {});
  ASSERT_EQ(all.size(), 8u);
  int moved = 0;
  std::set<int> ends;
  std::vector<double> best(9, infinity);
  for (const StartTried& one : all) {
    moved += (one.variables - one.from).lpNorm<Eigen::Infinity>() > 0.01;
    if (one.end == 0) continue;
    ends.insert(one.end);
    best.at(static_cast<std::size_t>(one.end)) = std::min(best[static_cast<std::size_t>(one.end)], one.merit);
    // Holes of a kind have no order: the same design has the same number.
    for (const StartTried& other : all) {
      VectorXd turned(6);
      turned << other.variables.tail(3), other.variables.head(3);
      const bool same = std::min((one.variables - other.variables).norm(), (one.variables - turned).norm()) < 1e-3;
      EXPECT_TRUE(!same || other.end == 0 || one.end == other.end);
    }
  }
  EXPECT_GE(moved, 7);
  ASSERT_FALSE(ends.empty());
  EXPECT_EQ(*ends.rbegin(), static_cast<int>(ends.size()));
  EXPECT_TRUE(std::is_sorted(best.begin() + 1, best.end()));
  EXPECT_EQ(ends_in_words(all).size(), 1u);
}

TEST(Starts, EndsInWords) {
  const auto tried = [](double merit, int end) {
    StartTried t;
    t.merit = merit;
    t.end = end;
    return t;
  };
  EXPECT_EQ(
      ends_in_words({tried(1.5, 1), tried(4, 2), tried(1.25, 1), tried(9, 0)}),
      (std::vector<std::string>{"2 distinct ends of 4 starts, on the coarse mesh: 1.25 from 2, 4 from 1; 1 had not "
                                "come to one"}));
  EXPECT_TRUE(ends_in_words({tried(1, 0)}).empty());
}

}  // namespace
}  // namespace kerf::starts_test
