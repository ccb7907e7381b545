// Points, segments, polygons and arcs in the plane against answers by hand; on lines and corners the rule for ties
// counts.

#include "geometry/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::plane_test {
namespace {

TEST(Plane, FootsLieOnTheSegment) {
  const Vec2 a(1, 1), b(3, 1);
  EXPECT_EQ(foot({1.5, 7}, a, b), 0.25);
  EXPECT_EQ(foot({0, 2}, a, b), 0);
  EXPECT_EQ(foot({9, 0}, a, b), 1);
  EXPECT_EQ(foot({5, 5}, a, a), 0);
  EXPECT_EQ(distance({2, -1}, a, b), 2);
  EXPECT_EQ(distance({6, 5}, a, b), 5);
  EXPECT_EQ(squared_distance({6, 5}, a, b), 25);
  EXPECT_EQ(distance({4, 5}, a, a), 5);
}

TEST(Plane, SegmentsThatCross) {
  EXPECT_EQ(crossing({0, 0}, {4, 0}, {1, -1}, {1, 2}), 0.25);
  EXPECT_FALSE(crossing({0, 0}, {4, 0}, {5, -1}, {5, 2}));
  EXPECT_FALSE(crossing({0, 0}, {4, 0}, {1, 1}, {1, 2}));
  EXPECT_TRUE(cross_inside({0, 0}, {4, 0}, {1, -1}, {1, 2}));
  EXPECT_FALSE(cross_inside({0, 0}, {4, 0}, {5, -1}, {5, 2}));
}

TEST(Plane, SegmentsThatTouch) {
  // An end on the other line counts as to its right: that of what comes from the left crosses.
  EXPECT_TRUE(crossing({0, 0}, {4, 0}, {1, 0}, {1, 2}));
  EXPECT_FALSE(crossing({0, 0}, {4, 0}, {1, 0}, {1, -2}));
  EXPECT_FALSE(cross_inside({0, 0}, {4, 0}, {1, 0}, {1, 2}));
  EXPECT_FALSE(cross_inside({0, 0}, {4, 0}, {1, 0}, {1, -2}));
}

TEST(Plane, InsideOfAPolygon) {
  const std::vector<Vec2> corner{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const Vec2& x : std::vector<Vec2>{{0.5, 0.5}, {1.5, 0.5}, {0.5, 1.5}}) EXPECT_TRUE(inside(corner, x));
  for (const Vec2& x : std::vector<Vec2>{{1.5, 1.5}, {-1, 1}, {3, 0.5}, {0.5, 3}}) EXPECT_FALSE(inside(corner, x));
  const std::vector<Vec2> turned(corner.rbegin(), corner.rend());
  EXPECT_TRUE(inside(turned, {0.5, 1.5}));
  EXPECT_FALSE(inside(turned, {1.5, 1.5}));
  EXPECT_FALSE(inside(std::vector<Vec2>{}, {0, 0}));
}

TEST(Plane, SidesOfARectangleBelongToOneSideOnly) {
  const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_TRUE(inside(square, {0, 0.5}));   // left
  EXPECT_FALSE(inside(square, {1, 0.5}));  // right
  EXPECT_TRUE(inside(square, {0.5, 0}));   // lower
  EXPECT_FALSE(inside(square, {0.5, 1}));  // upper
  EXPECT_TRUE(inside(square, {0, 0}));
  EXPECT_FALSE(inside(square, {1, 1}));
}

TEST(Plane, SidesInAnyOrderAndHoles) {
  using Sides = std::vector<std::array<Vec2, 2>>;
  const Sides ring{{Vec2(0, 0), Vec2(4, 0)}, {Vec2(4, 4), Vec2(0, 4)}, {Vec2(0, 4), Vec2(0, 0)},
                   {Vec2(4, 0), Vec2(4, 4)}, {Vec2(1, 1), Vec2(3, 1)}, {Vec2(2, 3), Vec2(1, 1)},
                   {Vec2(3, 1), Vec2(2, 3)}};
  EXPECT_TRUE(inside(ring, {0.5, 2}));
  EXPECT_FALSE(inside(ring, {2, 2}));
  EXPECT_FALSE(inside(ring, {5, 2}));
}

TEST(Plane, PointsOfAnArc) {
  const Arc arc{{1, 2}, Mat2{{3, 0}, {0, 2}}, 0, pi / 2};
  const std::vector<Vec2> points = points_on(arc, 3);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_LT((points.front() - Vec2(4, 2)).norm(), 1e-15);
  EXPECT_LT((points.back() - Vec2(1, 4)).norm(), 1e-15);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(parameter(arc, points[i]), double(i) * pi / 6, 1e-15);
    EXPECT_LT((onto(arc, arc.center + 7 * (points[i] - arc.center)) - points[i]).norm(), 1e-14);
  }
  EXPECT_LT((velocity(arc, 0) - Vec2(0, 2)).norm(), 1e-15);
  EXPECT_NEAR(largest_radius(arc), 3, 1e-15);
  EXPECT_NEAR(smallest_radius(arc), 2, 1e-15);
  EXPECT_NEAR(determinant(arc), 6, 1e-15);
  EXPECT_NEAR(length(Arc{{0, 0}, 2 * Mat2::Identity(), 1, -2}), 6, 1e-14);
}

TEST(Plane, DirectionsThatAnArcFaces) {
  const auto on = [](double t) { return Vec2(5 + 2 * std::cos(t), 1 + 2 * std::sin(t)); };
  for (const bool back : {false, true}) {
    const double from = 3, to = 3.5;  // across the jump of atan2
    const Arc arc{{5, 1}, Mat2::Identity(), back ? to : from, back ? from : to};
    EXPECT_TRUE(faces(arc, on(3.2)));
    EXPECT_TRUE(faces(arc, on(3.1)));
    EXPECT_FALSE(faces(arc, on(2.9)));
    EXPECT_FALSE(faces(arc, on(3.6)));
    EXPECT_FALSE(faces(arc, on(0)));
    EXPECT_NEAR(beyond_middle(arc, on(3.25)), 0, 1e-14);
    EXPECT_NEAR(beyond_middle(arc, on(3.45)), 0.2, 1e-14);
    EXPECT_NEAR(beyond_middle(arc, on(2.75)), -0.5, 1e-14);
  }
}

}  // namespace
}  // namespace kerf::plane_test
