// The last part of a level-set run: which design is the result, what a checkpoint keeps of it, what is said of it.

#include "optimize/level_set/end.hpp"

#include "kerf/inverse.hpp"
#include "optimize/level_set/finishing.hpp"
#include "optimize/level_set/starts.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::end_test {
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

TEST(CurvesRows, ComeBackBitForBit) {
  CurvesRow a{.J = 1.5,
              .area = 2.5,
              .area_fraction = 0.4,
              .bounds = {1, nan},
              .violation = 0.1,
              .residual = nan,
              .price = 3,
              .step = 0.2,
              .triangles = 123,
              .holes = 4,
              .state_solves = 5,
              .accepted = true,
              .rebased = true,
              .note = "a note",
              .knots = Eigen::Vector3d(1, 2, 3),
              .values = Eigen::Vector2d(4, 5),
              .gradients = Eigen::Vector4d(6, 7, 8, 9)};
  CurvesRow b{.state_solves = 6, .fresh = true, .failure = "no mesh"};
  Checkpoint c;
  write_curves(c, {a, b});
  const std::vector<CurvesRow> back = read_curves(c);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[0].J, 1.5);
  EXPECT_EQ(back[0].bounds[0], 1);
  EXPECT_TRUE(std::isnan(back[0].bounds[1]));
  EXPECT_TRUE(std::isnan(back[0].residual));
  EXPECT_EQ(back[0].triangles, 123);
  EXPECT_EQ(back[0].holes, 4);
  EXPECT_EQ(back[0].knots, a.knots);
  EXPECT_EQ(back[0].values, a.values);
  EXPECT_EQ(back[0].gradients, a.gradients);
  EXPECT_EQ(back[0].note, "a note");
  EXPECT_TRUE(back[0].accepted && back[0].rebased && !back[0].fresh);
  EXPECT_EQ(back[1].state_solves, 6);
  EXPECT_TRUE(back[1].fresh && !back[1].accepted && !back[1].rebased);
  EXPECT_EQ(back[1].failure, "no mesh");
  EXPECT_TRUE(std::isnan(back[1].J));
  write_curves(c, {});
  EXPECT_TRUE(read_curves(c).empty());
}

/// Curves against the carved design: what keeps the bounds first, then what is better by more than meshes differ.
TEST(CurvesOrCarved, TheBetterOneIsTheResult) {
  const Problem p = cantilever();
  OptimizeRequest r;
  r.volume_at_most = 0.95;
  r.level_set.start = StartHoles{.columns = 1, .rows = 1, .radius = 0.25};
  const Ground g = make_ground(p, r);
  const Descent d(g, {.iterations = 5}, given_start(g).phi);
  const Evaluated& carved = d.design();
  ASSERT_LT(carved.area / g.whole, 0.95);
  FinishedCurves c;
  const auto better = [&] { return curves_are_better({g, d, c}); };
  c.J = 0.5 * carved.J;
  c.area = carved.area;
  EXPECT_FALSE(better());  // no shape: none were made
  c.shape = carved.shape;
  EXPECT_TRUE(better());
  c.J = nan;
  EXPECT_FALSE(better());
  c.J = 1.0005 * carved.J;  // as good, but for the mesh
  EXPECT_TRUE(better());
  c.J = 1.002 * carved.J;
  EXPECT_FALSE(better());
  c.J = 0.5 * carved.J;
  c.area = 0.97 * g.whole;  // too much material
  EXPECT_FALSE(better());
}

/// What is said of curves: by small bumps and holes, and by the finer mesh.
TEST(CurvesOrCarved, ChangesAndTheFinerMeshHaveAWord) {
  Problem p = cantilever();
  p.sizing.size = 0.35;
  OptimizeRequest r;
  r.level_set.start = StartHoles{.columns = 1, .rows = 1, .radius = 0.25};
  const auto said = [&](double penalty, double residual, double finer) {
    r.volume_penalty = penalty;
    const Ground g = make_ground(p, r);
    const Descent d(g, {.iterations = 1}, given_start(g).phi);
    FinishedCurves c{.shape = d.design().shape, .J = d.design().J, .area = d.design().area, .residual = residual};
    c.finer = {.size = 0.1, .element = p.element, .objective = c.J, .violation = 0};
    c.finer->residual = finer;
    LevelSetEnd end{g, d, c};
    end.last = std::make_shared<const Evaluated>(d.design());
    return result_of(end, true);
  };
  // Material is cheap: a little more of it pays somewhere. A large residual saves the price of a proof.
  const OptimizeResult cheap = said(1e-3, 0.5, 0.02);
  EXPECT_LT(cheap.bumps.least, 0);
  EXPECT_FALSE(cheap.holes.proof);
  EXPECT_EQ(cheap.ending, Ending::Stalled);
  EXPECT_NE(cheap.stopped.find("a small bump at ("), std::string::npos) << cheap.stopped;
  EXPECT_NE(cheap.stopped.find(" pays: it is worth "), std::string::npos) << cheap.stopped;
  // It is dear: less of it does, and holes that are made there are asked. On the finer mesh it is no optimum.
  const OptimizeResult dear = said(1e5, 0.01, 0.2);
  EXPECT_GT(dear.bumps.least, 0);
  EXPECT_LT(dear.holes.least, 0);
  EXPECT_NE(dear.stopped.find("a small hole at ("), std::string::npos) << dear.stopped;
  EXPECT_NE(dear.stopped.find("shape residual 0.01 here and 0.2 on the finer mesh, an optimum has at most 0.05 there"),
            std::string::npos)
      << dear.stopped;
  ASSERT_TRUE(dear.holes.proof);
  EXPECT_EQ(dear.stopped.find("; holes made there agree") != std::string::npos, *dear.holes.proof == Verdict::Holds);
}

TEST(CurvesOrCarved, BoundsComeFirst) {
  const Problem p = cantilever();
  OptimizeRequest r;
  r.volume_at_most = 0.95;
  r.level_set.start = StartHoles{.columns = 1, .rows = 1, .radius = 0.25};
  const double J = [&] {
    const Ground g = make_ground(p, r);
    return Descent(g, {.iterations = 5}, given_start(g).phi).design().J;
  }();
  FunctionalBound bound;
  bound.functional = p.objective;
  for (const double share : {0.9, 1.05}) {  // the carved design violates it, or has room
    bound.at_most = share * J;
    r.bounds = {bound};
    const Ground g = make_ground(p, r);
    const Descent d(g, {.iterations = 5}, given_start(g).phi);
    FinishedCurves c{.shape = d.design().shape, .J = 1.1 * J, .area = d.design().area};
    const auto better = [&](double value) {
      c.bounds = {value};
      return curves_are_better({g, d, c});
    };
    if (share < 1) {
      EXPECT_TRUE(better(0.9 * J));   // keeps it
      EXPECT_TRUE(better(0.95 * J));  // violates it less
      EXPECT_FALSE(better(1.2 * J));  // more
    } else {
      EXPECT_FALSE(better(1.2 * J));
      EXPECT_FALSE(better(J));  // both keep it, and J is higher by a tenth
      c.J = 1.01 * J;           // by less than the room that curves leave for a finer mesh costs
      EXPECT_TRUE(better(J));
      // A finer mesh knows that the curves keep it; of the carved design it says so, too.
      c.J = 1.1 * J;
      c.finer.emplace();
      c.finer->violation = 0;
      EXPECT_FALSE(better(J));
    }
  }
}

/// Left on the way a run goes on from its checkpoint as if nothing had been.
TEST(LevelSetRuns, GoOnFromTheirCheckpoint) {
  const test::Folder folder;
  Problem p = cantilever();  // its support moves a little: no density stage, which takes longer than all of the rest
  p.scene.supports[0].value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, 1e-9}; };
  OptimizeRequest r;
  r.volume_at_most = 0.9;
  r.max_iterations = 4;
  r.level_set.start = StartHoles{.columns = 1, .rows = 1, .radius = 0.2};
  const OptimizeResult whole = optimize_level_set(p, r, {}, {});
  const CheckpointPlace place{folder.path / "checkpoint", "case", true};
  for (const int stop : {0, 3}) {
    std::filesystem::remove(place.path);
    optimize_level_set(
        p, r, [stop](const Iterate& i) { return i.row.number < stop; }, place);
    const OptimizeResult resumed = optimize_level_set(p, r, {}, place);
    EXPECT_EQ(resumed.objective, whole.objective);
    EXPECT_EQ(resumed.stopped, whole.stopped);
    EXPECT_EQ(resumed.history.size(), whole.history.size());
  }
  const CheckpointPlace other{place.path, "another", true};
  try {
    optimize_level_set(p, r, {}, other);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("belongs to another case"), std::string::npos);
  }
}

TEST(Words, OfLeastSquaresAndCounts) {
  LeastSquares fit{.variables = Eigen::Vector3d(1, 2, 3),
                   .readings = 40,
                   .start = 0.5,
                   .end = 0.001,
                   .noise = 0.01,
                   .covariance = Eigen::Vector3d(0.04, 0, 1e-4).asDiagonal(),
                   .stopped = "done"};
  fit.ellipses = {{"hole 'h'", {1, 2}, {0.3, 0.1}, pi / 4}, {"fixed", {0, 0}, {0, 0}, 0}};
  EXPECT_EQ(
      in_words(fit, {"x", "y", "radius"}),
      (std::vector<std::string>{"least squares: 0.5 to 0.001 over 40 readings, noise 0.01; done", "x 1 +- 0.2",
                                "radius 3 +- 0.01", "hole 'h': 95 % ellipse 0.3 by 0.1, long axis at 45 degrees"}));
  fit.estimated = true;
  EXPECT_NE(in_words(fit, {"x", "y", "radius"})[0].find("noise 0.01 (estimated)"), std::string::npos);
  Count count;
  count.tried = {{.count = 0, .criterion = 812.44}, {.count = 1, .criterion = 130.2}, {.count = 2, .failure = "torn"}};
  count.chosen = 1;
  EXPECT_EQ(in_words(count), "1 defect by the criterion of Bayes and Schwarz: 0: 812.4, 1: 130.2, 2: none (torn)");
  count.chosen = 0;
  EXPECT_EQ(in_words(count).rfind("0 defects by", 0), 0u);
}

}  // namespace
}  // namespace kerf::end_test
