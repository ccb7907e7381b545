// The word for the end of an optimization, from what is known of its design.

#include "optimize/loop/finish.hpp"

#include "optimize/loop/history_text.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::finish_test {
namespace {

OptimizeRequest asked(double at_most) {
  OptimizeRequest r;
  r.volume_at_most = 0.5;
  FunctionalBound bound;
  bound.name = "G";
  bound.at_most = at_most;
  r.bounds = {bound};
  return r;
}

/// A design that keeps everything, on a mesh of size 0.1.
FinerDesign kept(double value) {
  FinerDesign f{.size = 0.1, .objective = 2, .volume_fraction = 0.5, .bounds = {value}};
  f.violation = 0;
  return f;
}

struct Given {
  double fraction = 0.5, value = 1;  // on the loop's mesh
  double residual = 1e-4;
  bool budget_used = false;
  std::string obstacle, evidence;
  double violation = 0;
  GainLeft gain = {};
};
OptimizeResult judged(const OptimizeRequest& r, FinerDesign finer, const Given& g) {
  OptimizeResult result{.finer = std::move(finer)};
  const Iteration row{.volume_fraction = g.fraction, .bounds = {g.value}, .violation = g.violation};
  judge(result, r,
        {.row = row,
         .residual = g.residual,
         .asked = 1e-3,
         .kind = "KKT residual",
         .why = "done",
         .budget_used = g.budget_used,
         .obstacle = g.obstacle,
         .evidence = g.evidence,
         .gain = g.gain});
  EXPECT_EQ(result.feasible, result.ending != Ending::Infeasible);
  EXPECT_EQ(result.stopped.rfind(verdict_of(result) + ": ", 0), 0u) << result.stopped;
  return result;
}
std::string words(const OptimizeResult& r) {
  return r.stopped;
}

TEST(Judge, SmallResidualsAreOptimal) {
  const std::string there = "on a mesh of size 0.1 with bdms 1";
  EXPECT_EQ(words(judged(asked(1), kept(1), {})), "optimal: KKT residual 0.0001; objective 2 " + there);
  EXPECT_EQ(words(judged(asked(1), kept(1), {.evidence = "no hole pays"})),
            "optimal: KKT residual 0.0001; no hole pays; objective 2 " + there);
  // Stopped before the finer mesh: nothing of it is said.
  EXPECT_EQ(words(judged(asked(1), {}, {})), "optimal: KKT residual 0.0001");
  // What is proved of the bound is said.
  FinerDesign proved = kept(0.9);
  proved.intervals = {{0.9, 0.8, 0.95, true, ""}};
  EXPECT_EQ(words(judged(asked(1), proved, {})),
            "optimal: KKT residual 0.0001; G: at most 0.9500 of what is allowed is proved; objective 2 " + there);
  proved.intervals[0].guaranteed = false;
  EXPECT_NE(words(judged(asked(1), proved, {})).find("0.9500 of what is allowed is estimated"), std::string::npos);
  // Shares mean nothing of a bound that is not positive.
  proved.bounds = {-2.1};
  proved.intervals = {{-2.1, -2.2, -2.05, true, ""}};
  EXPECT_NE(words(judged(asked(-2), proved, {.value = -2.1})).find("G: at most -2.05 is proved, -2 is allowed"),
            std::string::npos);
}

TEST(Judge, WhatIsViolatedIsInfeasible) {
  EXPECT_EQ(words(judged(asked(1), kept(1), {.fraction = 0.51})), "infeasible: volume fraction 0.51 > 0.5; done");
  EXPECT_EQ(words(judged(asked(1), kept(1), {.value = 1.01})), "infeasible: G 1.01 > 1; done");
  EXPECT_EQ(words(judged(asked(1), kept(1), {.fraction = 0.51, .value = 1.01})),
            "infeasible: volume fraction 0.51 > 0.5, G 1.01 > 1; done");
  EXPECT_EQ(words(judged(asked(1), kept(1.01), {})), "infeasible: G 1.01 > 1 on a mesh of size 0.1 with bdms 1; done");
  // Less than a thousandth does not count.
  EXPECT_EQ(judged(asked(1), kept(1.0009), {.value = 1.0009}).ending, Ending::Optimal);
  // The loop may be stricter.
  EXPECT_EQ(judged(asked(1), kept(1), {.violation = 0.1}).ending, Ending::Infeasible);
  // Without a bound on the volume, or with one of 1, fractions say nothing.
  OptimizeRequest any = asked(1);
  any.volume_at_most.reset();
  EXPECT_EQ(judged(any, kept(1), {.fraction = 0.51}).ending, Ending::Optimal);
  any.volume_at_most = 1;
  EXPECT_EQ(judged(any, kept(1), {.fraction = 1.01}).ending, Ending::Optimal);
}

TEST(Judge, TheRestIsStalledOrOutOfBudget) {
  EXPECT_EQ(words(judged(asked(1), kept(1), {.residual = 0.2})),
            "stalled: done; KKT residual 0.2, an optimum has at most 0.001");
  EXPECT_EQ(words(judged(asked(1), kept(1), {.residual = 0.2, .budget_used = true})),
            "budget used: done; KKT residual 0.2, an optimum has at most 0.001");
  EXPECT_EQ(words(judged(asked(1), kept(1), {.residual = nan})),
            "stalled: done; nothing tells how far it is from an optimum");
  EXPECT_EQ(words(judged(asked(1), kept(1), {.obstacle = "a hole pays"})), "stalled: done; a hole pays");
  FinerDesign failed{.size = 0.1, .failure = "no mesh"};
  EXPECT_EQ(words(judged(asked(1), failed, {})),
            "stalled: done; the design cannot be solved on a mesh of size 0.1 with bdms 1: no mesh");
}

TEST(Judge, LittleLeftToGainIsOptimalWithinIt) {
  const auto left = [](double shape, double hole, double bump) {
    return GainLeft{shape, {hole, {1, 2}, 0.05}, {bump, {3, 4}, 0.02}};
  };
  OptimizeRequest r = asked(1);
  r.tolerance = 1e-3;
  const std::string there = "; objective 2 on a mesh of size 0.1 with bdms 1";
  // Rounded up to two digits.
  EXPECT_EQ(words(judged(r, kept(1), {.residual = 0.2, .gain = left(5.41e-4, 0, nan)})),
            "optimal within 0.055 %: at most 0.055 % of J could still be gained; KKT residual 0.2" + there);
  EXPECT_EQ(
      words(judged(r, kept(1), {.obstacle = "a hole pays", .gain = left(4e-4, 1e-4, 2e-4)})),
      "optimal within 0.07 %: at most 0.07 % of J could still be gained: 0.04 % by moving the boundary, 0.01 % by "
      "a hole of radius 0.05 at (1, 2), 0.02 % by a bump of radius 0.02 at (3, 4); KKT residual 0.0001; a hole "
      "pays" +
          there);
  EXPECT_EQ(verdict_of(judged(r, kept(1), {.residual = 0.2, .budget_used = true, .gain = left(0, 0, 0)})),
            "optimal within 0.001 %");
  // Where the conditions hold it is optimal, whatever a bound says.
  EXPECT_EQ(words(judged(r, kept(1), {.gain = left(5e-4, 0, 0)})),
            "optimal: KKT residual 0.0001; at most 0.05 % of J could still be gained" + there);
  // More than the tolerance, or unknown.
  EXPECT_EQ(
      words(judged(r, kept(1), {.residual = 0.2, .gain = left(9e-4, 2e-4, 0)})),
      "stalled: done; at most 0.11 % of J could still be gained: 0.09 % by moving the boundary, 0.02 % by a hole of "
      "radius 0.05 at (1, 2), the tolerance is 0.1 %; KKT residual 0.2, an optimum has at most 0.001");
  EXPECT_EQ(judged(r, kept(1), {.residual = 0.2, .gain = left(nan, 0, 0)}).ending, Ending::Stalled);
  EXPECT_EQ(judged(r, kept(1), {.residual = 0.2, .gain = left(1e-4, nan, 0)}).ending, Ending::Stalled);
  r.tolerance = 2e-3;
  EXPECT_EQ(judged(r, kept(1), {.residual = 0.2, .gain = left(9e-4, 2e-4, 0)}).ending, Ending::OptimalWithin);
  // What is violated, here or on the finer mesh, or cannot be solved there, takes it away.
  EXPECT_EQ(judged(r, kept(1), {.fraction = 0.51, .gain = left(0, 0, 0)}).ending, Ending::Infeasible);
  EXPECT_EQ(judged(r, kept(1.01), {.residual = 0.2, .gain = left(0, 0, 0)}).ending, Ending::Infeasible);
  FinerDesign failed{.size = 0.1, .failure = "no mesh"};
  EXPECT_EQ(judged(r, failed, {.residual = 0.2, .gain = left(0, 0, 0)}).ending, Ending::Stalled);
}

TEST(Judge, TheFinerMeshHasHalfTheSize) {
  Problem p;
  p.frame = {};
  p.frame.outline = polygon("o", {{0, 0}, {3, 0}, {3, 4}, {0, 4}}, 0);
  p.sizing.size = 0;  // a fortieth of the diagonal
  p.sizing.crack_tip_size = 0.02;
  const Problem finer = finer_problem(p);
  EXPECT_DOUBLE_EQ(finer.sizing.size, 5.0 / 80);
  EXPECT_DOUBLE_EQ(finer.sizing.crack_tip_size, 0.01);
  EXPECT_EQ(finer.element.degree, 2);
  p.sizing.size = 0.3;
  EXPECT_DOUBLE_EQ(finer_problem(p).sizing.size, 0.15);
}

TEST(Judge, MoreRoomIsWhatTheFinerMeshFindsMore) {
  // 5 % more there: 5 % less is allowed here.
  FinerDesign finer = kept(1.05);
  finer.violation = 0.05;
  const OptimizeRequest r = asked(1);
  const auto room = [&](const FinerDesign& f, double at_most, double now, double value) {
    const std::vector<double> all = with_more_room(f, asked(at_most), std::array{now}, std::array{value});
    return all.empty() ? nan : all[0];
  };
  EXPECT_NEAR(room(finer, 1, 1, 1), 1 / 1.05, 1e-12);
  EXPECT_TRUE(std::isnan(room(finer, 1, 1 / 1.05, 1 / 1.05 + 0.01)));  // violated on its own mesh: no matter of meshes
  FinerDesign far = kept(1.5);
  far.violation = 0.5;
  EXPECT_TRUE(std::isnan(room(far, 1, 1 - most_room, 1 - most_room)));  // all that may be left is left
  EXPECT_NEAR(room(finer, 1, 1, 0.5), 1 - most_room, 1e-12);            // no more than that
  FinerDesign good = kept(1);
  EXPECT_TRUE(std::isnan(room(good, 1, 1, 1)));
  finer.failure = "no mesh";
  EXPECT_TRUE(std::isnan(room(finer, 1, 1, 1)));
  // Of a bound of 0 the difference counts, of which no share is known.
  FinerDesign zero = kept(0.02);
  zero.violation = 1;
  EXPECT_TRUE(std::isnan(room(zero, 0, 0, -0.01)));
}

TEST(Judge, ExcessIsRelativeToTheOwnMesh) {
  FinerDesign finer = kept(1.2);
  finer.bounds = {1.2, -0.9, 2};
  finer.intervals = {{nan, nan, nan}, {nan, nan, nan}, {2, 1.9, 2.5, true, ""}};
  const std::vector<double> excess = excess_of(finer, std::array{1.0, -1.0, 2.0});
  ASSERT_EQ(excess.size(), 3u);
  EXPECT_NEAR(excess[0], 0.2, 1e-12);
  EXPECT_NEAR(excess[1], 0.1, 1e-12);
  EXPECT_NEAR(excess[2], 0.25, 1e-12);  // of what is proved
}

TEST(HistoryText, LinesAndParts) {
  EXPECT_EQ(join({"a", "", "b"}), "a; b");
  EXPECT_EQ(join({"", ""}), "");
  EXPECT_EQ(join({"a", "b"}, ", "), "a, b");
  EXPECT_EQ(split_lines("a\n\nb"), (std::vector<std::string>{"a", "", "b"}));
  EXPECT_EQ(split_lines("a\n"), std::vector<std::string>{"a"});
  EXPECT_TRUE(split_lines("").empty());
}

// Lame's ring under inner pressure, whose compliance is known: chords are off by what no mesh takes away soon.
TEST(FinerDesign, FollowsTheCurvesOfTheDesign) {
  Problem p;
  p.frame = {circle("outline", {0, 0}, 2, 0), {circle("hole", {0, 0}, 1, 1)}, {}, {"rim", "hole"}, {}};
  p.scene.material = {1, 0.1};
  p.scene.tractions.push_back({1, [](const Vec2&, const Vec2& n) { return Vec2(-n); }});
  p.sizing.size = 0.4;
  p.objective = {"compliance", {compliance()}};
  constexpr double exact = pi * (0.4 / 3 + 4.0 / 3);
  const FinerDesign curved = solve_finer(p, {}, p.frame, 3 * pi);
  EXPECT_TRUE(curved.curved);
  EXPECT_NEAR(curved.objective, exact, 1e-6 * exact);
  EXPECT_NEAR(curved.volume_fraction, 1, 1e-8);
  p.follow_curves = false;
  const FinerDesign chords = solve_finer(p, {}, p.frame, 3 * pi);
  EXPECT_FALSE(chords.curved);
  EXPECT_GT(std::abs(chords.objective - exact), 1e-4 * exact);
  // In words, too.
  OptimizeResult result{.finer = curved};
  const Iteration row{.volume_fraction = 1};
  judge(result, {}, {.row = row, .residual = 0, .asked = 1e-3, .kind = "KKT residual", .why = "done"});
  EXPECT_NE(result.stopped.find("on a mesh of size 0.2 with bdms 2 and curved edges"), std::string::npos);
}

}  // namespace
}  // namespace kerf::finish_test
