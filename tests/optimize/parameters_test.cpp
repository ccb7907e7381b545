// Optimizations of drawn parts: derivatives against central differences on the moved mesh, optima known by symmetry or
// by an active constraint, and the same bits after a kill.

#include "kerf/optimize.hpp"

#include "optimize/parametric/evaluations.hpp"
#include "optimize/parametric/starts.hpp"
#include "tests/optimize/designs.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/core.h>

#include <csignal>
#include <filesystem>

namespace kerf::parameters_test {
namespace {

using namespace scenes;
using Eigen::VectorXd;

TEST(Parameters, DerivativesByEveryVariableAgreeWithCentralDifferencesOnTheMovedMesh) {
  Problem p = everything();
  p.objective = {"compliance", {compliance()}};
  OptimizeRequest request{.method = OptimizeMethod::Mma};
  request.design = everything_drawn();
  const auto target = [](const Vec2& x) { return Vec2(0.3 * x.y(), std::sin(x.x())); };
  const auto weight = [](const Vec2& x) { return 1 + 0.3 * std::sin(x.x()); };
  const auto measured = [](const Vec2& x, const Vec2&) { return Vec2(0.1 * x.x(), 0.8); };
  for (const Term& term :
       {energy(), displacement_tracking(target, {}), stress_pnorm(6, weight, true), boundary_tracking(1, {}, {}),
        misfit(2, measured), energy_release_rate({-0.3, 0.1}, {-1, 0.1}, {0.1, 0.3}, p.scene.body),
        crack_opening(0, {}), volume()})
    request.bounds.push_back({term.kind, {term.kind, {term}}, 1});
  const VectorXd x = start_of(request.design);
  Evaluations evaluations(p, request);
  evaluations.begin_round();
  const DesignEvaluation start = evaluations.evaluate(x, true);
  ASSERT_EQ(start.evaluation.failure, "");
  EXPECT_TRUE(start.fresh);
  const VectorXd width = upper_bounds(request.design) - lower_bounds(request.design);
  const auto many = static_cast<Eigen::Index>(1 + request.bounds.size());
  const Eigen::MatrixXd g = width.asDiagonal() * start.evaluation.gradients.leftCols(many);
  constexpr double step = 2e-4;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto at = [&](double t) -> VectorXd {
      VectorXd y = x;
      y[i] += t * width[i];
      const DesignEvaluation other = evaluations.evaluate(y, false);
      EXPECT_EQ(other.evaluation.failure, "");
      EXPECT_FALSE(other.fresh);
      return other.evaluation.values.head(many);
    };
    const VectorXd expected = (at(step) - at(-step)) / (2 * step);
    for (Eigen::Index k = 0; k < many; ++k)
      EXPECT_NEAR(g(i, k), expected[k], 2e-6 * g.col(k).cwiseAbs().maxCoeff())
          << "variable " << i << " of "
          << (k == 0 ? "compliance" : request.bounds[static_cast<std::size_t>(k - 1)].name);
  }
}

/// A plate pulled at the top and the bottom, held in the middle of its sides; one hole drawn, and perhaps a crack.
Problem plate() {
  Problem p;
  p.frame = rectangle({-1, -1}, {1, 1});
  p.scene.material = plane_stress(1, 0.3);
  p.plane_strain = false;
  p.scene.supports = {{3, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }},
                      {1, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }},
                      {0, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0, 1 + 0.5 * std::cos(M_PI * x.x())); }}};
  p.sizing = {.size = 0.15, .crack_tip_size = 0.05};
  p.objective = {"compliance", {compliance()}};
  return p;
}

OptimizeRequest hole(const Eigen::Vector3d& start, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  OptimizeRequest r{.method = OptimizeMethod::Mma, .max_iterations = 60, .tolerance = 1e-4};
  r.design.drawn = {{Drawn::Kind::Circle, "h", low, high, start}};
  return r;
}

void expect_same(const OptimizeResult& a, const OptimizeResult& b);

OptimizeResult quietly(const Problem& p, const OptimizeRequest& r) {
  return optimize_parameters(p, r, {}, {});
}

TEST(Parameters, AHoleFindsTheMiddleOfASymmetricPlate) {
  // Everything is symmetric about x = 0, where the load is strongest: a hole there makes the plate most compliant.
  Problem p = plate();
  p.objective.terms[0].factor = -1;
  OptimizeRequest r = hole({0.25, 0, 0.2}, {-0.4, 0, 0.2}, {0.4, 0, 0.2});
  for (const OptimizeMethod method : nlopt_methods) {
    r.method = method;
    const OptimizeResult found = quietly(p, r);
    EXPECT_EQ(found.ending, Ending::Optimal) << word(method) << ": " << found.stopped;
    EXPECT_NEAR(found.variables[0], 0, 0.02) << word(method) << ": " << found.stopped;
    EXPECT_EQ(found.variables[1], 0);
    EXPECT_GT(found.state_solves, 3);
    EXPECT_LT(found.objective, found.history.front().objective);
  }
}

/// A hole as small as the volume allows.
struct Least {
  Problem p = plate();
  OptimizeRequest r = hole({0.1, 0.1, 0.15}, {-0.5, -0.5, 0.1}, {0.5, 0.5, 0.45});
  Least() {
    r.volume_at_most = 0.92;
  }
  void expect_kept(const OptimizeResult& found) const {
    EXPECT_TRUE(found.feasible) << found.stopped;
    EXPECT_EQ(found.ending, Ending::Optimal) << found.stopped;
    EXPECT_NEAR(found.variables[2], std::sqrt(0.08 * 4 / M_PI), 1e-4);
    EXPECT_NEAR(found.volume_fraction, 0.92, 1e-5);
  }
};

// By MMA: KilledAndResumedEndsWithTheSameBits.
TEST(Parameters, TheVolumeConstraintIsActiveAndExact) {
  Least least;
  least.r.method = OptimizeMethod::Slsqp;
  least.expect_kept(quietly(least.p, least.r));
}

TEST(Parameters, ASplineUnderEqualPullOnAllSidesBecomesACircle) {
  Problem p = plate();
  const auto pull = [](const Vec2&, const Vec2& n) -> Vec2 { return n; };
  p.scene.supports.erase(p.scene.supports.begin() + 1);  // rollers on the left and at the bottom
  p.scene.tractions = {{1, pull}, {2, pull}};
  p.sizing = {.size = 0.25};
  OptimizeRequest r{.method = OptimizeMethod::Slsqp, .max_iterations = 40};
  VectorXd start(16);
  for (int i = 0; i < 8; ++i)
    start.segment<2>(2 * i) = (i == 0 || i == 3 ? 0.4 : 0.28) * Vec2(std::cos(M_PI * i / 4), std::sin(M_PI * i / 4));
  r.design.drawn = {drawn(Drawn::Kind::Spline, "s", start, 0.25)};
  r.volume_at_most = 1 - 0.09 * M_PI / 4;
  const OptimizeResult found = quietly(p, r);
  EXPECT_EQ(found.ending, Ending::Optimal) << found.stopped;
  EXPECT_NEAR(found.volume_fraction, *r.volume_at_most, 1e-5);
  const auto roundness = [](const Loop& loop) {  // 1 for a circle
    const Polygon polygon = flatten(loop, 1e-3, 1);
    double area = 0, length = 0;
    for (std::size_t i = 0; i < polygon.points.size(); ++i) {
      const Vec2 &from = polygon.points[i], &to = polygon.points[(i + 1) % polygon.points.size()];
      area += cross(from, to) / 2;
      length += (to - from).norm();
    }
    return 4 * M_PI * area / (length * length);
  };
  EXPECT_LT(roundness(body_of(r.design, start, p).shape.holes[0]), 0.97);
  EXPECT_GT(roundness(found.shape.holes[0]), 0.995);
}

TEST(Parameters, TwoHolesKeepTheirDistanceAndTheLigament) {
  // Both want to where the load is weakest, the right side: they touch it and each other as near as they may.
  Problem p = plate();
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0, 1.2 - x.x()); }}};
  OptimizeRequest r = hole({0.2, 0.35, 0.2}, {-0.7, -0.7, 0.2}, {0.7, 0.7, 0.2});
  r.design.drawn.push_back(r.design.drawn[0]);
  r.design.drawn[1].name = "g";
  r.design.drawn[1].start[1] = -0.35;
  r.min_distance = 0.15;
  r.max_iterations = 80;
  const OptimizeResult found = quietly(p, r);
  EXPECT_TRUE(found.feasible) << found.stopped;
  const Vec2 a = found.variables.head<2>(), b = found.variables.segment<2>(3);
  EXPECT_GE((a - b).norm(), 0.4 + 0.15 - 1e-6);
  for (const Vec2& x : {a, b}) EXPECT_GE(1 - x.cwiseAbs().maxCoeff() - 0.2, 0.15 - 1e-6);
  EXPECT_NEAR(1 - std::max(a.x(), b.x()) - 0.2, 0.15, 2e-3) << found.stopped;  // active
  EXPECT_LT(found.objective, found.history.front().objective);
}

TEST(Parameters, AClosedCrackIsKeptAwayFromAndItsContactRespected) {
  Problem p = plate();
  p.frame.cracks = {{"c", {Vec2(-0.5, -0.3), Vec2(0.4, -0.1)}}};
  p.scene.laws.resize(1);
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.3, -1 + 1.2 * x.x()); }}};
  p.sizing = {.size = 0.2, .crack_tip_size = 0.05};
  OptimizeRequest r = hole({0.1, 0.45, 0.15}, {-0.6, -0.6, 0.1}, {0.6, 0.6, 0.3});
  r.volume_at_most = 0.97;
  r.min_distance = 0.1;
  const OptimizeResult found = quietly(p, r);
  EXPECT_TRUE(found.feasible) << found.stopped;
  EXPECT_LT(found.objective, found.history.front().objective + 1e-12);
  EXPECT_GE(found.variables[2], std::sqrt(0.03 * 4 / M_PI) - 1e-4);
  const std::string& check = found.notes.front();
  EXPECT_EQ(check.rfind("derivative check", 0), 0u) << check;
}

TEST(Parameters, BoundsOnOtherFunctionalsHold) {
  // The smallest body whose compliance does not exceed a value.
  Problem p = plate();
  p.objective = {"volume", {volume()}};
  OptimizeRequest r = hole({0.0, 0.0, 0.15}, {-0.3, -0.3, 0.1}, {0.3, 0.3, 0.5});
  Evaluations evaluations(p, r);
  evaluations.begin_round();
  const DesignEvaluation start = evaluations.evaluate(start_of(r.design), true);
  r.bounds = {{"compliance", {"compliance", {compliance()}}, 4.2}};
  const OptimizeResult found = quietly(p, r);
  EXPECT_TRUE(found.feasible) << found.stopped;
  ASSERT_EQ(found.history.back().bounds.size(), 1u);
  EXPECT_LT(found.objective, start.objective);
  EXPECT_LE(found.history.back().bounds[0], 4.2 * (1 + 1e-6));
  EXPECT_GE(found.history.back().bounds[0], 4.2 * (1 - 5e-3));
}

TEST(Parameters, LoadCasesAddUp) {
  Problem p = plate();
  OptimizeRequest r = hole({0.1, 0.05, 0.2}, {-0.3, -0.3, 0.1}, {0.3, 0.3, 0.3});
  const auto objective = [&](const Problem& problem, const OptimizeRequest& request) {
    Evaluations evaluations(problem, request);
    evaluations.begin_round();
    return evaluations.evaluate(start_of(request.design), true);
  };
  const DesignEvaluation first = objective(p, r);
  Problem q = p;
  q.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0, x.x()); }}};
  const DesignEvaluation second = objective(q, r);
  r.load_cases = {{"pull", 2, p.scene.tractions, {}}, {"bend", 0.5, q.scene.tractions, {}}};
  p.scene.tractions.clear();
  const DesignEvaluation both = objective(p, r);
  EXPECT_NEAR(both.objective, 2 * first.objective + 0.5 * second.objective, 1e-12 * both.objective);
  EXPECT_EQ(both.state_solves, 2);
  EXPECT_LT((both.evaluation.gradients.col(0) - 2 * first.evaluation.gradients.col(0) -
             0.5 * second.evaluation.gradients.col(0))
                .norm(),
            1e-10 * both.evaluation.gradients.col(0).norm());
}

TEST(Parameters, ImpossibleConstraintsEndInfeasible) {
  OptimizeRequest r = hole({0, 0, 0.15}, {-0.3, -0.3, 0.1}, {0.3, 0.3, 0.3});
  r.bounds = {{"compliance", {"compliance", {compliance()}}, 0.5}};  // the full plate has several times that
  r.max_iterations = 25;
  const OptimizeResult found = quietly(plate(), r);
  EXPECT_FALSE(found.feasible);
  EXPECT_EQ(found.ending, Ending::Infeasible);
  EXPECT_EQ(found.stopped.rfind("infeasible: ", 0), 0u) << found.stopped;
}

TEST(Parameters, DesignsThatOverlapDoNotAbortTheRun) {
  // Bounds that let the hole leave the plate, swallow the crack and meet the other hole.
  Problem p = plate();
  p.frame.cracks = {{"c", {Vec2(-0.2, 0.2), Vec2(0.2, 0.2)}}};
  p.scene.laws.resize(1);
  OptimizeRequest r = hole({-0.5, -0.5, 0.2}, {-1.5, -1.5, 0.05}, {1.5, 1.5, 0.8});
  r.design.drawn.push_back({Drawn::Kind::Circle, "g", Eigen::Vector3d(-1.5, -1.5, 0.05), Eigen::Vector3d(1.5, 1.5, 0.8),
                            Eigen::Vector3d(0.5, -0.5, 0.2)});
  r.volume_at_most = 0.9;
  r.max_iterations = 20;
  for (const OptimizeMethod method : nlopt_methods) {
    r.method = method;
    const OptimizeResult found = quietly(p, r);
    EXPECT_TRUE(found.feasible) << word(method) << ": " << found.stopped;
    EXPECT_EQ(find_problem(found.shape), std::nullopt);
    EXPECT_FALSE(found.stopped.empty());
  }
}

TEST(Parameters, WhatDoesNotFitIsRefused) {
  const Problem p = plate();
  OptimizeRequest r = hole({0, 0, 0.15}, {-0.3, -0.3, 0.1}, {0.3, 0.3, 0.3});
  r.method = OptimizeMethod::LevelSet;
  EXPECT_THROW(quietly(p, r), Error);
  r.method = OptimizeMethod::Mma;
  Problem q = p;
  q.element = arnold_winther;
  EXPECT_THROW(quietly(q, r), Error);
  r.design.drawn[0].start[2] = 0.05;
  EXPECT_THROW(quietly(p, r), Error);
  r = hole({0.95, 0, 0.15}, {-0.3, -0.3, 0.1}, {1, 0.3, 0.3});  // crosses the outline
  r.max_iterations = 3;
  const OptimizeResult moved = quietly(p, r);
  EXPECT_EQ(moved.notes.front().rfind("the start was moved to where it can be drawn: hole 'h'", 0), 0u)
      << moved.notes.front();
  EXPECT_LT(moved.history.front().variables[0] + moved.history.front().variables[2], 1 - p.sizing.size / 2);
  r.design.drawn[0].lower[0] = 0.95;  // no way back
  EXPECT_THROW(quietly(p, r), Error);
}

// Two discs at the same place do not know which way to go.
TEST(Parameters, OverlappingStartsAreRepaired) {
  OptimizeRequest r = hole({0.1, 0.1, 0.2}, {-0.6, -0.6, 0.2}, {0.6, 0.6, 0.2});
  for (const char* name : {"g", "k"}) {
    r.design.drawn.push_back(r.design.drawn[0]);
    r.design.drawn.back().name = name;
  }
  r.min_distance = 0.1;
  r.max_iterations = 2;
  const OptimizeResult found = quietly(plate(), r);
  const VectorXd& x = found.history.front().variables;
  for (const auto& [i, k] : {std::pair(0, 3), std::pair(0, 6), std::pair(3, 6)})
    EXPECT_GE((x.segment<2>(i) - x.segment<2>(k)).norm(), 0.4 + 0.1 - 1e-9);
}

// A fixed hole in the middle keeps the drawn one on the side where it begins, which bears more; a start on the other
// side ends where it weakens the plate less.
TEST(Parameters, SeveralStartsFindTheBetterSide) {
  Problem p = plate();
  p.frame.labels.push_back("hole:fixed");
  p.frame.holes = {circle("fixed", Vec2(0, 0), 0.2, static_cast<Index>(p.frame.labels.size()) - 1)};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0, 1 + 0.6 * x.x()); }}};
  OptimizeRequest r = hole({0.6, 0, 0.15}, {-0.7, 0, 0.15}, {0.7, 0, 0.15});
  r.min_distance = 0.1;
  const OptimizeResult alone = quietly(p, r);
  EXPECT_GT(alone.variables[0], 0.4);
  r.starts = 4;
  const OptimizeResult best = quietly(p, r);
  ASSERT_EQ(best.starts.size(), 4u);
  EXPECT_EQ(best.starts[0].from, start_of(r.design));
  EXPECT_LT(best.variables[0], -0.4);
  EXPECT_LT(best.objective, 0.99 * alone.objective);
  EXPECT_EQ(std::ranges::count_if(best.starts, [](const StartTried& t) { return t.in_full; }), 1);
  // The same bits on any number of threads.
  p.threads = 3;
  expect_same(quietly(p, r), best);
}

// Others know the case alone: the start that was found for it comes with the task.
TEST(Parameters, StartsThatAFarmTriesAreTheSame) {
  const Problem p = plate();
  OptimizeRequest r = hole({0.6, 0, 0.15}, {-0.7, -0.5, 0.15}, {0.7, 0.5, 0.3});
  r.starts = 4;
  r.max_iterations = 15;
  const OptimizeRequest as_read = [&] {
    OptimizeRequest read = r;
    read.design.drawn[0].from_map = true;
    read.design.drawn[0].start = Eigen::Vector3d(0, 0, 0.2);
    return read;
  }();
  int asked = 0;
  const TaskPool farm = [&](const std::vector<std::string>& tasks) {
    std::vector<std::string> answers;
    for (const std::string& task : tasks) answers.push_back(try_start(p, as_read, task));
    asked += static_cast<int>(tasks.size());
    return answers;
  };
  const auto go_on = [](const Iterate&) { return true; };
  expect_same(optimize_parameters(p, r, go_on, {}, farm), optimize_parameters(p, r, go_on, {}));
  EXPECT_EQ(asked, 6);  // four, then the better half of them
}

/// Pressed from above; the crack slides against friction, where its faces, which a gap keeps apart, meet.
Problem rubbing(double friction, double gap) {
  Problem p = plate();
  p.scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.05, -1 - 0.2 * x.x()); }}};
  p.frame.cracks = {{"c", {Vec2(-0.1, -0.55), Vec2(0.5, 0.05)}}};
  p.scene.laws = {{.friction = friction}};
  if (gap != 0)
    p.scene.laws[0].gap = [gap](const Vec2& x, const Vec2&) { return Vec2(gap * (0.3 - std::abs(x.x() - 0.2)), 0); };
  return p;
}

// Before anything could be mended the least violated start is the best; what is fixed is fixed in all of them.
TEST(Parameters, OfStartsThatViolateTheLeastViolatedGoesOn) {
  Problem p = everything();
  OptimizeRequest r{.method = OptimizeMethod::Slsqp, .max_iterations = 1};
  Drawn hole = drawn(Drawn::Kind::Circle, "h", Eigen::Vector3d(-1, 0.9, 0.3), 0.25);
  hole.lower[1] = hole.upper[1] = 0.9;
  r.design.drawn = {hole};
  r.starts = 4;
  r.volume_at_most = 0.96;  // a radius of 0.45
  const std::vector<StartTried> tried = try_starts(p, r, start_of(r.design), {});
  ASSERT_EQ(tried.size(), 4u);
  double least = infinity, chosen = nan;
  for (const StartTried& one : tried) {
    EXPECT_EQ(one.from[1], 0.9);
    const double violation = std::max(0.0, (1 - pi * one.from[2] * one.from[2] / 16) / 0.96 - 1);
    EXPECT_NEAR(one.violation, violation, 1e-6);
    least = std::min(least, one.violation);
    if (one.in_full) chosen = one.violation;
  }
  EXPECT_EQ(chosen, least);
}

TEST(Parameters, DerivativesHoldBesideCracksThatSlideOrHaveAGap) {
  for (const auto& [friction, gap] : {std::pair{0.2, 0.0}, {0.0, 0.4}, {0.3, 0.4}, {0.3, -0.2}}) {
    Problem p = rubbing(friction, gap);
    OptimizeRequest request = hole({-0.3, 0.35, 0.2}, {-0.7, 0.1, 0.1}, {0, 0.6, 0.3});
    request.bounds = {{"energy", {"energy", {energy()}}, 1},
                      {"tracking", {"displacement_tracking", {displacement_tracking({}, {})}}, 1},
                      {"opening", {"crack_opening", {crack_opening(0, {})}}, 1}};
    const VectorXd x = start_of(request.design), width = upper_bounds(request.design) - lower_bounds(request.design);
    Evaluations evaluations(p, request);
    EXPECT_FALSE(evaluations.blind());
    evaluations.begin_round();
    const DesignEvaluation start = evaluations.evaluate(x, true);
    ASSERT_EQ(start.evaluation.failure, "") << friction << " " << gap;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const auto at = [&](double t) -> VectorXd {
        return evaluations.evaluate(x + t * width[i] * VectorXd::Unit(x.size(), i), false).evaluation.values.head(4);
      };
      constexpr double step = 1e-4;
      const VectorXd expected = (at(step) - at(-step)) / (2 * step);
      for (Eigen::Index k = 0; k < 4; ++k)
        EXPECT_NEAR(width[i] * start.evaluation.gradients(i, k), expected[k],
                    2e-5 * start.evaluation.gradients.col(k).cwiseProduct(width).cwiseAbs().maxCoeff())
            << friction << " " << gap << " variable " << i << " of " << k;
    }
  }
}

// Two methods, one of which knows nothing of derivatives.
TEST(Parameters, BesideACrackThatSlidesAGradientEndsWhereCobylaDoes) {
  const Problem p = rubbing(0.3, 0);
  OptimizeRequest r = hole({-0.3, 0.35, 0.2}, {-0.6, 0.2, 0.2}, {0.1, 0.5, 0.2});
  const OptimizeResult by_gradient = quietly(p, r);
  r.method = OptimizeMethod::Cobyla;
  const OptimizeResult without = quietly(p, r);
  EXPECT_EQ(by_gradient.ending, Ending::Optimal) << by_gradient.stopped;
  EXPECT_LT(by_gradient.objective, without.objective * (1 + 1e-3));
  EXPECT_NEAR(by_gradient.objective, without.objective, 5e-3 * without.objective);
  EXPECT_LT(by_gradient.objective, 0.995 * by_gradient.history.front().objective);
}

TEST(Parameters, CobylaDoesWithoutDerivatives) {
  Problem p = plate();
  p.element = arnold_winther;
  p.frame.cracks = {{"c", {Vec2(-0.3, 0.6), Vec2(0.3, 0.6)}}};
  p.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  OptimizeRequest r = hole({0.25, -0.2, 0.2}, {-0.4, -0.2, 0.2}, {0.4, -0.2, 0.2});
  r.method = OptimizeMethod::Cobyla;
  const OptimizeResult found = quietly(p, r);
  EXPECT_EQ(found.ending, Ending::Stalled) << found.stopped;  // nothing tells an optimum
  EXPECT_NEAR(found.variables[0], 0, 0.02) << found.stopped;
  EXPECT_TRUE(std::isnan(found.optimality));
}

void expect_same(const OptimizeResult& a, const OptimizeResult& b) {
  EXPECT_EQ(a.variables, b.variables);
  EXPECT_EQ(a.objective, b.objective);
  EXPECT_EQ(a.stopped, b.stopped);
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(a.state_solves, b.state_solves);
  ASSERT_EQ(a.history.size(), b.history.size());
  for (std::size_t i = 0; i < a.history.size(); ++i) {
    EXPECT_EQ(a.history[i].variables, b.history[i].variables) << i;
    EXPECT_EQ(a.history[i].merit, b.history[i].merit) << i;
    EXPECT_EQ(a.history[i].optimality, b.history[i].optimality) << i;
    EXPECT_EQ(a.history[i].step, b.history[i].step) << i;
    EXPECT_EQ(a.history[i].note, b.history[i].note) << i;
    EXPECT_EQ(a.history[i].state_solves, b.history[i].state_solves) << i;
  }
}

TEST(Parameters, KilledAndResumedEndsWithTheSameBits) {
  const test::Folder folder;
  const Least least;
  const auto& [p, r] = least;
  const OptimizeResult whole = quietly(p, r);
  least.expect_kept(whole);
  ASSERT_GT(whole.history.size(), 3u);
  for (const int survive : {1, 3}) {
    CheckpointPlace place{folder.path / fmt::format("checkpoint{}", survive), "case", true};
    const pid_t child = fork();
    if (child == 0) {
      int shown = 0;
      optimize_parameters(
          p, r,
          [&](const Iterate&) {
            if (shown++ == survive) kill(getpid(), SIGKILL);
            return true;
          },
          place);
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    ASSERT_TRUE(std::filesystem::exists(place.path));
    int shown = 0;
    const OptimizeResult resumed = optimize_parameters(
        p, r,
        [&](const Iterate& it) {
          ++shown;
          EXPECT_EQ(it.model.mesh.triangles.size(), static_cast<std::size_t>(it.row.triangles));
          return true;
        },
        place);
    expect_same(resumed, whole);
    EXPECT_EQ(shown, static_cast<int>(whole.history.size()) - survive + 1);
    // Again, from the end: nothing is left to do but to show the best.
    shown = 0;
    expect_same(optimize_parameters(
                    p, r, [&](const Iterate&) { return ++shown > 0; }, place),
                whole);
    EXPECT_EQ(shown, 1);
    place.fingerprint = "another";
    EXPECT_THROW(optimize_parameters(p, r, {}, place), Error);
  }
}

// The comparison of starts is part of the checkpoint.
TEST(Parameters, SeveralStartsStoppedAndResumedEndWithTheSameBits) {
  const test::Folder folder;
  auto [p, r] = Least();
  r.max_iterations = 12;
  r.starts = 3;
  const CheckpointPlace place{folder.path / "checkpoint", "case", false}, stopped{folder.path / "copy", "case", true};
  int shown = 0;
  const OptimizeResult whole = optimize_parameters(
      p, r,
      [&](const Iterate&) {  // as a run that is stopped at its first design leaves it
        if (++shown == 2) std::filesystem::copy_file(place.path, stopped.path);
        return true;
      },
      place);
  ASSERT_GE(shown, 2);
  const OptimizeResult resumed = optimize_parameters(p, r, {}, stopped);
  expect_same(resumed, whole);
  ASSERT_EQ(resumed.starts.size(), whole.starts.size());
  for (std::size_t i = 0; i < whole.starts.size(); ++i) {
    EXPECT_EQ(resumed.starts[i].from, whole.starts[i].from);
    EXPECT_EQ(resumed.starts[i].variables, whole.starts[i].variables);
    EXPECT_EQ(resumed.starts[i].merit, whole.starts[i].merit);
    EXPECT_EQ(resumed.starts[i].in_full, whole.starts[i].in_full);
  }
}

TEST(Parameters, ACheckpointIsLeftAloneWhereNobodyResumes) {
  const test::Folder folder;
  auto [p, r] = Least();
  r.max_iterations = 3;
  CheckpointPlace place{folder.path / "checkpoint", "case", false};
  int shown = 0;
  const auto run = [&] {
    shown = 0;
    return optimize_parameters(
        p, r, [&](const Iterate&) { return ++shown, true; }, place);
  };
  const OptimizeResult first = run();
  EXPECT_GE(shown, static_cast<int>(first.history.size()));
  const int all = shown;
  expect_same(run(), first);
  EXPECT_EQ(shown, all);
  place.resume = true;
  expect_same(run(), first);
  EXPECT_LE(shown, 1);  // the design that it ends with
}

TEST(Parameters, TheObserverStopsIt) {
  const auto [p, r] = Least();
  int shown = 0;
  const OptimizeResult found = optimize_parameters(p, r, [&](const Iterate&) { return ++shown < 2; }, {});
  EXPECT_EQ(found.history.size(), 2u);
  EXPECT_NE(found.ending, Ending::Optimal);
  EXPECT_NE(found.stopped.find("told to stop"), std::string::npos);
}

}  // namespace
}  // namespace kerf::parameters_test
