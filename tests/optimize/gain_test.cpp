// Bounds of what is left to gain: the model against minima known in closed form, and curves against what restarts from
// their ends really gain, as a finer mesh has it.

#include "optimize/curves/gain.hpp"

#include "optimize/curves/design_curves.hpp"
#include "optimize/level_set/finishing.hpp"
#include "optimize/level_set/starts.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace kerf::gain_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Gain, IsThatOfTheBestStep) {
  MatrixXd H(2, 2);
  H << 2, 0, 0, 8;
  const Eigen::LLT<MatrixXd> factor(H);
  const VectorXd g = Eigen::Vector2d(-4, 8);
  // -4 x + x^2 is -4 at 2, 8 y + 4 y^2 is -4 at -1.
  EXPECT_NEAR(model_gain(factor, g, MatrixXd(0, 2), VectorXd(0)), 8, 1e-12);
  // x <= 1/2 leaves 2 - 1/4 of the first; y >= 0 nothing of the second.
  MatrixXd A(2, 2);
  A << 1, 0, 0, -1;
  EXPECT_NEAR(model_gain(factor, g, A, Eigen::Vector2d(0.5, 10)), 1.75 + 4, 1e-7);
  EXPECT_NEAR(model_gain(factor, g, A, Eigen::Vector2d(0.5, 0)), 1.75, 1e-7);
  // What is violated is no gain, and costs none.
  EXPECT_NEAR(model_gain(factor, g, A, Eigen::Vector2d(0.5, -3)), 1.75, 1e-7);
  EXPECT_NEAR(model_gain(factor, g, A, Eigen::Vector2d(-1, -3)), 0, 1e-7);
}

/// A rectangle, clamped along its left side or its foot and loaded where one of its sides is divided, and the share of
/// it that may be used.
struct Body {
  double width, height;
  bool on_foot;
  std::array<double, 2> from, to;  // of the load
  Vec2 load;
  double volume;
};

Problem problem_of(const Body& b) {
  const Vec2 from(b.from[0], b.from[1]), to(b.to[0], b.to[1]);
  Problem p;
  p.frame.labels = {"free", "load", "held"};
  std::vector<Vec2> points{{0, 0}, {b.width, 0}, {b.width, b.height}, {0, b.height}};
  const bool on_top = from.y() == b.height;
  points.insert(points.begin() + (on_top ? 3 : 2), {from, to});
  p.frame.outline = polygon("outline", points, 0);
  p.frame.outline.sides[on_top ? 3 : 2].label = 1;
  p.frame.outline.sides[b.on_foot ? 0 : 5].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.plane_strain = false;
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{.label = 1, .value = [load = b.load](const Vec2&, const Vec2&) -> Vec2 { return load; }}};
  p.sizing.size = 0.05;
  p.objective = {"compliance", {compliance()}};
  return p;
}

/// The curves after a random step of a fifth of the mesh size or less, of the same area.
DesignCurves shaken(const DesignCurves& d, double size, std::mt19937& random) {
  const std::vector<bool> turns = angles_of(d);
  std::uniform_real_distribution<double> any(-1, 1);
  for (double far = 0.2;; far *= 0.7) {
    VectorXd step(d.variables);
    for (Eigen::Index i = 0; i < step.size(); ++i) step[i] = any(random) * far * (turns[std::size_t(i)] ? 0.3 : size);
    DesignCurves other = moved(d, step);
    if (offset_to_area(other, area_of(d, nullptr)) && !find_problem(shape_of(other))) return other;
  }
}

// Five restarts each from the ends of four level sets: one of twenty may gain more than the bound; none does.
TEST(Gain, CoversWhatRestartsGain) {
  const std::array<Body, 4> bodies{{{1, 2, true, {0.6, 2}, {0.4, 2}, {6, -2}, 0.35},
                                    {1.5, 1.1, false, {1.5, 0.9}, {1.5, 1.1 - 0.05}, {0, -5}, 0.45},
                                    {1.4, 1, false, {1.4, 0.2}, {1.4, 0.35}, {5, 5}, 0.5},
                                    {1.6, 1.2, false, {1.6, 0.5}, {1.6, 0.7}, {2, -5}, 0.35}}};
  std::mt19937 random(3);
  int tries = 0, covered = 0;
  for (const Body& body : bodies) {
    const Problem p = problem_of(body);
    OptimizeRequest r;
    r.volume_at_most = body.volume;
    const Ground g = make_ground(p, r);
    const LevelSetStart start = best_start(g);
    Descent descent(g, {.iterations = 100, .explore = start.explore}, start.phi);
    while (descent.advance()) continue;
    const FinishedCurves end = finish(g, descent, {}, {});
    ASSERT_TRUE(end.curves && end.finer) << end.why;
    ASSERT_TRUE(std::isfinite(end.gain));
    const Carved carved = carved_again(g, descent.progress().phi);
    for (int k = 0; k < 5; ++k, ++tries) {
      const FinishedCurves again = continue_curves(fitted(g, 1), r, carved, shaken(*end.curves, g.size, random),
                                                   {.size = g.size, .evaluations = 60, .residual = 2e-3}, {});
      ASSERT_TRUE(again.finer) << again.why;
      const double gained = end.finer->objective - again.finer->objective;
      covered += gained <= end.gain;
      RecordProperty("restart_" + std::to_string(tries),
                     fmt::format("bound {:.3g} %, gained {:.3g} %", 100 * end.gain / end.J, 100 * gained / end.J));
    }
  }
  EXPECT_GE(covered, 0.95 * tries);
}

}  // namespace
}  // namespace kerf::gain_test
