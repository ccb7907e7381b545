// What is drawn: what an initial guess makes of it, the constraints of long cracks, and distances on the inner side of
// boundaries.

#include "optimize/parametric/distance.hpp"
#include "optimize/parametric/shapes/shape.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::drawn_shapes_test {
namespace {

using namespace scenes;
using Eigen::VectorXd;

Vec2 middle(const VectorXd& xy) {
  Vec2 sum = Vec2::Zero();
  for (Eigen::Index i = 0; i < xy.size(); i += 2) sum += xy.segment<2>(i);
  return 2 * sum / double(xy.size());
}

TEST(Guesses, AreOfTheSizeAndAtThePlaceThatIsFound) {
  const Problem p = everything();
  const Vec2 at(0.3, -0.2);
  for (const Drawn& d : everything_drawn().drawn) {
    const DrawnShape& shape = shape_of(d);
    const Sought s = shape.seek(d, p);
    EXPECT_LT(s.least, s.size) << d.name;
    EXPECT_LT(s.size, s.most) << d.name;
    EXPECT_TRUE((s.low.array() <= s.high.array()).all()) << d.name;
    ASSERT_FALSE(s.variants.empty()) << d.name;
    const Guess g{.at = at, .size = 0.2, .angle = pi / 3};
    const VectorXd v = shape.guessed(g, d);
    ASSERT_EQ(v.size(), d.start.size()) << d.name;
    EXPECT_FALSE(shape.guess_in_words(g).empty());
    if (d.kind == Drawn::Kind::Spline || d.kind == Drawn::Kind::Crack) {
      EXPECT_LT((middle(v) - at).norm(), 1e-12) << d.name;
    } else {
      EXPECT_EQ(Vec2(v.head<2>()), at) << d.name;
      EXPECT_EQ(v[2], 0.2) << d.name;
    }
  }
}

TEST(Guesses, OfEllipsesAreRoundAndKeepTheirAngle) {
  const Drawn d = everything_drawn().drawn[1];
  const VectorXd v = ellipse_shape.guessed({.at = {0, 0}, .size = 0.2}, d);
  EXPECT_EQ(v[3], 0.2);
  EXPECT_EQ(v[4], d.start[4]);
  const Sought s = ellipse_shape.seek(d, everything());  // semi-axes 0.25 to 0.55 and 0.1 to 0.4
  EXPECT_NEAR(s.least, std::sqrt(0.25 * 0.1), 1e-12);
  EXPECT_NEAR(s.most, std::sqrt(0.55 * 0.4), 1e-12);
  EXPECT_EQ(s.low, Vec2(d.lower.head<2>()));
  EXPECT_EQ(s.high, Vec2(d.upper.head<2>()));
}

TEST(Guesses, OfSplinesAreSimilar) {
  const Drawn d = everything_drawn().drawn[2];
  const auto mean_radius = [](const VectorXd& v) {
    double sum = 0;
    for (Eigen::Index i = 0; i < v.size(); i += 2) sum += (v.segment<2>(i) - middle(v)).norm();
    return 2 * sum / double(v.size());
  };
  const VectorXd v = spline_shape.guessed({.at = {0.5, 0.5}, .size = 0.25}, d);
  EXPECT_NEAR(mean_radius(v), 0.25, 1e-12);
  const double factor = 0.25 / mean_radius(d.start);
  for (Eigen::Index i = 0; i + 2 < v.size(); i += 2)
    EXPECT_LT(
        (v.segment<2>(i + 2) - v.segment<2>(i) - factor * (d.start.segment<2>(i + 2) - d.start.segment<2>(i))).norm(),
        1e-12);
  const Sought s = spline_shape.seek(d, everything());
  EXPECT_NEAR(s.size, mean_radius(d.start), 1e-12);
  EXPECT_LT((s.low - middle(d.lower)).norm() + (s.high - middle(d.upper)).norm(), 1e-12);
}

/// Straight, half as long as the size says on either side, and in the direction that the boxes of its ends suit.
TEST(Guesses, OfCracksAreStraight) {
  Drawn d = drawn(Drawn::Kind::Crack, "c", (VectorXd(6) << -0.5, 0, 0, 0, 0.5, 0).finished(), 0.2);
  for (const double sign : {1., -1.}) {
    const VectorXd v = crack_shape.guessed({.at = {0, 0}, .size = 0.5, .angle = 0}, d);
    EXPECT_LT((Vec2(v.head<2>()) - Vec2(-0.5 * sign, 0)).norm(), 1e-12);
    EXPECT_LT(Vec2(v.segment<2>(2)).norm(), 1e-12);
    EXPECT_LT((Vec2(v.tail<2>()) - Vec2(0.5 * sign, 0)).norm(), 1e-12);
    d.start = -d.start;  // from the other end
    d.lower = d.start.array() - 0.2;
    d.upper = d.start.array() + 0.2;
  }
}

double value(const std::vector<Constraint>& all, const std::string& name, const VectorXd& v, VectorXd* by = nullptr) {
  for (const Constraint& c : all)
    if (c.name.find(name) != std::string::npos) return c.value(v, by);
  ADD_FAILURE() << name;
  return nan;
}

/// A U of three edges: 1 wide, its arms 0.6 and 0.6 long, and 1 apart.
TEST(LongCracks, EdgesStayApartAndDoNotFold) {
  const VectorXd u = (VectorXd(8) << 0, 0.6, 0, 0, 1, 0, 1, 0.6).finished();
  const Drawn d = drawn(Drawn::Kind::Crack, "c", u, 0.3);
  std::vector<Constraint> all;
  crack_shape.constrain(d, 0, 0.1, all);
  EXPECT_EQ(all.size(), 3u + 2 + 1);  // lengths, turns, one pair of edges that do not meet
  EXPECT_NEAR(value(all, "edge 1 of crack 'c' is shorter than 0.1", u), 1 - 6, 1e-12);
  EXPECT_NEAR(value(all, "edge 2 of crack 'c' is shorter than 0.1", u), 1 - 10, 1e-12);
  EXPECT_NEAR(value(all, "crack 'c' folds at its point 2", u), -0.5, 1e-12);  // a right angle: cosine 0
  EXPECT_NEAR(value(all, "edges 1 and 3 of crack 'c' are less than 0.1 apart", u), 1 - 10, 0.1);
  VectorXd closing = u;  // the arms lean towards one another, their ends 0.05 apart
  closing[0] = 0.475;
  closing[6] = 0.525;
  EXPECT_GT(value(all, "edges 1 and 3", closing), 0.5);
  VectorXd folded = u;  // back along itself
  folded.tail<2>() = Vec2(0.1, 0.02);
  EXPECT_NEAR(value(all, "folds at its point 3", folded), -0.5 + 0.9 / std::hypot(0.9, 0.02), 1e-12);
  VectorXd point = u;  // an edge without length
  point.segment<2>(2) = point.head<2>();
  EXPECT_EQ(value(all, "edge 1 of crack 'c' is shorter", point), 1);
  for (const VectorXd& v : {u, closing, folded})
    for (const Constraint& c : all) {
      VectorXd by = VectorXd::Zero(8);
      c.value(v, &by);
      for (Eigen::Index i = 0; i < 8; ++i) {
        VectorXd a = v, b = v;
        a[i] += 1e-6;
        b[i] -= 1e-6;
        EXPECT_NEAR(by[i], (c.value(a, nullptr) - c.value(b, nullptr)) / 2e-6, 1e-6 * (1 + by.norm())) << c.name << i;
      }
    }
}

/// Next to an end that does not move, what may touch something else there is left out.
TEST(LongCracks, FixedEndsMayTouch) {
  Drawn d = drawn(Drawn::Kind::Crack, "c", (VectorXd(4) << 0, 0, 1, 0).finished(), 0.3);
  const auto points = [&](bool cut) { return crack_shape.boundary(d, d.start, cut).points; };
  const std::vector<Vec2> whole = points(false);
  EXPECT_EQ(whole.front(), Vec2(0, 0));
  EXPECT_EQ(whole.back(), Vec2(1, 0));
  EXPECT_EQ(points(true).size(), whole.size());  // both ends move
  d.lower.head<2>() = d.upper.head<2>() = d.start.head<2>();
  EXPECT_GT(points(true).front().x(), 0.1);
  EXPECT_EQ(points(true).back(), Vec2(1, 0));
  d.lower.tail<2>() = d.upper.tail<2>() = d.start.tail<2>();
  EXPECT_LT(points(true).back().x(), 0.9);
  EXPECT_EQ(crack_shape.boundary(d, d.start, true).by.size(), points(true).size());
}

/// Of a square of side 2 h, as a polyline.
DesignCurve square_around(const Vec2& center, double h) {
  return fixed_polyline({center + Vec2(-h, -h), center + Vec2(h, -h), center + Vec2(h, h), center + Vec2(-h, h)}, true);
}

TEST(Distances, InsideAndOutside) {
  const double width = 1e-4;
  const auto between = [&](const DesignCurve& a, const DesignCurve& b, bool container) {
    return distance_between(a, b, {.container = container, .width = width}).value;
  };
  const DesignCurve disc = fixed_disc({0.5, 0}, 0.25), large = fixed_disc({0, 0}, 2), box = square_around({0, 0}, 1),
                    far = square_around({4, 0}, 1);
  EXPECT_NEAR(between(disc, large, true), 2 - 0.75, 1e-12);
  EXPECT_NEAR(between(disc, fixed_disc({2, 0}, 0.5), false), 0.75, 1e-12);
  EXPECT_NEAR(between(disc, box, true), 0.25, 10 * width);
  EXPECT_NEAR(between(box, large, true), 2 - std::sqrt(2), 10 * width);
  EXPECT_NEAR(between(box, fixed_disc({3, 0}, 0.5), false), 1.5, 10 * width);
  EXPECT_NEAR(between(fixed_disc({3, 0}, 0.5), box, false), 1.5, 10 * width);
  EXPECT_NEAR(between(box, far, false), 2, 10 * width);
  EXPECT_NEAR(between(box, square_around({0, 0}, 3), true), 2, 10 * width);
  // Soft minima are never above.
  EXPECT_LE(between(box, large, true), 2 - std::sqrt(2));
  EXPECT_LE(between(box, far, false), 2);
  // Where one point is the other's there is a way out all the same.
  EXPECT_NEAR(between(disc, fixed_disc({0.5, 0}, 0.5), false), -0.75, 1e-12);
  EXPECT_NEAR(between(disc, fixed_disc({0.5, 0}, 0.5), true), 0.25, 1e-12);
  EXPECT_NEAR(between(fixed_polyline({{0, 0}, {0.1, 0}}, false), large, true), 1.9, 10 * width);
  for (const Vec2& x : {Vec2(0, 0), Vec2(0.5, 0.5)}) {
    const SegmentFoot on = segment_foot(x, {0, 0}, {1, 1});
    EXPECT_EQ(on.distance, 0);
    EXPECT_NEAR(on.normal.norm(), 1, 1e-15);
    EXPECT_NEAR(on.normal.dot(Vec2(1, 1)), 0, 1e-15);
  }
  EXPECT_EQ(segment_foot({2, 3}, {2, 3}, {2, 3}).normal.norm(), 1);
  EXPECT_DOUBLE_EQ(segment_foot({2, 5}, {2, 3}, {2, 3}).distance, 2);
  // A corner that has left, and what overlaps.
  EXPECT_LT(between(box, fixed_disc({0, 0}, 1.2), true), 0);
  EXPECT_LT(between(disc, fixed_disc({0.6, 0}, 0.25), false), 0);
}

}  // namespace
}  // namespace kerf::drawn_shapes_test
