// The level set on a mesh: distances, areas and extensions against those of circles and lines, smoothing against an
// eigenfunction, the fixed point against a T that is known.

#include "optimize/level_set/background.hpp"
#include "optimize/level_set/parts.hpp"

#include "kerf/mesher.hpp"
#include "optimize/level_set/dangling.hpp"
#include "optimize/level_set/fixed_point.hpp"
#include "optimize/level_set/nucleate.hpp"
#include "optimize/level_set/regularize.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::background_test {
namespace {

Shape box(double width, double height) {
  Shape s;
  s.labels = {"bottom", "right", "top", "left"};
  s.outline = polygon("outline", {{0, 0}, {width, 0}, {width, height}, {0, height}}, 0);
  for (Index i = 0; i < 4; ++i) s.outline.sides[static_cast<std::size_t>(i)].label = i;
  return s;
}

BackgroundMesh rectangle_mesh(const Solid& solid = {}, const std::optional<Mirror>& mirror = {}, double size = 0.05) {
  return background_mesh(triangulate(box(2, 1), {.size = size}), solid, mirror);
}

Eigen::VectorXd sample(const BackgroundMesh& c, const std::function<double(const Vec2&)>& f) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(c.mesh.points.size()));
  for (std::size_t i = 0; i < c.mesh.points.size(); ++i) v[static_cast<Eigen::Index>(i)] = f(c.mesh.points[i]);
  return v;
}

TEST(BackgroundMesh, DistancesToACircleAreThoseOfTheCircle) {
  const BackgroundMesh c = rectangle_mesh({.held = {0, 1, 2, 3}});  // no rim
  const auto circle_distance = [](const Vec2& x) { return 0.3 - (x - Vec2(1, 0.5)).norm(); };
  // Far from a distance itself: steep on one side.
  const Eigen::VectorXd phi = sample(c, [&](const Vec2& x) {
    const double d = circle_distance(x);
    return d > 0 ? 1.5 * d : d * (1 + d * d);
  });
  const Eigen::VectorXd d = signed_distance(c, phi);
  double worst = 0;
  for (Eigen::Index v = 0; v < d.size(); ++v)
    worst = std::max(worst, std::abs(d[v] - circle_distance(c.mesh.points[static_cast<std::size_t>(v)])));
  // Chords, 0.06^2 / (8 * 0.3), and the kink: between slopes 1 and 1.5 the crossing is off by a tenth of an edge.
  EXPECT_LT(worst, 0.0085);
}

TEST(BackgroundMesh, TheFreeRimIsABoundaryToo) {
  const BackgroundMesh c = rectangle_mesh({.held = {3}});
  const Eigen::VectorXd d = signed_distance(c, Eigen::VectorXd::Constant(c.lumped.size(), -1));
  EXPECT_LT(d.maxCoeff(), 0);                            // it keeps its sign on the rim
  EXPECT_NEAR(value_at(c, d, {1, 0.5}), -0.5, 0.025);    // between two rows of vertices
  EXPECT_NEAR(value_at(c, d, {0.02, 0.5}), -0.5, 0.02);  // the support is no boundary that moves
}

TEST(BackgroundMesh, AreasAreMetByShiftsAndFrozenPartsStay) {
  Solid solid;
  solid.loops = {{polygon("pad", {{0.4, 0.4}, {0.6, 0.4}, {0.6, 0.6}, {0.4, 0.6}}, none), 0}};
  const BackgroundMesh c = rectangle_mesh(solid);
  const Eigen::VectorXd phi = sample(c, [](const Vec2& x) { return std::sin(5 * x.x()) * std::cos(4 * x.y()); });
  for (const double area : {0.3, 0.9, 1.7}) {
    const Eigen::VectorXd shifted = with_area(c, phi, area);
    EXPECT_NEAR(negative_area(c.mesh, shifted), area, 1e-8);
    EXPECT_LT(value_at(c, shifted, {0.5, 0.5}), 0);
  }
  // Less than what is frozen cannot be had.
  EXPECT_NEAR(negative_area(c.mesh, with_area(c, phi, 0.01)), 0.04, 0.01);
}

TEST(BackgroundMesh, MirrorsMakeImagesOfEachOther) {
  const BackgroundMesh c = rectangle_mesh({}, Mirror{{0, 0.5}, {1, 0}});
  const Eigen::VectorXd phi = constrained(c, sample(c, [](const Vec2& x) { return x.x() + x.y() - 1.2; }));
  for (const Vec2& x : {Vec2(0.3, 0.1), Vec2(1.1, 0.35), Vec2(1.7, 0.45)})
    EXPECT_NEAR(value_at(c, phi, x), value_at(c, phi, {x.x(), 1 - x.y()}), 2e-3);
}

TEST(BackgroundMesh, IslandsDoNotCount) {
  const BackgroundMesh c = rectangle_mesh();
  Eigen::VectorXd phi = sample(c, [](const Vec2& x) {
    return std::min(x.x() - 0.8, (x - Vec2(1.5, 0.5)).norm() - 0.2);  // a piece on the left and a disc
  });
  const std::vector<Index> left = {3};
  drop_islands(c, left, phi);
  EXPECT_NEAR(negative_area(c.mesh, phi), 0.8, 1e-9);
  Eigen::VectorXd again = phi;
  drop_islands(c, {}, again);
  EXPECT_EQ(phi, again);
  // Without labels the largest piece stays; with labels that none touches all do.
  const auto pieces = [&] {
    return sample(c, [](const Vec2& x) {
      return std::min((x - Vec2(0.5, 0.5)).norm() - 0.3, (x - Vec2(1.5, 0.5)).norm() - 0.2);
    });
  };
  Eigen::VectorXd two = pieces();
  drop_islands(c, {}, two);
  EXPECT_NEAR(negative_area(c.mesh, two), pi * 0.09, 0.01);
  two = pieces();
  drop_islands(c, left, two);
  EXPECT_EQ(two, pieces());
}

TEST(BackgroundMesh, ExtensionsAreConstantAlongNormals) {
  const BackgroundMesh c = rectangle_mesh();
  std::vector<Vec2> points;
  Eigen::VectorXd values(360);
  for (int i = 0; i < 360; ++i) {
    const double a = i * pi / 180;
    points.emplace_back(1 + 0.3 * std::cos(a), 0.5 + 0.3 * std::sin(a));
    values[i] = std::cos(a);
  }
  const Eigen::VectorXd v = extend(c, points, values);
  for (const double r : {0.2, 0.3, 0.45})
    EXPECT_NEAR(value_at(c, v, {1 + r * std::cos(0.7), 0.5 + r * std::sin(0.7)}), std::cos(0.7), 0.03);
}

TEST(Regularize, ConstantsAreTheirOwnGradients) {
  const BackgroundMesh c = rectangle_mesh();
  const Helmholtz h(c, 0.1);
  EXPECT_LT((h.solve(c.lumped) - Eigen::VectorXd::Ones(c.lumped.size())).cwiseAbs().maxCoeff(), 1e-10);
  // cos(pi x) is an eigenfunction: 1 / (1 + r^2 pi^2).
  const Eigen::VectorXd f = sample(c, [](const Vec2& x) { return std::cos(pi * x.x()); });
  const Eigen::VectorXd v = h.solve(c.lumped.cwiseProduct(f));
  EXPECT_NEAR(value_at(c, v, {0.1, 0.5}), std::cos(0.1 * pi) / (1 + 0.01 * 9.8696), 2e-3);
}

EdgeCurve ring(int n) {
  EdgeCurve curve;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * i / n;
    curve.points.emplace_back(1 + 0.3 * std::cos(a), 0.5 + 0.3 * std::sin(a));
    curve.edges.push_back({i, (i + 1) % n});
  }
  return curve;
}

TEST(Regularize, SmoothingAlongACurveKeepsTheIntegralAndDampsWaves) {
  const int n = 200;
  const EdgeCurve curve = ring(n);
  const double h = (curve.points[1] - curve.points[0]).norm();
  const Eigen::VectorXd length = Eigen::VectorXd::Constant(n, h);
  Eigen::VectorXd value(n);
  for (int i = 0; i < n; ++i) value[i] = 2 + std::cos(10 * 2 * pi * (i + 0.5) / n);
  const Eigen::VectorXd v = smooth_along(curve, length, 0.03, value);
  EXPECT_NEAR(v.mean(), 2, 1e-12);
  EXPECT_NEAR(v.maxCoeff() - 2, 1 / (1 + std::pow(0.03 * 10 / 0.3, 2)), 0.01);
}

TEST(Regularize, ElasticFieldsMoveWithTheSpeeds) {
  const BackgroundMesh c = rectangle_mesh();
  const EdgeCurve curve = ring(80);
  const Eigen::VectorXd d = sample(c, [](const Vec2& x) { return (x - Vec2(1, 0.5)).norm() - 0.3; });
  const ElasticProduct elastic(c, 0.1);
  const Eigen::VectorXd v = elastic.extend(c, curve, Eigen::VectorXd::Constant(80, 0.02), d);
  for (const double a : {0.3, 2.0, 4.4})
    EXPECT_NEAR(value_at(c, v, {1 + 0.3 * std::cos(a), 0.5 + 0.3 * std::sin(a)}), 0.02, 0.003);
  EXPECT_LT(std::abs(value_at(c, v, {1.9, 0.5})), 0.005);  // it decays
}

TEST(FixedPoint, TurnsTowardsTheTopologicalDerivativeAndStopsThere) {
  const BackgroundMesh c = rectangle_mesh();
  const Helmholtz filter(c, 0.02);
  Eigen::VectorXd T(static_cast<Eigen::Index>(c.mesh.triangles.size()));
  for (Index t = 0; t < T.size(); ++t) T[t] = 1 + centroid(c.mesh, t).x();
  Eigen::VectorXd psi = Eigen::VectorXd::Constant(c.lumped.size(), -1);
  double before = 4;
  for (int i = 0; i < 30; ++i) {
    const FixedPoint f = fixed_point(c, filter, {c.mesh, T}, psi, {.share = 0.5, .price = {}, .area = 1.0});
    EXPECT_TRUE(f.angle < before || f.angle < 1e-6);
    before = f.angle;
    psi = f.psi;
    EXPECT_NEAR(f.multiplier, 2, 0.03);  // T at x = 1, where half of the body is
  }
  EXPECT_LT(before, 1e-4);
  EXPECT_LT(value_at(c, psi, {1.5, 0.5}), 0);  // material where T is large
  EXPECT_GT(value_at(c, psi, {0.5, 0.5}), 0);
}

TEST(Nucleation, TakesTheLeastDerivativesThatHaveRoom) {
  const BackgroundMesh c = rectangle_mesh();
  const Eigen::VectorXd d = signed_distance(c, Eigen::VectorXd::Constant(c.lumped.size(), -1));
  Eigen::VectorXd T(static_cast<Eigen::Index>(c.mesh.triangles.size()));
  for (Index t = 0; t < T.size(); ++t) T[t] = (centroid(c.mesh, t) - Vec2(0.6, 0.5)).norm();
  // Without c2 as large as there is room.
  const auto first = [&](const Vec2& x) { return HoleTerms{.T = (x - Vec2(0.6, 0.5)).norm()}; };
  const std::vector<Disc> discs =
      places_to_nucleate(c, d, {c.mesh, T, first}, {.multiplier = 0.35, .area = 1, .least = 0.05, .most = 0.08});
  ASSERT_GE(discs.size(), 2u);
  EXPECT_LT((discs[0].center - Vec2(0.6, 0.5)).norm(), 0.05);
  EXPECT_DOUBLE_EQ(discs[0].radius, 0.08);
  for (std::size_t i = 0; i < discs.size(); ++i) {
    EXPECT_LT((discs[i].center - Vec2(0.6, 0.5)).norm(), 0.35);
    EXPECT_GE(discs[i].radius, 0.05);
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GT((discs[i].center - discs[k].center).norm(), discs[k].radius + 3 * discs[i].radius - 1e-12);
  }
  EXPECT_TRUE(
      places_to_nucleate(c, d, {c.mesh, T, first}, {.multiplier = 0, .area = 1, .least = 0.05, .most = 0.08}).empty());
}

/// Signed distance to rectangles {low, high}, the union.
double to_bars(const Vec2& x, const std::vector<std::array<Vec2, 2>>& bars) {
  double least = infinity;
  for (const auto& [low, high] : bars) {
    const Vec2 middle = 0.5 * (low + high), away = (x - middle).cwiseAbs() - 0.5 * (high - low);
    least = std::min(least, std::min(away.maxCoeff(), 0.0) + away.cwiseMax(0).norm());
  }
  return least;
}

TEST(BackgroundMesh, WhatHangsOnAThinNeckAndBearsNothingGoes) {
  const BackgroundMesh c = rectangle_mesh({.held = {3}}, {}, 0.02);
  const std::vector<Index> bearing{3, 1};  // left and right
  Eigen::VectorXd phi = sample(c, [](const Vec2& x) {
    return to_bars(x, {{{{0, 0.3}, {1.2, 0.5}}},     // thick, from the support
                       {{{1.2, 0.38}, {2, 0.42}}},   // thin, to the load: stays
                       {{{0.2, 0.5}, {0.24, 0.9}}},  // a mast
                       {{{0.6, 0.5}, {0.64, 0.7}}},  // a stalk
                       {{{0.5, 0.7}, {0.74, 0.9}}},  // with a blob
                       {{{0.3, 0.1}, {0.34, 0.3}}},  // a handle
                       {{{0.3, 0.08}, {0.9, 0.12}}},
                       {{{0.86, 0.1}, {0.9, 0.3}}}});
  });
  const Eigen::VectorXd before = phi;
  drop_dangling(c, bearing, 0.04, phi);
  const auto there = [&](const Vec2& x) { return value_at(c, phi, x) < 0; };
  EXPECT_FALSE(there({0.22, 0.8}));
  EXPECT_FALSE(there({0.62, 0.8}));
  EXPECT_FALSE(there({0.62, 0.62}));
  EXPECT_TRUE(there({0.6, 0.4}));
  EXPECT_TRUE(there({1.6, 0.4}));
  EXPECT_TRUE(there({1.95, 0.4}));
  EXPECT_TRUE(there({0.6, 0.1}));
  EXPECT_TRUE(there({0.32, 0.2}));
  // Once is enough, and where nothing hangs nothing changes.
  Eigen::VectorXd again = phi;
  drop_dangling(c, bearing, 0.04, again);
  EXPECT_EQ(again, phi);
  // Without a neck that is thin it stays.
  Eigen::VectorXd thick = before;
  drop_dangling(c, bearing, 0.015, thick);
  EXPECT_EQ(thick, before);
}

}  // namespace
}  // namespace kerf::background_test
