// Single moves of a descent, begun from states that are made up: what it goes back to, and why it ends.

#include "optimize/level_set/descent.hpp"

#include "optimize/level_set/starts.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::descent_test {
namespace {

/// [0, 2] x [0, 1], clamped on the left, pulled down in the middle of the right.
Problem cantilever() {
  Problem p;
  p.frame.labels = {"free", "load", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 0.4}, {2, 0.6}, {2, 1}, {0, 1}}, 0);
  p.frame.outline.sides[2].label = 1;
  p.frame.outline.sides[5].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{.label = 1, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, -10}; }}};
  p.plane_strain = false;
  p.sizing.size = 0.15;
  p.objective = {"compliance", {compliance()}};
  return p;
}

OptimizeRequest with_a_hole(double radius) {
  OptimizeRequest r;
  r.volume_at_most = 0.9;
  r.level_set.start = StartHoles{.columns = 1, .rows = 1, .radius = radius};
  return r;
}

/// A descent that has just begun, with a hole of that radius in the middle.
struct Begun {
  Problem p = cantilever();
  OptimizeRequest r;
  Ground g;
  explicit Begun(double radius) : r(with_a_hole(radius)), g(make_ground(p, r)) {}
  DescentState state() const {
    return Descent(g, {.iterations = 20}, given_start(g).phi).progress();
  }
  KeptDesign kept(const DescentState& s) const {
    const Iteration& row = s.rows.back();
    return {s.phi, row.objective, row.volume_fraction * g.whole, Eigen::VectorXd(), s.iteration};
  }
};

TEST(Descent, StatesComeBackBitForBit) {
  const Begun b(0.25);
  DescentState s = b.state();
  s.anchor = b.kept(s);
  s.anchor.bounds = Eigen::Vector2d(1, 2);
  s.track = {3, 2, 1};
  s.why = "why";
  s.drawn = {"a note", "another"};
  s.nucleated = {{.iteration = 3, .at = {0.1, 0.2}, .radius = 0.3, .T = -1, .c2 = nan, .predicted = 2, .actual = 2.1},
                 {.iteration = 4, .at = {1, 2}, .note = "no room"}};
  s.rows.back().variables = Eigen::Vector3d(1, 2, 3);
  s.rows.back().bounds = {4, 5};
  s.rows.push_back(s.rows.back());
  s.rows.back().note = "second\nline, a \\ and \\n";
  const DescentState back = unpacked(packed(s));
  EXPECT_EQ(back.phi, s.phi);
  EXPECT_EQ(back.anchor.phi, s.anchor.phi);
  EXPECT_EQ(back.anchor.bounds, s.anchor.bounds);
  EXPECT_EQ(back.anchor.J, s.anchor.J);
  EXPECT_EQ(back.track, s.track);
  EXPECT_EQ(back.why, s.why);
  EXPECT_EQ(back.drawn, s.drawn);
  EXPECT_EQ(back.radius, s.radius);
  ASSERT_EQ(back.rows.size(), 2u);
  EXPECT_EQ(back.rows[0].variables, s.rows[0].variables);
  EXPECT_EQ(back.rows[0].bounds, s.rows[0].bounds);
  EXPECT_EQ(back.rows[0].note, s.rows[0].note);
  EXPECT_EQ(back.rows[1].note, s.rows[1].note);
  ASSERT_EQ(back.nucleated.size(), 2u);
  EXPECT_EQ(back.nucleated[0].at, s.nucleated[0].at);
  EXPECT_EQ(back.nucleated[0].actual, 2.1);
  EXPECT_TRUE(std::isnan(back.nucleated[0].c2));
  EXPECT_EQ(back.nucleated[1].iteration, 4);
  EXPECT_EQ(back.nucleated[1].note, "no room");
  EXPECT_TRUE(std::isnan(back.nucleated[1].radius));
}

/// After a trial nucleation the anchor is what it has to beat.
TEST(Descent, TrialsPayOrAreTakenBack) {
  const Begun small(0.25), large(0.33);
  const DescentState before = small.state(), after = large.state();
  for (const bool pays : {true, false}) {
    DescentState s = after;
    s.allowed = large.g.target;
    s.trials = 1;
    s.next = static_cast<int>(Next::CloseTrial);
    s.best = large.kept(after);
    s.anchor = small.kept(before);
    s.anchor.J = (pays ? 2 : 0.5) * s.best.J;
    s.anchor.iteration = 7;
    Descent d(large.g, {.iterations = 20}, s);
    EXPECT_TRUE(d.advance());
    const DescentState& now = d.progress();
    EXPECT_EQ(now.anchor.phi.size(), 0);
    EXPECT_EQ(now.track.size(), 1u);
    if (pays) {
      EXPECT_EQ(now.trials, 0);  // another one may be tried
      EXPECT_NE(now.rows.back().note.find("the trial has paid"), std::string::npos) << now.rows.back().note;
      EXPECT_EQ(now.phi, after.phi);
    } else {
      EXPECT_EQ(now.trials, 1);
      EXPECT_EQ(now.rows.back().note, "back to iteration 7: the trial did not pay");
      EXPECT_EQ(now.phi, before.phi);
      EXPECT_EQ(now.best.phi, before.phi);
    }
  }
}

/// With no iteration left a trial that has not paid yet does not count.
TEST(Descent, OutOfIterationsTheBestDesignIsTaken) {
  const Begun small(0.25), large(0.33);
  const DescentState before = small.state(), after = large.state();
  for (const bool pays : {true, false}) {
    DescentState s = after;
    s.allowed = large.g.target;
    s.iteration = 20;
    s.best = large.kept(after);
    s.anchor = small.kept(before);
    s.anchor.J = (pays ? 2 : 0.5) * s.best.J;
    Descent d(large.g, {.iterations = 20}, s);
    EXPECT_FALSE(d.advance());
    EXPECT_EQ(d.progress().ended, "the iterations asked for are done (20)");
    EXPECT_TRUE(d.progress().spent);
    EXPECT_EQ(d.progress().phi, pays ? after.phi : before.phi);
    EXPECT_FALSE(d.advance());
    // With more of them it goes on.
    Descent more(large.g, {.iterations = 25}, d.progress());
    EXPECT_EQ(more.progress().ended, "");
  }
}

TEST(Descent, GoesBackToTheBestWhenNothingBetterCame) {
  const Begun small(0.25), large(0.33);
  const DescentState before = small.state(), after = large.state();
  for (const Next next : {Next::BackToBest, Next::End}) {
    DescentState s = after;
    s.allowed = large.g.target;
    s.next = static_cast<int>(next);
    s.why = "a reason";
    s.best = small.kept(before);
    s.best.iteration = 3;
    s.since = 4;
    Descent d(large.g, {.iterations = 20}, s);
    EXPECT_TRUE(d.advance());
    EXPECT_EQ(d.progress().rows.back().note, "back to iteration 3: a reason");
    EXPECT_EQ(d.progress().phi, before.phi);
    EXPECT_EQ(d.progress().since, 0);
    EXPECT_EQ(d.progress().next, static_cast<int>(next == Next::End ? Next::Nucleate : Next::Step));
  }
}

/// All sides bear loads or hold, and there is no hole: no step can be made, and the last row says why.
TEST(Descent, SaysThatNothingCanMove) {
  Problem p = cantilever();
  for (Side& side : p.frame.outline.sides)
    if (side.label == 0) side.label = 1;
  p.scene.tractions[0].value = [](const Vec2& x, const Vec2&) -> Vec2 { return {0, -x.x()}; };
  OptimizeRequest r;
  r.volume_at_most = 0.9;
  r.level_set.nucleate_every = 0;
  const Ground g = make_ground(p, r);
  Descent d(g, {.iterations = 20}, given_start(g).phi);
  while (d.advance()) {
  }
  EXPECT_EQ(d.progress().ended,
            "no step can be made: refused: no boundary is free to move; ask for optimize.nucleate or optimize.start");
  EXPECT_FALSE(d.settled());
  for (std::size_t i = 1; i < d.progress().rows.size(); ++i) EXPECT_FALSE(d.progress().rows[i].accepted);
}

/// The least area of which two load cases bend no more than they may.
TEST(Descent, BoundsHoldInTheWorstLoadCase) {
  Problem p = cantilever();
  OptimizeRequest r = with_a_hole(0.25);
  r.volume_at_most.reset();
  r.load_cases = {{"down", 1, p.scene.tractions, {}}, {"up", 1, p.scene.tractions, {}}};
  r.load_cases[1].tractions[0].value = [](const Vec2&, const Vec2&) -> Vec2 { return {0.5, 9.9}; };
  p.scene.tractions.clear();
  FunctionalBound bound;
  bound.functional = p.objective;
  p.objective = {"volume", {volume()}};
  for (const double share : {0.98, 1.2}) {  // violated at the start, and not
    r.bounds.clear();
    const double start = [&] {
      r.bounds = {bound};
      r.bounds[0].at_most = 1e9;
      const Ground g = make_ground(p, r);
      return Descent(g, {.iterations = 1}, given_start(g).phi).design().bounds[0];
    }();
    r.bounds[0].at_most = share * start;
    const Ground g = make_ground(p, r);
    Descent d(g, {.iterations = 12}, given_start(g).phi);
    const double area = d.design().area;
    EXPECT_EQ(d.keeps_bounds(d.design()), share > 1);
    while (d.advance()) {
    }
    EXPECT_TRUE(d.keeps_bounds(d.design())) << d.design().bounds[0] / r.bounds[0].at_most;
    if (share > 1) {
      EXPECT_LT(d.design().area, area);
    }
  }
}

/// Velocities of an elastic body move the boundary as others do.
TEST(Descent, ElasticVelocities) {
  const Problem p = cantilever();
  OptimizeRequest r = with_a_hole(0.25);
  r.level_set.product = LevelSetRequest::Product::Elasticity;
  const Ground g = make_ground(p, r);
  ASSERT_TRUE(g.elastic);
  Descent d(g, {.iterations = 6}, given_start(g).phi);
  const double before = d.merit();
  while (d.advance()) {
  }
  EXPECT_LT(d.merit(), before);
  EXPECT_LE(d.design().area, g.target * (1 + 1e-3));
}

/// Where stress counts, sharp corners that look into the body stay notches: of the frame and of its holes, but not
/// between loads and supports.
TEST(MakeGround, CornersStayCutOutWhereStressCounts) {
  Problem p = cantilever();
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 0.5}, {1, 0.5}, {1, 1}, {0, 1}}, 0);
  p.frame.outline.sides[1].label = 1;
  p.frame.outline.sides[5].label = 2;
  p.frame.holes = {polygon("square", {{0.3, 0.4}, {0.6, 0.4}, {0.6, 0.7}, {0.3, 0.7}}, 0)};
  OptimizeRequest r;
  r.volume_at_most = 0.9;
  EXPECT_EQ(make_ground(p, r).background.hollow.size(), 0);
  FunctionalBound bound;
  bound.functional = {"stress", {stress_pnorm(6, {}, false)}};
  bound.at_most = 1e6;
  for (const bool objective : {true, false}) {
    OptimizeRequest asked = r;
    Problem q = p;
    if (objective) {
      q.objective = bound.functional;
    } else {
      asked.bounds = {bound};
    }
    const Ground g = make_ground(q, asked);
    const auto corners = std::ranges::count_if(
        g.notes, [](const std::string& note) { return note.find("stays cut out") != std::string::npos; });
    EXPECT_EQ(corners, 1 + 4);
    EXPECT_NE(g.notes.front().find("the corner at (1, 0.5)"), std::string::npos) << g.notes.front();
    // Twice the mesh size around each.
    for (Eigen::Index v = 0; v < g.background.hollow.size(); ++v) {
      const Vec2& x = g.background.mesh.points[static_cast<std::size_t>(v)];
      double away = (x - Vec2(1, 0.5)).norm();
      for (const Side& side : p.frame.holes[0].sides) away = std::min(away, (x - side.start).norm());
      EXPECT_NEAR(g.background.hollow[v], 2 * g.size - away, 1e-9);
    }
  }
  p.frame.outline.sides[2].label = 1;  // loaded on one side
  r.bounds = {bound};
  EXPECT_EQ(make_ground(p, r).notes.front().find("the corner at (1, 0.5)"), std::string::npos);
}

TEST(MakeGround, LengthsThatAreNotGiven) {
  Problem p = cantilever();
  p.sizing.size = 0;
  OptimizeRequest r;
  r.volume_at_most = 1;
  r.level_set.smoothing = 0.3;
  const Ground g = make_ground(p, r);
  EXPECT_DOUBLE_EQ(g.mesh_size, std::sqrt(5.0) / 40);
  EXPECT_FALSE(g.limited);
  EXPECT_NEAR(g.whole, 2, 1e-9);
}

}  // namespace
}  // namespace kerf::descent_test
