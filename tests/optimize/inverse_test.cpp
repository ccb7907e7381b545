// What is hidden in a body, found from measurements on its boundary; holes that hold a crack back.

#include "tests/optimize/inverse.hpp"
#include "geometry/plane.hpp"
#include "kerf/analysis.hpp"
#include "kerf/element.hpp"
#include "kerf/inverse.hpp"
#include "kerf/optimize.hpp"
#include "kerf/recover.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::inverse_test {
namespace {

using inverse::Plate;

struct Search {
  InitialGuess start;
  std::vector<Identified> guess, found;
  OptimizeResult result;
};
Search search(const Plate& plate, const Design& design) {
  const Problem p = plate.problem();
  const Synthetic truth = plate.truth();
  OptimizeRequest r{
      .method = OptimizeMethod::Slsqp, .max_iterations = 40, .tolerance = 0.01, .min_distance = 0.02, .design = design};
  Search s;
  s.start = initial_guess(p, design, r.min_distance);
  r.design = s.start.design;
  s.guess = identified(r.design, start_of(r.design), p, truth);
  s.result = optimize_parameters(p, r, {}, {});
  s.found = identified(r.design, s.result.variables, p, truth);
  return s;
}

// Without noise what is left is the discretization: a hundredth of the mesh size. The map alone starts it near there.
TEST(Inverse, FindsAHoleToASmallPartOfTheMeshSize) {
  Plate plate;
  plate.holes = {{{0.62, 0.57}, 0.08}};
  const Search s = search(plate, {{plate.circle("h")}});
  ASSERT_EQ(s.start.guesses.size(), 1u);
  const Guess& guess = s.start.guesses[0];
  EXPECT_LT((guess.at - Vec2(0.62, 0.57)).norm(), 0.002);
  EXPECT_NEAR(guess.size, 0.08, 0.001);
  EXPECT_EQ(s.start.design.drawn[0].start, Eigen::Vector3d(guess.at.x(), guess.at.y(), guess.size));
  EXPECT_GT(s.start.explained, 0.99);
  ASSERT_EQ(s.found.size(), 1u);
  EXPECT_LT(s.found[0].position_error, 0.01 * plate.size);
  EXPECT_LT(std::abs(s.found[0].size_error), 0.005 * plate.size);
  EXPECT_LT(s.found[0].position_error, s.guess[0].position_error);
  EXPECT_EQ(s.found[0].truth, "hole 'true'");
  EXPECT_LT(s.result.objective, s.result.history.front().objective);
}

TEST(Inverse, FindsAHoleThroughNoise) {
  Plate plate;
  plate.holes = {{{0.62, 0.57}, 0.08}};
  plate.noise = 0.01;
  const Search s = search(plate, {{plate.circle("h")}});
  EXPECT_LT((s.start.guesses[0].at - Vec2(0.62, 0.57)).norm(), 0.02);
  EXPECT_LT(s.found[0].position_error, 0.3 * plate.size);
  EXPECT_LT(std::abs(s.found[0].size_error), 0.1 * plate.size);
}

// Its faces are in contact in the data and in the search, and open under the loads.
TEST(Inverse, FindsTheEndsOfACrack) {
  Plate plate;
  plate.cracks = {{Vec2(0.45, 0.45), Vec2(0.62, 0.52)}};
  const Search s = search(plate, {{plate.crack("c")}});
  const Eigen::Vector4d start = s.start.design.drawn[0].start;
  EXPECT_LT((start - Eigen::Vector4d(0.45, 0.45, 0.62, 0.52)).norm(), 0.002);
  ASSERT_EQ(s.found.size(), 1u);
  EXPECT_LT(s.found[0].position_error, 0.02 * plate.size);
  EXPECT_LT(std::abs(s.found[0].size_error), 0.02 * plate.size);
}

TEST(Identified, NamesPairsAndErrors) {
  Plate plate;
  plate.holes = {{{0.3, 0.65}, 0.07}, {{0.7, 0.4}, 0.09}};
  plate.cracks = {{Vec2(0.4, 0.2), Vec2(0.5, 0.2)}};
  plate.inclusions = {{{0.8, 0.8}, 0.1}};
  Synthetic truth = plate.truth();
  truth.true_shape.holes[0].name = "first";
  Design d{{plate.circle("a"), plate.circle("b"), plate.circle("more"), plate.crack("c"), plate.region("r", 1, 10)}};
  Eigen::VectorXd x(17);
  x << 0.71, 0.4, 0.1, 0.3, 0.63, 0.07, 0.5, 0.5, 0.05, 0.5, 0.21, 0.4, 0.2, 0.8, 0.77, 0.1, 6;
  const std::vector<Identified> all = identified(d, x, plate.frame(), truth);
  ASSERT_EQ(all.size(), 5u);
  EXPECT_NEAR(all[0].position_error, 0.01, 1e-6);
  EXPECT_NEAR(all[0].size_error, 0.01, 1e-5);
  EXPECT_EQ(all[1].truth, "hole 'first'");
  EXPECT_NEAR(all[1].position_error, 0.02, 1e-6);
  EXPECT_EQ(all[2].truth, "");
  // The true crack is turned round.
  EXPECT_EQ(all[3].exact, Eigen::Vector4d(0.5, 0.2, 0.4, 0.2));
  EXPECT_NEAR(all[3].position_error, 0.01, 1e-12);
  EXPECT_NEAR(all[3].size_error, std::hypot(0.1, 0.01) - 0.1, 1e-12);
  EXPECT_NEAR(all[4].found[3], 6, 1e-12);
  EXPECT_NEAR(all[4].exact[3], 5, 1e-12);
  EXPECT_NE(in_words(all[4]).find("young by +1"), std::string::npos) << in_words(all[4]);
  EXPECT_NE(in_words(all[2]).find("nothing true"), std::string::npos) << in_words(all[2]);
  EXPECT_EQ(in_words(all[0]),
            "hole 'a': center (0.71, 0.4), radius 0.1; true hole 'true': center (0.7, 0.4), radius 0.09; off by 0.01, "
            "radius by +0.01");
  EXPECT_EQ(in_words(all[3]),
            "crack 'c': (0.5, 0.21) to (0.4, 0.2); true crack 'true': (0.5, 0.2) to (0.4, 0.2); off by 0.01, length by "
            "+0.000499");
}

/// What is no circle is compared by its area and its centroid.
TEST(Identified, OtherShapesCountAsCircles) {
  Plate plate;
  plate.holes = {{{0.3, 0.3}, 0.1}};
  Synthetic truth = plate.truth();
  truth.true_shape.holes = {polygon("square", {{0.2, 0.2}, {0.4, 0.2}, {0.4, 0.4}, {0.2, 0.4}}, 2),
                            polygon("triangle", {{0.6, 0.6}, {0.6, 0.9}, {0.9, 0.6}}, 2)};
  Design d{{plate.circle("a"), plate.circle("b")}};
  d.drawn[1].kind = Drawn::Kind::Ellipse;
  for (auto* v : {&d.drawn[1].lower, &d.drawn[1].upper, &d.drawn[1].start})
    *v = (Eigen::VectorXd(5) << 0.7, 0.7, 0.1, 0.05, 0.5).finished();
  Eigen::VectorXd x(8);
  x << 0.3, 0.3, 0.1, 0.7, 0.7, 0.1, 0.05, 0.5;
  const std::vector<Identified> all = identified(d, x, plate.frame(), truth);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].truth, "hole 'square'");
  EXPECT_NEAR(all[0].position_error, 0, 1e-12);
  EXPECT_NEAR(all[0].size_error, 0.1 - 0.2 / std::sqrt(pi), 1e-12);
  EXPECT_EQ(all[1].truth, "hole 'triangle'");
  EXPECT_NEAR(all[1].position_error, 0, 1e-9);
  EXPECT_NEAR(all[1].size_error, std::sqrt(0.005) - std::sqrt(0.045 / pi), 1e-9);
  // In plane stress Young's modulus is told by other constants.
  Problem thin = plate.frame();
  thin.plane_strain = false;
  truth.true_shape.holes.clear();
  truth.true_shape.regions = {circle("r", {0.5, 0.5}, 0.1, none)};
  truth.true_scene.regions = {plane_stress(7, 0.25)};
  const Design stiff{{plate.region("s", 1, 10)}};
  const std::vector<Identified> region = identified(stiff, Eigen::Vector4d(0.5, 0.5, 0.1, 6), thin, truth);
  EXPECT_NEAR(region[0].exact[3], 7, 1e-12);
  EXPECT_NEAR(region[0].found[3], 6, 1e-12);
}

// G of the right tip of a crack whose left part is closed falls by more than 40 % when two holes may take 2.5 % of the
// plate; so a finer mesh says, too. Distances, area, stiffness and the ring are respected, and so is contact.
TEST(CrackArrest, HolesLowerTheEnergyReleaseRate) {
  Problem p;
  p.frame.labels = {"bottom", "right", "top", "left"};
  p.frame.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  for (Index i = 0; i < 4; ++i) p.frame.outline.sides[static_cast<std::size_t>(i)].label = i;
  p.frame.cracks = {{"c", {Vec2(-1, 0), Vec2(1, 0)}, {}}};
  p.scene.material = plane_strain(1000, 0.3);
  p.scene.laws.resize(1);
  p.scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0, 0.1 + x.x()); }}};
  p.sizing = {.size = 0.25, .crack_tip_size = 0.02};
  p.objective = {"energy_release_rate", {energy_release_rate({1, 0}, {1, 0}, {0.08, 0.25}, {})}};
  OptimizeRequest r{.method = OptimizeMethod::Slsqp, .max_iterations = 40, .tolerance = 0.01, .min_distance = 0.1};
  Functional area{"sum", {volume()}};
  area.terms[0].factor = -1;
  r.bounds = {{"area", area, -15.6}, {"compliance", {"compliance", {compliance()}}, 0.0206}};
  Drawn hole{.name = "a"};
  hole.lower = Eigen::Vector3d(-1.7, -1.7, 0.08);
  hole.upper = Eigen::Vector3d(1.7, 1.7, 0.35);
  hole.start = 0.5 * (hole.lower + hole.upper);
  hole.from_map = true;
  r.design.drawn = {hole, hole};
  r.design.drawn[1].name = "b";
  r.design = initial_guess(p, r.design, r.min_distance).design;
  const OptimizeResult result = optimize_parameters(p, r, {}, {});
  EXPECT_TRUE(result.feasible) << result.stopped;

  const auto on_finer = [&](const Shape& shape, const Scene& scene) {
    const Model m = prepare(triangulate(shape, {.size = 0.12, .crack_tip_size = 0.01}), element("bdms"), scene, 1);
    const State s = solve(m);
    double closed = 0, tension = 0;
    for (const CrackPoint& point : crack_profile(m, s, 0)) {
      if (point.status == CrackPoint::Status::Closed) closed += point.length;
      tension = std::max(tension, point.sigma_n);
      EXPECT_GE(point.jump_n, 0);
    }
    EXPECT_GT(closed, 0.2);
    EXPECT_EQ(tension, 0);
    return analyze(p.objective, m, s, true).value;
  };
  const double before = on_finer(p.frame, p.scene), after = on_finer(result.shape, result.scene);
  EXPECT_LT(after, 0.6 * before);
  EXPECT_NEAR(after, result.objective, 0.02 * after);
  const Eigen::VectorXd& x = result.variables;
  const Vec2 a = x.segment<2>(0), b = x.segment<2>(3);
  const double tolerance = 1e-5;
  EXPECT_LE(pi * (x[2] * x[2] + x[5] * x[5]), 0.4 * (1 + 1e-4));
  EXPECT_GE((a - b).norm() - x[2] - x[5], 0.1 - tolerance);
  for (const auto& [center, radius] : {std::pair(a, x[2]), std::pair(b, x[5])}) {
    EXPECT_GE(distance(center, {-1, 0}, {1, 0}) - radius, 0.1 - tolerance);
    EXPECT_GE((center - Vec2(1, 0)).norm() - radius, 0.25 - tolerance);
  }
}

}  // namespace
}  // namespace kerf::inverse_test
