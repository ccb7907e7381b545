// Shapes as polygons and as drawn: areas, bounds on chords and extents against closed forms; every kind of wrong shape
// is named by its message.

#include "kerf/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

namespace kerf::shape_test {
namespace {

double polygon_area(const std::vector<Vec2>& points) {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) twice += cross(points[i], points[(i + 1) % points.size()]);
  return twice / 2;
}

Shape square() {
  return {polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, {}, {"side"}};
}
Shape with_crack(std::vector<Vec2> path) {
  Shape shape = square();
  shape.cracks.push_back({"c", std::move(path)});
  return shape;
}
Shape with_holes(std::vector<Loop> holes) {
  Shape shape = square();
  shape.holes = std::move(holes);
  return shape;
}

TEST(Flatten, KeepsStraightSidesAndLabels) {
  Loop loop = polygon("p", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  for (Index i = 0; i < 4; ++i) loop.sides[std::size_t(i)].label = i;
  const Polygon p = flatten(loop, 0.1, 0.1);
  ASSERT_EQ(p.points.size(), 4u);
  EXPECT_EQ(p.label, (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_DOUBLE_EQ(polygon_area(p.points), 2);
}

TEST(Flatten, TurnsClockwiseLoopsAndTheirLabels) {
  // Side i runs from point i to the next; every piece keeps the label of the side on which it lies.
  Loop loop = polygon("p", {{0, 0}, {0, 1}, {2, 1}, {2, 0}}, 0);
  for (Index i = 0; i < 4; ++i) loop.sides[std::size_t(i)].label = i;  // left, top, right, bottom
  const Polygon p = flatten(loop, 0.1, 0.1);
  EXPECT_DOUBLE_EQ(polygon_area(p.points), 2);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2 middle = (p.points[i] + p.points[(i + 1) % 4]) / 2;
    const Index expected = middle.x() == 0 ? 0 : middle.y() == 1 ? 1 : middle.x() == 2 ? 2 : 3;
    EXPECT_EQ(p.label[i], expected);
  }
}

TEST(Flatten, KeepsChordAndLengthBounds) {
  for (const double chord : {1e-1, 1e-3, 1e-6, 1e-10})
    for (const double longest : {10.0, 0.3}) {
      const Polygon p = flatten(circle("h", {1, 2}, 0.7, 0), chord, longest);
      for (std::size_t i = 0; i < p.points.size(); ++i) {
        const Vec2 &a = p.points[i], &b = p.points[(i + 1) % p.points.size()];
        EXPECT_NEAR((a - Vec2(1, 2)).norm(), 0.7, 1e-14);
        EXPECT_LE(0.7 - ((a + b) / 2 - Vec2(1, 2)).norm(), chord * (1 + 1e-5));
        EXPECT_LE(2 * 0.7 * std::asin((b - a).norm() / 1.4), longest * (1 + 1e-12));
      }
      EXPECT_GT(polygon_area(p.points), 0);
    }
}

TEST(Flatten, TurnsClockwiseArcs) {
  Loop hole = circle("h", {0, 0}, 1, 0);
  std::swap(hole.sides[0].arc->from, hole.sides[0].arc->to);
  EXPECT_GT(polygon_area(flatten(hole, 1e-3, 1).points), 3.1);
}

TEST(Flatten, RefusesEndlessPieces) {
  EXPECT_THROW(flatten(circle("h", {0, 0}, 1, 0), 0, 1), Error);
  EXPECT_THROW(flatten(circle("h", {0, 0}, 1, 0), 1e-30, 1), Error);
}

TEST(Extent, IsTheDiagonal) {
  EXPECT_DOUBLE_EQ(extent(square()), 4 * std::sqrt(2.0));
  Shape disc;
  disc.outline = ellipse("outline", {3, 1}, {2, 1}, pi / 6, 0);
  // Half widths of a turned ellipse: sqrt((a cos)^2 + (b sin)^2).
  const double x = std::hypot(2 * std::cos(pi / 6), std::sin(pi / 6)),
               y = std::hypot(2 * std::sin(pi / 6), std::cos(pi / 6));
  EXPECT_NEAR(extent(disc), 2 * std::hypot(x, y), 1e-12);
}

TEST(FindProblem, AcceptsGoodShapes) {
  EXPECT_EQ(find_problem(square()), std::nullopt);
  EXPECT_EQ(find_problem(with_crack({{-1, 0}, {1, 0}})), std::nullopt);
  EXPECT_EQ(find_problem(with_crack({{-2, 0}, {1, 0}})), std::nullopt);            // from the outline
  EXPECT_EQ(find_problem(with_crack({{-2, 0}, {2, 0.3}})), std::nullopt);          // through the body
  EXPECT_EQ(find_problem(with_crack({{-2, -2}, {0, 0}})), std::nullopt);           // from a corner
  EXPECT_EQ(find_problem(with_crack({{-1, 0}, {0, 0.5}, {1, 0}})), std::nullopt);  // kinked
  EXPECT_EQ(find_problem(with_crack({{-1.9999999, 0}, {1, 0}})), std::nullopt);    // as good as on the outline
  EXPECT_EQ(find_problem(with_holes({circle("h", {0, 0}, 1, 0)})), std::nullopt);
  Shape disc{circle("outline", {0, 0}, 1, 0), {circle("h", {0, 0}, 0.5, 0)}, {}, {"side"}};
  disc.cracks = {{"c", {{0.707107, 0.707107}, {0.353553, 0.353553}}}};  // six decimals
  EXPECT_EQ(find_problem(disc), std::nullopt);
  std::reverse(disc.cracks[0].points.begin(), disc.cracks[0].points.end());
  EXPECT_EQ(find_problem(disc), std::nullopt);
  Shape clockwise = square();
  std::reverse(clockwise.outline.sides.begin(), clockwise.outline.sides.end());
  EXPECT_EQ(find_problem(clockwise), std::nullopt);
  Shape half{
      {"outline", {{{1, 0}, 0, Arc{{0, 0}, Mat2::Identity(), 0, pi}}, {{-1, 0}, 0, std::nullopt}}}, {}, {}, {"s"}};
  EXPECT_EQ(find_problem(half), std::nullopt);
}

struct Bad {
  const char* name;
  Shape shape;
  std::vector<const char*> words;
};

void PrintTo(const Bad& bad, std::ostream* out) {
  *out << bad.name;
}

std::vector<Bad> bad_shapes() {
  constexpr double inf = infinity;
  const auto outline = [](std::vector<Vec2> points) { return Shape{polygon("outline", points, 0), {}, {}, {"side"}}; };
  const auto two_cracks = [](std::vector<Vec2> a, std::vector<Vec2> b) {
    Shape shape = with_crack(std::move(a));
    shape.cracks.push_back({"d", std::move(b)});
    return shape;
  };
  const auto cracked_hole = [](std::vector<Vec2> path) {
    Shape shape = with_holes({circle("h", {0, 0}, 1, 0)});
    shape.cracks.push_back({"c", std::move(path)});
    return shape;
  };
  const auto with_arc = [](const Vec2& center, double radius, double from, double to) {
    Shape shape = square();
    shape.cracks.push_back(arc_crack("c", center, radius, from, to));
    return shape;
  };
  const auto two_arcs = [&](const Vec2& p, double r, double a, double b, const Vec2& q, double s, double c, double d) {
    Shape shape = with_arc(p, r, a, b);
    shape.cracks.push_back(arc_crack("d", q, s, c, d));
    return shape;
  };
  Shape elliptic = with_arc({0, 0}, 1, 0, 1);
  elliptic.cracks[0].arc->axes(1, 1) = 0.5;
  Shape bent_arc = with_arc({0, 0}, 1, 0, 1);
  bent_arc.cracks[0].points.insert(bent_arc.cracks[0].points.begin() + 1, Vec2(1, 0.5));
  Shape moved_arc = with_arc({0, 0}, 1, 0, 1);
  moved_arc.cracks[0].points.back().x() += 0.1;
  Shape short_arc = square();  // of the half circle from (2, -2) to (2, 2) a third is missing
  short_arc.outline.sides[1].arc = Arc{{2, 0}, 2 * Mat2::Identity(), -pi / 2, pi / 6};
  Shape bad_label = square();
  bad_label.outline.sides[2].label = 7;
  Shape open_arc = with_holes({circle("h", {0, 0}, 1, 0)});
  open_arc.holes[0].sides[0].arc->to = 3;
  Shape loose_arc = square();
  loose_arc.outline.sides[1].arc = Arc{{2, 0}, Mat2::Identity(), -1, 1};
  Shape nan_arc = with_holes({circle("h", {0, 0}, nan, 0)});
  Shape far = square();
  for (Side& side : far.outline.sides) side.start += Vec2(1e9, 0);
  return {
      {"empty", {}, {"outline", "no sides"}},
      {"two_sides", outline({{0, 0}, {1, 0}}), {"outline", "at least three"}},
      {"not_a_number", outline({{0, 0}, {1, nan}, {0, 1}}), {"side 2", "outline", "finite"}},
      {"infinite", outline({{0, 0}, {inf, 0}, {0, 1}}), {"side 2", "outline", "finite"}},
      {"huge", outline({{0, 0}, {1e200, 0}, {0, 1}}), {"side 2", "outline", "finite"}},
      {"far", far, {"outline", "origin"}},
      {"label", bad_label, {"side 3", "outline", "label"}},
      {"repeated_point", outline({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), {"side 2", "outline", "zero length", "(1, 0)"}},
      {"one_point", outline({{0, 0}, {0, 0}, {0, 0}}), {"outline", "extent"}},
      {"bow_tie", outline({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), {"outline crosses itself at (0.5, 0.5)"}},
      {"flat", outline({{0, 0}, {1, 0}, {2, 0}}), {"outline", "itself"}},
      {"folded", outline({{0, 0}, {2, 0}, {1, 0}, {1, 1}}), {"outline overlaps itself"}},
      {"touching_itself", outline({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}), {"outline touches itself at (1, 0)"}},
      {"pinched", outline({{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}), {"outline touches itself at (1, 1)"}},
      {"open_arc", open_arc, {"hole 'h'", "does not close"}},
      {"loose_arc", loose_arc, {"side 2", "outline", "arc that starts at"}},
      {"short_arc", short_arc, {"side 2", "outline", "arc that ends at (3.73205, 1) instead of (2, 2)"}},
      {"nan_arc", nan_arc, {"hole 'h'", "finite"}},
      {"zero_radius", with_holes({circle("h", {0, 0}, 0, 0)}), {"hole 'h'", "radius"}},
      {"flat_ellipse", with_holes({ellipse("h", {0, 0}, {1, 0}, 0, 0)}), {"hole 'h'", "radius"}},
      {"hole_outside", with_holes({circle("h", {5, 0}, 1, 0)}), {"hole 'h' lies outside the outline"}},
      {"hole_across", with_holes({circle("h", {2, 0}, 1, 0)}), {"hole 'h' crosses the outline at (2, "}},
      {"hole_around", with_holes({circle("h", {0, 0}, 5, 0)}), {"hole 'h' lies outside the outline"}},
      {"hole_touching", with_holes({circle("h", {1, 0}, 1, 0)}), {"hole 'h'", "the outline at (2, 0)"}},
      {"hole_corner_touching",
       with_holes({polygon("h", {{0, 0}, {1, -1}, {2, 0}, {1, 1}}, 0)}),
       {"hole 'h' touches the outline at (2, 0)"}},
      {"holes_crossing",
       with_holes({circle("a", {0, 0}, 1, 0), circle("b", {1, 0}, 0.5, 0)}),
       {"hole 'b' crosses hole 'a'"}},
      {"holes_equal",
       with_holes({circle("a", {0, 0}, 1, 0), circle("b", {0, 0}, 1, 0)}),
       {"hole 'b' overlaps hole 'a'"}},
      {"hole_in_hole",
       with_holes({circle("a", {0, 0}, 1, 0), circle("b", {0, 0}, 0.5, 0)}),
       {"hole 'b' lies inside hole 'a'"}},
      {"crack_without_points", with_crack({}), {"crack 'c'", "0 points"}},
      {"crack_of_one_point", with_crack({{0, 0}}), {"crack 'c'", "1 point;"}},
      {"crack_nan", with_crack({{0, 0}, {nan, 1}}), {"point 2 of crack 'c'", "finite"}},
      {"crack_repeated_point", with_crack({{0, 0}, {1, 0}, {1, 0}}), {"edge 2 of crack 'c'", "zero length", "(1, 0)"}},
      {"crack_short", with_crack({{0, 0}, {1e-6, 0}}), {"crack 'c' is too short"}},
      {"crack_closed", with_crack({{0, 0}, {1, 0}, {0, 1}, {0, 0}}), {"crack 'c' touches itself at (0, 0)"}},
      {"crack_crossing_itself",
       with_crack({{0, 0}, {1, 0}, {0.5, 0.5}, {0.5, -0.5}}),
       {"crack 'c' crosses itself at (0.5, 0)"}},
      {"crack_folded", with_crack({{0, 0}, {1, 0}, {0.5, 0}}), {"crack 'c' overlaps itself"}},
      {"crack_touching_itself",
       with_crack({{0, 0}, {1, 0}, {0.5, 0.5}, {0.5, 0}}),
       {"crack 'c' touches itself at (0.5, 0)"}},
      {"crack_leaving", with_crack({{0, 0}, {3, 0}}), {"crack 'c' leaves the body at (2, 0)"}},
      {"crack_leaving_a_little", with_crack({{0, 0}, {2.001, 0}}), {"crack 'c' leaves the body at (2, 0)"}},
      {"crack_outside", with_crack({{3, 0}, {4, 0}}), {"crack 'c' lies outside the body"}},
      {"crack_along_the_boundary", with_crack({{-1, -2}, {1, -2}}), {"crack 'c'", "the outline"}},
      {"crack_along_the_boundary_and_off", with_crack({{-1, -2}, {0, -2}, {0, 0}}), {"crack 'c'", "the outline"}},
      {"crack_touching_the_boundary",
       with_crack({{-1, 0}, {0, -2}, {1, 0}}),
       {"crack 'c' touches the outline at (0, -2)"}},
      {"crack_into_hole", cracked_hole({{-1.5, 0}, {0, 0}}), {"crack 'c' crosses hole 'h' at (-1, 0)"}},
      {"crack_through_hole", cracked_hole({{-1.5, 0}, {1.5, 0}}), {"crack 'c' crosses hole 'h'"}},
      {"crack_in_hole", cracked_hole({{-0.5, 0}, {0.5, 0}}), {"crack 'c' lies inside hole 'h'"}},
      {"crack_across_hole", cracked_hole({{-1, 0}, {1, 0}}), {"crack 'c' lies inside hole 'h'"}},
      {"cracks_nearly_parallel",
       two_cracks({{-1, 0}, {1, 0}}, {{-1, -0.01}, {1, 0.01}}),
       {"'c' and 'd' meet at (0, 0) at an angle of 0.57 degrees"}},
      {"crack_meeting_itself_on_another",
       two_cracks({{-1, 0}, {1, 0}, {1, 1}, {0, 1}, {0, -1}}, {{-0.5, -0.5}, {0.5, 0.5}}),
       {"crack 'c' touches itself at (0, 0)"}},
      {"crack_around_and_back",
       two_cracks({{-1, 0}, {1, 0}}, {{0, 0}, {0.5, 1}, {-0.5, 1}, {0, 0}}),
       {"crack 'd' touches itself at (0, 0)"}},
      {"crack_through_a_mouth",
       two_cracks({{-2, 0}, {0, 0}}, {{-3, -1}, {-1, 1}}),
       {"crack 'd' meets the outline at (-2, 0) between its ends"}},
      {"arc_without_radius", with_arc({0, 0}, 0, 0, 1), {"crack 'c'", "radius"}},
      {"arc_nan", with_arc({0, 0}, nan, 0, 1), {"arc of crack 'c'", "finite"}},
      {"arc_flat", with_arc({0, -1e9}, 1e9, 1.57, 1.58), {"crack 'c'", "draw it straight"}},
      {"arc_full", with_arc({0, 0}, 1, 0, 2 * pi), {"crack 'c'", "full circle"}},
      {"arc_beyond", with_arc({0, 0}, 1, 0, 7), {"crack 'c'", "full circle"}},
      {"arc_closing", with_arc({0, 0}, 1, 0, 2 * pi - 1e-6), {"crack 'c' touches itself"}},
      {"arc_short", with_arc({0, 0}, 1, 0, 1e-6), {"crack 'c' is too short"}},
      {"arc_leaving", with_arc({1.5, 0}, 1, 1, 6), {"crack 'c' leaves the body"}},
      {"arc_outside", with_arc({5, 0}, 1, 1, 6), {"crack 'c' lies outside"}},
      {"arc_touching_the_boundary", with_arc({1, 0}, 1, -1, 1), {"crack 'c' touches the outline at (2, "}},
      {"arc_elliptic", elliptic, {"crack 'c'", "no circle"}},
      {"arc_of_three_points", bent_arc, {"crack 'c' is an arc with 3 points; it needs its start and its end"}},
      {"arc_to_elsewhere",
       moved_arc,
       {"crack 'c' has an arc from (1, 0) to (0.540302, 0.841471), but other end points"}},
      {"arcs_overlapping", two_arcs({0, 0}, 1, 0, 2, {0, 0}, 1, 1, 3), {"'c' and 'd' overlap"}},
      {"arcs_tangent", two_arcs({0, 0}, 1, -1, 1, {2, 0}, 1, 2, 4), {"'c' and 'd'"}},
      {"arcs_nearly_tangent", two_arcs({0, 0}, 1, -1, 1, {1.99999, 0}, 1, 2, 4), {"'c' and 'd' touch at (1, "}},
      {"cracks_equal", two_cracks({{-1, 0}, {1, 0}}, {{-1, 0}, {1, 0}}), {"'c' and 'd' overlap"}},
      {"cracks_overlapping", two_cracks({{-1, 0}, {1, 0}}, {{0, 1e-9}, {1.5, 1e-9}}), {"'c' and 'd' overlap"}},
      {"cracks_nearly_equal", two_cracks({{-1, 0}, {1, 0}}, {{-1, 1e-6}, {1, 1e-6}}), {"'c' and 'd' overlap"}},
  };
}

class BadShape : public testing::TestWithParam<Bad> {};

TEST_P(BadShape, IsNamed) {
  const auto problem = find_problem(GetParam().shape);
  ASSERT_TRUE(problem.has_value());
  for (const char* words : GetParam().words) EXPECT_NE(problem->find(words), std::string::npos) << *problem;
}

INSTANTIATE_TEST_SUITE_P(All, BadShape, testing::ValuesIn(bad_shapes()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace kerf::shape_test
