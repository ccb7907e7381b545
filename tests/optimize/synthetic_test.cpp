// Measurements made up from a true body: lines of sensors by hand, noise of the asked size, the misfit of the true
// body. No inverse crime: data of the search's own element differ, and less on finer meshes.

#include "kerf/inverse.hpp"

#include "kerf/analysis.hpp"
#include "kerf/element.hpp"
#include "optimize/inverse/boundary_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace kerf::synthetic_test {
namespace {

// Clamped at the bottom (label 0), pulled at the sides and the top (label 1) of the unit square.
Shape plate() {
  Shape s;
  s.labels = {"bottom", "rest"};
  s.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 1);
  s.outline.sides[0].label = 0;
  return s;
}
Scene pulled() {
  Scene s;
  s.material = plane_stress(1, 0.3);
  s.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  s.tractions = {{1, [](const Vec2& x, const Vec2& n) { return Vec2(0.3 * n.x(), n.y() * (1 + 0.5 * x.x())); }}};
  return s;
}
Synthetic holed(double size = 0.05) {
  Synthetic s{.true_shape = plate(), .true_scene = pulled(), .element = element("p2"), .sizing = {.size = size}};
  s.true_shape.labels.push_back("hole:h");
  s.true_shape.holes = {circle("h", {0.6, 0.55}, 0.12, 2)};
  s.label = 1;
  s.spacing = 0.05;
  return s;
}

TEST(BoundaryLine, SplitsAtCornersAndSharesThem) {
  const BoundaryLine line = boundary_line(plate(), 1);
  ASSERT_EQ(line.curves.size(), 3u);
  EXPECT_EQ(line.joints, 4);
  EXPECT_DOUBLE_EQ(line.length, 3);
  EXPECT_EQ(line.curves[0].joint[1], line.curves[1].joint[0]);
  EXPECT_EQ(line.curves[0].beside[0], 0);
  EXPECT_EQ(line.curves[2].beside[1], 0);
  const Place place = nearest_place(line, {0.3, 1.02});
  EXPECT_EQ(place.curve, 1);
  EXPECT_NEAR(place.arc, 0.7, 1e-14);
  EXPECT_NEAR(place.distance, 0.02, 1e-14);

  Shape ring = plate();
  ring.holes = {circle("h", {0.5, 0.5}, 0.2, 2)};
  const BoundaryLine closed = boundary_line(ring, 2);
  ASSERT_EQ(closed.curves.size(), 1u);
  EXPECT_EQ(closed.curves[0].joint[0], closed.curves[0].joint[1]);
  EXPECT_NEAR(closed.length, 0.4 * M_PI, 1e-3);
  EXPECT_TRUE(boundary_line(plate(), 7).curves.empty());
}

TEST(BoundaryLine, GoesRoundWhereEverySideHasTheLabel) {
  Shape square = plate();
  square.outline.sides[0].label = 1;
  const BoundaryLine line = boundary_line(square, 1);
  ASSERT_EQ(line.curves.size(), 4u);
  EXPECT_EQ(line.joints, 4);
  EXPECT_DOUBLE_EQ(line.length, 4);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(line.curves[i].joint[1], line.curves[(i + 1) % 4].joint[0]) << i;
}

TEST(NormalNumbers, AreTheSameEverywhereAndNormal) {
  const std::vector<double> x = normal_numbers(1, 20000);
  // mt19937 with seed 1 begins with 1791095845, 4282876139 by the standard's generator: fixed numbers.
  const double u1 = 1791095845.5 / 4294967296.0, u2 = 4282876139.5 / 4294967296.0;
  EXPECT_NEAR(x[0], std::sqrt(-2 * std::log(u1)) * std::cos(2 * M_PI * u2), 1e-9);
  double sum = 0, squares = 0, fourth = 0;
  for (const double v : x) sum += v, squares += v * v, fourth += v * v * v * v;
  EXPECT_NEAR(sum / 20000, 0, 0.02);
  EXPECT_NEAR(squares / 20000, 1, 0.03);
  EXPECT_NEAR(fourth / 20000, 3, 0.2);
  EXPECT_NE(normal_numbers(2, 1)[0], x[0]);
}

// No inverse crime: with the true hole, the search's own element and mesh give other displacements, by much more than
// rounding and by less and less on finer meshes (the clamped corners are singular: a bit over first order).
TEST(Measure, DiffersFromTheSearchsOwnDataAndConverges) {
  const Measurement data = measure(holed(0.02));
  ASSERT_EQ(data.at.size(), 61u);
  std::vector<double> away;
  for (const double size : {0.1, 0.05, 0.025}) {
    Synthetic own = holed(size);
    own.element = bdms(1);
    const Measurement other = measure(own);
    double sum = 0;
    for (std::size_t i = 0; i < data.at.size(); ++i) sum += (other.exact[i] - data.exact[i]).squaredNorm();
    away.push_back(std::sqrt(sum / 122) / data.scale);
  }
  EXPECT_GT(away[2], 1e-6);
  EXPECT_LT(away[0], 1e-2);
  EXPECT_LT(away[1], 0.6 * away[0]);
  EXPECT_LT(away[2], 0.7 * away[1]);
}

TEST(Measure, TheFieldGoesThroughTheSensorsAndIsSmoothBetween) {
  Synthetic coarse = holed(), fine = holed();
  fine.spacing = 0.0125;
  const Measurement a = measure(coarse), b = measure(fine);
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    EXPECT_LT((a.field(a.at[i], Vec2::Zero()) - a.displacement[i]).norm(), 1e-12);
    EXPECT_EQ(a.exact[i], a.displacement[i]);  // no noise
  }
  double worst = 0;
  for (int i = 1; i < 100; ++i) {
    const Vec2 x(0.01 * i, 1);
    worst = std::max(worst, (a.field(x, Vec2::Zero()) - b.field(x, Vec2::Zero())).norm());
  }
  EXPECT_LT(worst, 2e-4 * a.scale);
}

TEST(Measure, NoiseHasTheAskedSizeRepeatsAndSparesSupports) {
  Synthetic s = holed(0.1);
  s.spacing = 0.01;
  s.noise = 0.05;
  const Measurement a = measure(s), b = measure(s);
  double sum = 0, mean = 0;
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    EXPECT_EQ(a.displacement[i], b.displacement[i]);
    sum += (a.displacement[i] - a.exact[i]).squaredNorm();
    mean += (a.displacement[i] - a.exact[i]).sum();
  }
  const double count = 2.0 * static_cast<double>(a.at.size());
  EXPECT_NEAR(std::sqrt(sum / count) / a.scale, 0.05, 0.003);
  EXPECT_NEAR(mean / count / a.scale, 0, 0.006);
  // The two ends touch the clamped bottom.
  EXPECT_EQ(a.displacement.front(), a.exact.front());
  EXPECT_EQ(a.displacement.back(), a.exact.back());
  s.seed = 2;
  EXPECT_NE(measure(s).displacement[5], a.displacement[5]);
}

// The misfit of the true body is that of the meshes; noise raises it by its energy; another body has much more.
TEST(Measure, TheMisfitKnowsTheTrueBody) {
  const Synthetic truth = holed(0.04);
  const Measurement data = measure(truth);
  Functional j{"misfit", {misfit(1, {})}};
  j = with_measured(j, 1, data.field);
  const auto value = [&](const Shape& shape) {
    const Model model = prepare(triangulate(shape, {.size = 0.06}), element("bdms"), pulled(), 1);
    const State state = solve(model);
    return analyze(j, model, state, true).value;
  };
  Shape moved = truth.true_shape;
  moved.holes = {circle("h", {0.55, 0.55}, 0.12, 2)};
  const double own = value(truth.true_shape), other = value(moved), none_at_all = value(plate());
  EXPECT_LT(std::abs(own), 0.05 * other);
  EXPECT_LT(other, 0.3 * none_at_all);
}

TEST(Measure, RefusesUnknownLabels) {
  Synthetic s = holed();
  s.label = 9;
  EXPECT_THROW(measure(s), Error);
}

TEST(Measure, SensorsLieAsFarApartAsAsked) {
  Synthetic s = holed();
  s.spacing = 1e-7;
  try {
    measure(s);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "synthetic data: sensors 1e-07 apart are too many; use a larger spacing");
  }
  s.spacing = 0;  // that of the mesh
  s.sizing.size = 0.2;
  const std::size_t by_mesh = measure(s).at.size();
  s.spacing = 0.2;
  EXPECT_EQ(measure(s).at.size(), by_mesh);
  s.spacing = s.sizing.size = 0;  // that of a mesh without a size: a fortieth of the body, on three sides
  EXPECT_EQ(measure(s).at.size(), 3 * static_cast<std::size_t>(std::lround(1 / (extent(s.true_shape) / 40))) + 1);
  s.sizing.size = 0.2;
  s.spacing = 100;  // both ends of every side, and nothing between
  const Measurement ends = measure(s);
  EXPECT_LT(ends.at.size(), by_mesh);
  for (std::size_t i = 0; i < ends.at.size(); ++i)
    EXPECT_LT((ends.field(ends.at[i], Vec2(0, 1)) - ends.displacement[i]).norm(), 1e-12);
}

}  // namespace
}  // namespace kerf::synthetic_test
