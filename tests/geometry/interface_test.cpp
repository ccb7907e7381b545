// Regions that touch, and the cracks along their borders.

#include "geometry/interfaces.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::interface_test {
namespace {

double area_of(const Mesh& m, Index region) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (region_of(m, Index(t)) == region) sum += area(m, Index(t));
  return sum;
}

double length_of(const Mesh& m, Index crack) {
  double sum = 0;
  for (const CrackEdge& c : m.cracks[std::size_t(crack)]) sum += length(m, c.edge);
  return sum;
}

double length_of_label(const Mesh& m, Index label) {
  double sum = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (m.label[e] == label) sum += length(m, Index(e));
  return sum;
}

/// The vertices along a crack.
std::vector<Index> path(const Mesh& m, Index crack) {
  std::vector<Index> v;
  for (const CrackEdge& c : m.cracks[std::size_t(crack)]) {
    const auto& [a, b] = m.edges[std::size_t(c.edge)];
    if (v.empty()) v.push_back(c.forward ? a : b);
    EXPECT_EQ(v.back(), c.forward ? a : b) << "not in the order of the path";
    v.push_back(c.forward ? b : a);
  }
  return v;
}

/// Every interface as a crack, as a case file reads it.
void add(Shape& shape, const char* name, Index region, Index other) {
  for (Crack crack : seams(shape, region, other)) {
    crack.name = name;
    shape.cracks.push_back(std::move(crack));
  }
}

/// Every edge between the two, and no other, is one of the crack, the region on its left.
void expect_border(const Mesh& m, Index crack, Index region, Index other) {
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    const auto [left, right] = m.sides[e];
    if (left == none || right == none) continue;
    EXPECT_EQ(std::minmax(region_of(m, left), region_of(m, right)) == std::minmax(region, other), m.crack[e] == crack);
  }
  for (const CrackEdge& c : m.cracks[std::size_t(crack)])
    EXPECT_EQ(region_of(m, m.sides[std::size_t(c.edge)][c.forward ? 0 : 1]), region);
}

Shape rectangle(std::vector<Loop> regions) {
  return {polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0), {}, {}, {"side"}, std::move(regions)};
}

Loop box(const char* name, double x, double y, double to_x, double to_y) {
  return polygon(name, {{x, y}, {to_x, y}, {to_x, to_y}, {x, to_y}}, none);
}

TEST(Interfaces, AreClosedAroundADisc) {
  Shape shape = rectangle({circle("disc", {0.8, 0.5}, 0.3, none)});
  add(shape, "fit", 0, none);
  ASSERT_EQ(shape.cracks.size(), 1u);
  EXPECT_LT((shape.cracks[0].points.front() - shape.cracks[0].points.back()).norm(), 1e-15);
  for (const bool curved : {false, true}) {
    const Mesh m = triangulate(shape, {.size = 0.1, .curved = curved});
    const std::vector<Index> along = path(m, 0);
    EXPECT_EQ(along.front(), along.back());
    for (const Index v : along) EXPECT_NEAR((m.points[std::size_t(v)] - Vec2(0.8, 0.5)).norm(), 0.3, 1e-14);
    expect_border(m, 0, 0, none);
    EXPECT_EQ(std::ranges::any_of(
                  m.cracks[0], [&](const CrackEdge& c) { return m.arc.empty() || m.arc[std::size_t(c.edge)] == none; }),
              !curved);
    EXPECT_GT(quality(m).h_min, 0.02) << "no tips, no short edges";
    const Corners corners = split_at_cracks(m);
    EXPECT_EQ(corners.vertex.size(), m.points.size() + along.size() - 1) << "two corners at every vertex of it";
  }
}

TEST(Interfaces, EndOnTheOutlineInALayeredStrip) {
  Shape shape = rectangle({box("upper", 0, 0.4, 2, 1)});
  add(shape, "joint", 0, none);
  const Mesh m = triangulate(shape, {.size = 0.1});
  EXPECT_NEAR(area_of(m, 0), 1.2, 1e-12);
  EXPECT_NEAR(area_of(m, none), 0.8, 1e-12);
  EXPECT_NEAR(length_of(m, 0), 2, 1e-12);
  EXPECT_NEAR(length_of_label(m, 0), 6, 1e-12);
  expect_border(m, 0, 0, none);
}

// A strip in the middle of the body has two borders with it.
TEST(Interfaces, HaveAPartPerCurve) {
  Shape shape = rectangle({box("middle", 0.5, 0, 1.25, 1)});
  add(shape, "joint", 0, none);
  ASSERT_EQ(shape.cracks.size(), 2u);
  const Mesh m = triangulate(shape, {.size = 0.1});
  EXPECT_NEAR(area_of(m, 0), 0.75, 1e-12);
  EXPECT_NEAR(length_of(m, 0), 1, 1e-12);
  EXPECT_NEAR(length_of(m, 1), 1, 1e-12);
}

TEST(Interfaces, MeetWhereThreeRegionsDo) {
  // A lies left of B and C, C on top of B; the sides of A are longer.
  Shape shape = rectangle({box("A", 0, 0, 1, 1), box("B", 1, 0, 2, 0.5), box("C", 1, 0.5, 2, 1)});
  add(shape, "ab", 0, 1);
  add(shape, "ac", 0, 2);
  add(shape, "bc", 1, 2);
  EXPECT_TRUE(seams(shape, 0, none).empty()) << "nothing is left of the body";
  const Mesh m = triangulate(shape, {.size = 0.1});
  for (const Index region : {0, 1, 2}) EXPECT_NEAR(area_of(m, region), region == 0 ? 1 : 0.5, 1e-12);
  expect_border(m, 0, 0, 1);
  expect_border(m, 1, 0, 2);
  expect_border(m, 2, 1, 2);
  EXPECT_NEAR(length_of(m, 0) + length_of(m, 1), 1, 1e-12);
}

TEST(Interfaces, LeaveOtherBordersBonded) {
  Shape shape = rectangle({box("A", 0, 0, 1, 1), box("B", 1, 0, 2, 0.5), circle("C", {0.5, 0.5}, 0.2, none)});
  add(shape, "ab", 0, 1);
  const Mesh m = triangulate(shape, {.size = 0.1});
  EXPECT_NEAR(length_of(m, 0), 0.5, 1e-12);
  EXPECT_NEAR(area_of(m, 2), pi * 0.04, 1e-12);
  EXPECT_NEAR(area_of(m, 0), 1 - pi * 0.04, 1e-12);
  EXPECT_NEAR(area_of(m, none), 0.5, 1e-12);
}

// A quarter of a disc in a quarter of a ring: the region shares two sides with the outline, its third is an arc.
TEST(Interfaces, FollowArcsToTheOutline) {
  const auto quarter = [](const char* name, double r, Index label) {
    return Loop{name,
                {{{0, 0}, label, {}},
                 {{r, 0}, label, Arc{Vec2::Zero(), r * Mat2::Identity(), 0, pi / 2}},
                 {{0, r}, label, {}}}};
  };
  Shape shape{quarter("outline", 1, 0), {}, {}, {"side"}, {quarter("disc", 0.6, none)}};
  add(shape, "fit", 0, none);
  const Mesh m = triangulate(shape, {.size = 0.1, .curved = true});
  const std::vector<Index> along = path(m, 0);
  EXPECT_LT((m.points[std::size_t(along.front())] - Vec2(0.6, 0)).norm(), 1e-15);
  EXPECT_LT((m.points[std::size_t(along.back())] - Vec2(0, 0.6)).norm(), 1e-15);
  for (const Index v : along) EXPECT_NEAR(m.points[std::size_t(v)].norm(), 0.6, 1e-14);
  for (const CrackEdge& c : m.cracks[0]) EXPECT_NE(m.arc[std::size_t(c.edge)], none);
  expect_border(m, 0, 0, none);
}

// Lines and arcs in turn: a crack for each, which share their ends and have no tips.
TEST(Interfaces, ChangeBetweenLinesAndArcs) {
  const auto side = [](double x, double y, std::optional<Arc> arc = {}) { return Side{{x, y}, none, arc}; };
  const auto turn = [](double x, double from) { return Arc{{x, 0.5}, 0.25 * Mat2::Identity(), from, from + pi}; };
  // A slot: two half circles and two lines.
  Loop slot{
      "slot",
      {side(0.5, 0.25), side(1.5, 0.25, turn(1.5, -pi / 2)), side(1.5, 0.75), side(0.5, 0.75, turn(0.5, pi / 2))}};
  Shape shape = rectangle({slot});
  add(shape, "fit", 0, none);
  ASSERT_EQ(shape.cracks.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT((shape.cracks[k].points.back() - shape.cracks[(k + 1) % 4].points.front()).norm(), 1e-14);
  const Mesh m = triangulate(shape, {.size = 0.1});
  double total = 0;
  for (const Index c : {0, 1, 2, 3}) total += length_of(m, c);
  EXPECT_NEAR(total, 2 + 2 * pi * 0.25, 0.01);
  EXPECT_GT(quality(m).h_min, 0.01);
}

TEST(Interfaces, AreRefusedWhereRegionsAreWrong) {
  const auto problem = [](std::vector<Loop> regions, std::vector<Vec2> path) {
    Shape shape = rectangle(std::move(regions));
    shape.cracks.push_back({"i", std::move(path), {}});
    return find_problem(shape).value_or("");
  };
  const std::vector<Vec2> middle{{0, 0.5}, {2, 0.5}};
  EXPECT_EQ(problem({box("A", 0, 0.5, 2, 1)}, middle), "");
  EXPECT_EQ(problem({box("A", 0, 0.5, 3, 1)}, middle).substr(0, 30), "region 'A' crosses the outline");
  EXPECT_EQ(problem({box("A", 0, 0.5, 3, 1)}, {{0.5, 0.2}, {1, 0.2}}).substr(0, 30), "region 'A' crosses the outline");
  const Loop bulge = polygon("A", {{0, 0.5}, {2, 0.5}, {3, 0.75}, {2, 1}, {0, 1}}, none);
  EXPECT_EQ(problem({bulge}, middle).substr(0, 28), "region 'A' leaves the body a");
  EXPECT_EQ(problem({box("A", 0, 0, 1, 1), box("B", 0.5, 0, 1.5, 1)}, {{1, 0}, {1, 1}}).substr(0, 28),
            "regions 'A' and 'B' overlap;");
  EXPECT_EQ(problem({box("A", 0, 0, 1, 1), box("B", 0, 0, 1, 1)}, {{1, 0}, {1, 1}}).substr(0, 28),
            "regions 'A' and 'B' overlap;");
  EXPECT_EQ(problem({box("A", 0, 0, 1, 1)}, {{0, 0}, {1, 0}}),
            "crack 'i' runs along the outline at (0, 0); it must lie inside the body");
}

// Bonded borders alone: layers, a region in the corner of the body, one around half of a hole.
TEST(TouchingRegions, NeedNoInterface) {
  const Mesh layers = triangulate(rectangle({box("A", 0, 0.5, 2, 1), box("B", 0, 0.25, 2, 0.5)}), {.size = 0.2});
  EXPECT_NEAR(area_of(layers, 0), 1, 1e-12);
  EXPECT_NEAR(area_of(layers, 1), 0.5, 1e-12);
  EXPECT_NEAR(area_of(layers, none), 0.5, 1e-12);
  EXPECT_NEAR(length_of_label(layers, 0), 6, 1e-12);
  EXPECT_TRUE(regions_touch(rectangle({box("A", 0, 0.5, 2, 1)})));
  EXPECT_FALSE(regions_touch(rectangle({box("A", 0.1, 0.5, 1.9, 0.9)})));
  Shape holed = rectangle({box("A", 0, 0, 1, 1)});
  holed.holes = {box("h", 1, 0.25, 1.25, 0.75)};
  for (Side& side : holed.holes[0].sides) side.label = 0;
  EXPECT_NEAR(area_of(triangulate(holed, {.size = 0.2}), 0), 1, 1e-12);
  // A crack across the layers, from the outline.
  Shape cracked = rectangle({box("A", 0, 0.5, 2, 1)});
  cracked.cracks = {{"c", {{0.7, 0}, {0.9, 0.8}}, {}}};
  const Mesh m = triangulate(cracked, {.size = 0.2});
  EXPECT_NEAR(length_of(m, 0), path_length(cracked.cracks[0]), 1e-12);
  EXPECT_NEAR(area_of(m, 0), 1, 1e-12);
}

}  // namespace
}  // namespace kerf::interface_test
