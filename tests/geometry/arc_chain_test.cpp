// Chains of arcs and their fit to points: knots and tangents meet, derivatives against differences, areas and distances
// of circles, ellipses and |x|^4 + |y|^4 = 1 against closed forms, the nearest place against all places.

#include "geometry/arc_chain.hpp"

#include "geometry/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::arc_chain_test {

namespace {

ArcChain wavy(bool closed) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> some(-0.15, 0.15);
  ArcChain chain;
  chain.closed = closed;
  for (int k = 0; k < 7; ++k) {
    const double t = 2 * pi * k / 7;
    chain.knots.push_back({{2 * std::cos(t) + some(random), std::sin(t) + some(random)},
                           std::atan2(std::cos(t), -2 * std::sin(t)) + some(random)});
  }
  return chain;
}

ChainTrace trace_of(const std::function<Vec2(double)>& curve, int n) {
  ChainTrace trace{{}, true, {}};
  for (int k = 0; k < n; ++k) trace.points.push_back(curve(2 * pi * k / n));
  return trace;
}

double area_of(const ArcChain& chain) {
  Shape shape;
  shape.outline = {"outline", sides(chain, 0)};
  shape.labels = {"l"};
  EXPECT_FALSE(find_problem(shape)) << *find_problem(shape);
  return area(shape);
}

}  // namespace

TEST(ArcChain, HasNoCornersAndMeetsItsKnots) {
  for (const bool closed : {true, false}) {
    const ArcChain chain = wavy(closed);
    const std::size_t arcs = 2 * segment_count(chain);
    for (std::size_t k = 0; k < arcs; ++k) {
      const ChainPoint from = point_on(chain, {k, 0});
      if (k % 2 == 0) {
        const Knot& knot = chain.knots[k / 2];
        EXPECT_LT((from.at - knot.at).norm(), 1e-14);
        EXPECT_LT((from.tangent - Vec2(std::cos(knot.angle), std::sin(knot.angle))).norm(), 1e-12);
      }
      if (k + 1 == arcs && !closed) break;
      const ChainPoint to = point_on(chain, {k, 1}), next = point_on(chain, {(k + 1) % arcs, 0});
      EXPECT_LT((to.at - next.at).norm(), 1e-13);
      EXPECT_LT((to.tangent - next.tangent).norm(), 1e-12);
    }
  }
}

TEST(ArcChain, DerivativesAreThoseOfDifferences) {
  const ArcChain chain = wavy(true);
  for (const ChainPlace place : {ChainPlace{4, 0.3}, ChainPlace{5, 0.8}}) {
    const ChainPoint p = point_on(chain, place);
    for (int k = 0; k < 6; ++k) {
      const double step = 1e-6;
      std::array<ChainPoint, 2> side;
      for (const int s : {0, 1}) {
        ArcChain other = chain;
        Knot& knot = other.knots[std::size_t(k < 3 ? 2 : 3)];
        (k % 3 == 2 ? knot.angle : knot.at[k % 3]) += (2 * s - 1) * step;
        side[std::size_t(s)] = point_on(other, place);
      }
      EXPECT_LT(((side[1].at - side[0].at) / (2 * step) - p.by.col(k)).norm(), 1e-8);
      EXPECT_NEAR((side[1].curvature - side[0].curvature) / (2 * step), p.bends[k], 1e-7);
    }
  }
}

TEST(ArcChain, StraightLinesAndCirclesAreExact) {
  ArcChain line{{{{0, 0}, std::atan2(1, 2)}, {{2, 1}, std::atan2(1, 2)}}, false};
  EXPECT_LT((at(line, {1, 0.5}) - Vec2(1.5, 0.75)).norm(), 1e-14);
  EXPECT_FALSE(sides(line, 0)[0].arc);
  ArcChain circle{{}, true};
  for (int k = 0; k < 3; ++k) circle.knots.push_back({{std::cos(2 * k), std::sin(2 * k)}, 2 * k + pi / 2});
  for (std::size_t arc = 0; arc < 6; ++arc)
    for (const double part : {0.0, 0.3, 1.0}) EXPECT_NEAR(at(circle, {arc, part}).norm(), 1, 1e-14);
  EXPECT_NEAR(length(circle), 2 * pi, 1e-13);
  EXPECT_NEAR(area_of(circle), pi, 1e-13);
}

TEST(ArcChain, TheNearestPlaceIsTheFootOfAPerpendicular) {
  const ArcChain chain = wavy(true);
  for (const Vec2& x : {Vec2(1.5, 0.9), Vec2(-0.3, 0.4), Vec2(0, -2)}) {
    const ChainPoint p = point_on(chain, nearest(chain, std::array{x})[0]);
    double least = infinity;
    for (std::size_t arc = 0; arc < 14; ++arc)
      for (int i = 0; i <= 200; ++i) least = std::min(least, (at(chain, {arc, i / 200.0}) - x).norm());
    EXPECT_LE((p.at - x).norm(), least + 1e-12);
    EXPECT_NEAR(p.tangent.dot(p.at - x), 0, 1e-10);
  }
}

TEST(ArcChain, WhatIsTooFarToBeNearestIsRightlyLeftOut) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> some(-3, 3);
  for (const bool closed : {true, false}) {
    const ArcChain chain = wavy(closed);
    std::vector<Vec2> points;
    for (int k = 0; k < 200; ++k) points.emplace_back(some(random), some(random));
    const std::vector<ChainPlace> places = nearest(chain, points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const ChainPlace all = nearest(chain, points[k], 0, segment_count(chain));
      EXPECT_EQ(places[k].arc, all.arc);
      EXPECT_EQ(places[k].part, all.part);
    }
  }
}

TEST(FitArcs, CurvesTakeFewKnotsWithinTheTolerance) {
  struct Case {
    std::function<Vec2(double)> curve;
    double area;
    std::size_t most;
  };
  // The rounded square is |x|^4 + |y|^4 = 1, of area Gamma(1/4)^2 / (2 sqrt(pi)).
  const double quartic = std::pow(std::tgamma(0.25), 2) / (2 * std::sqrt(pi));
  const auto rounded = [](double t) {
    const Vec2 u(std::cos(t), std::sin(t));
    return Vec2(u / std::pow(std::pow(u.x(), 4) + std::pow(u.y(), 4), 0.25));
  };
  for (const double unit : {1.0, 1e-3}) {
    for (const Case& c :
         {Case{[](double t) { return Vec2(std::cos(t), std::sin(t)); }, pi, 6},
          Case{[](double t) { return Vec2(2 * std::cos(t), std::sin(t)); }, 2 * pi, 12}, Case{rounded, quartic, 12}}) {
      const Fitted fit =
          fit_arcs(trace_of([&](double t) { return Vec2(unit * c.curve(t)); }, 120), {0.01 * unit, 0.1 * unit});
      EXPECT_LE(fit.chain.knots.size(), c.most);
      EXPECT_LE(fit.distance, 0.0101 * unit);
      double farthest = 0;
      for (int k = 0; k < 1000; ++k) {
        const Vec2 x = unit * c.curve(2 * pi * k / 1000);
        farthest = std::max(farthest, (at(fit.chain, nearest(fit.chain, std::array{x})[0]) - x).norm());
      }
      EXPECT_LE(farthest, 0.012 * unit);
      EXPECT_NEAR(area_of(fit.chain), c.area * unit * unit, 0.01 * c.area * unit * unit);
    }
  }
}

TEST(FitArcs, PinnedPointsAreMetExactly) {
  ChainTrace trace{{}, false, {}};
  for (int k = 0; k <= 40; ++k) trace.points.push_back({0.05 * k, 0.2 * std::sin(0.15 * k)});
  trace.pinned.assign(41, false);
  trace.pinned[17] = true;
  const Fitted fit = fit_arcs(trace, {0.003, 0.05});
  EXPECT_EQ(fit.chain.knots.front().at, trace.points.front());
  EXPECT_EQ(fit.chain.knots.back().at, trace.points.back());
  const auto pin = std::find(fit.point.begin(), fit.point.end(), 17);
  ASSERT_NE(pin, fit.point.end());
  EXPECT_EQ(fit.chain.knots[std::size_t(pin - fit.point.begin())].at, trace.points[17]);
  EXPECT_LE(fit.distance, 0.003);
}

TEST(Circular, PartsOfEllipsesBecomeArcs) {
  Loop half = ellipse("h", {0, 0}, {2, 1}, 0, 0);
  half.sides.front().arc->to = pi;
  half.sides.push_back({{-2, 0}, 0, std::nullopt});
  Shape shape;
  shape.outline = half;
  shape.labels = {"l"};
  const Shape arcs = circular(shape, 1e-4);
  EXPECT_FALSE(find_problem(arcs));
  EXPECT_NEAR(area(arcs), pi, 1e-3);
  for (const Side& side : arcs.outline.sides)
    if (side.arc) {
      EXPECT_NEAR(smallest_radius(*side.arc), largest_radius(*side.arc), 1e-12);
    }
}

}  // namespace kerf::arc_chain_test
