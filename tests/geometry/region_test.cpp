// Regions of other material in meshes: the areas and rims of circles, ellipses and polygons against those drawn, also
// after refinement and on a background; what cannot be meshed is named.

#include "geometry/adapt.hpp"
#include "geometry/mesher/smooth.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::region_test {
namespace {

Shape square(std::vector<Loop> regions) {
  Shape shape{polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, {}, {"side"}, std::move(regions)};
  return shape;
}

double area_of(const Mesh& m, Index region) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (region_of(m, Index(t)) == region) sum += area(m, Index(t));
  return sum;
}

double interface_length(const Mesh& m) {
  double sum = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (is_interface(m, Index(e))) sum += length(m, Index(e));
  return sum;
}

/// The least and largest distance of the ends of interface edges from a point.
std::array<double, 2> radii(const Mesh& m, const Vec2& center) {
  std::array<double, 2> r{1e9, 0};
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (is_interface(m, Index(e)))
      for (const Index v : m.edges[e]) {
        const double d = (m.points[std::size_t(v)] - center).norm();
        r = {std::min(r[0], d), std::max(r[1], d)};
      }
  return r;
}

TEST(Regions, NoneLeaveTheMeshWithoutNumbers) {
  const Mesh m = triangulate(square({}), {.size = 0.5});
  EXPECT_TRUE(m.region.empty());
  EXPECT_TRUE(refine(m).region.empty());
  EXPECT_EQ(interface_length(m), 0);
}

TEST(Regions, CircleHasItsAreaAndItsRimHasEdges) {
  const Vec2 center(0.3, -0.2);
  const Mesh m = triangulate(square({circle("r", center, 0.7, none)}), {.size = 0.25});
  EXPECT_NEAR(area_of(m, 0), pi * 0.49, 1e-12);
  EXPECT_NEAR(area_of(m, none), 16 - pi * 0.49, 1e-12);
  EXPECT_NEAR(interface_length(m), 2 * pi * 0.7, 0.01 * 2 * pi * 0.7);
  const auto r = radii(m, center);
  EXPECT_NEAR(r[0], r[1], 1e-5);  // steps and with them the factors for the area differ a little
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (is_interface(m, Index(e))) {
      EXPECT_EQ(m.label[e], none);
      EXPECT_EQ(m.crack[e], none);
    }
  EXPECT_GT(quality(m).min_angle_deg, 24.9);
}

TEST(Regions, EllipseAndPolygonOfEitherOrientation) {
  for (const bool reversed : {false, true}) {
    std::vector<Vec2> corners{{-1.5, -1.5}, {-0.5, -1.5}, {-0.5, -0.5}, {-1.5, -0.5}};
    if (reversed) std::reverse(corners.begin(), corners.end());
    const Mesh m = triangulate(square({polygon("p", corners, none), ellipse("e", {0.7, 0.7}, {0.8, 0.3}, 0.4, none)}),
                               {.size = 0.3});
    EXPECT_NEAR(area_of(m, 0), 1, 1e-12);
    EXPECT_NEAR(area_of(m, 1), pi * 0.24, 1e-12);
    for (const Vec2& corner : corners)
      EXPECT_TRUE(std::ranges::any_of(m.points, [&](const Vec2& x) { return (x - corner).norm() < 1e-12; }));
  }
}

TEST(Regions, TheInnerOneOfNestedOnesCounts) {
  for (const bool inner_first : {false, true}) {
    std::vector<Loop> loops{circle("outer", {0, 0}, 1.2, none), circle("inner", {0.2, 0}, 0.5, none)};
    if (inner_first) std::swap(loops[0], loops[1]);
    const Mesh m = triangulate(square(loops), {.size = 0.3});
    EXPECT_NEAR(area_of(m, inner_first ? 0 : 1), pi * 0.25, 1e-12);
    EXPECT_NEAR(area_of(m, inner_first ? 1 : 0), pi * (1.44 - 0.25), 1e-12);
    EXPECT_NEAR(area_of(m, none), 16 - pi * 1.44, 1e-12);
  }
}

TEST(Regions, MayLieAroundHolesAndCracks) {
  Shape shape = square({circle("r", {0, 0}, 1.5, none)});
  shape.holes = {circle("h", {-0.6, 0}, 0.3, 0)};
  shape.cracks = {{"c", {{0.2, 0}, {0.9, 0.3}}, {}}, {"d", {{1.7, -1}, {1.7, 1}}, {}}};
  const Mesh m = triangulate(shape, {.size = 0.3});
  EXPECT_NEAR(area_of(m, 0), pi * (2.25 - 0.09), 1e-12);
  for (const CrackEdge& c : m.cracks[0])
    for (const Index t : m.sides[std::size_t(c.edge)]) EXPECT_EQ(region_of(m, t), 0);
  for (const CrackEdge& c : m.cracks[1])
    for (const Index t : m.sides[std::size_t(c.edge)]) EXPECT_EQ(region_of(m, t), none);
}

TEST(Regions, SmallOnesGetSmallEdges) {
  const Mesh coarse = triangulate(square({circle("r", {0, 0}, 0.02, none)}), {.size = 0.4});
  EXPECT_NEAR(area_of(coarse, 0), pi * 0.0004, 1e-14);
  EXPECT_GT(std::ranges::count(coarse.region, 0), 30);
  const Mesh thin = triangulate(square({ellipse("r", {0, 0}, {1, 0.01}, 0.3, none)}), {.size = 0.4});
  EXPECT_NEAR(area_of(thin, 0), pi * 0.01, 1e-13);
  EXPECT_GT(quality(thin).min_angle_deg, 20);
  // A region that nearly touches another, and one that nearly touches the outline.
  const Mesh gap = triangulate(
      square({circle("r", {0, 0}, 0.5, none), circle("s", {1.02, 0}, 0.5, none), circle("t", {0, 1.48}, 0.5, none)}),
      {.size = 0.4});
  EXPECT_LT(quality(gap).h_min, 0.02);
  EXPECT_GT(quality(gap).min_angle_deg, 20);
}

TEST(Regions, AreKeptByRefinementAndBisection) {
  const Mesh m = triangulate(square({circle("r", {0, 0}, 0.7, none)}), {.size = 0.5});
  const double inside = area_of(m, 0), rim = interface_length(m);
  for (Mesh fine : {refine(m), longest_edges_first(m)}) {
    EXPECT_NEAR(area_of(fine, 0), inside, 1e-12);
    for (int round = 0; round < 3; ++round) {
      fine = longest_edges_first(fine);
      std::vector<Index> marked;
      for (Index t = 0; t < Index(fine.triangles.size()); t += 3) marked.push_back(t);
      fine = bisect(fine, marked);
      EXPECT_EQ(fine.region.size(), fine.triangles.size());
      EXPECT_NEAR(area_of(fine, 0), inside, 1e-12);
      EXPECT_NEAR(interface_length(fine), rim, 1e-12);
    }
    const Smoothed again = smooth(fine, 25, 8);
    const Mesh smoothed = connect(again.points, again.triangles, {}, fine.region);
    EXPECT_NEAR(area_of(smoothed, 0), inside, 1e-12);
    EXPECT_NEAR(interface_length(smoothed), rim, 1e-12);
  }
}

TEST(Regions, AreKeptOnABackground) {
  const Shape shape = square({circle("r", {0, 0}, 0.7, none)});
  const Mesh m = triangulate(shape, {.size = 0.5});
  std::vector<double> size;
  for (const Vec2& x : m.points) size.push_back(0.05 + 0.2 * x.norm());
  const Mesh next = triangulate(shape, {.size = 0.5}, {&m, size});
  EXPECT_NEAR(area_of(next, 0), pi * 0.49, 1e-12);
}

TEST(Regions, ConnectRefusesAnotherNumber) {
  const Mesh m = triangulate(square({}), {.size = 1});
  EXPECT_THROW(connect(m.points, m.triangles, {}, {0, 1}), std::invalid_argument);
}

std::string problem(const Shape& shape) {
  return find_problem(shape).value_or("");
}

TEST(RegionProblems, AreNamed) {
  const std::string apart = "; regions must lie inside the body, apart from its sides and from each other";
  EXPECT_EQ(problem(square({circle("r", {3, 3}, 0.5, none)})), "region 'r' lies outside the outline, at (3.5, 3)");
  EXPECT_EQ(problem(square({circle("r", {1.8, 0}, 0.5, none)})).substr(0, 39),
            "region 'r' crosses the outline at (2, -");
  EXPECT_EQ(problem(square({circle("r", {1.5, 0}, 0.5, none)})), "region 'r' touches the outline at (2, 0)" + apart);
  EXPECT_EQ(problem(square({polygon("r", {{0, 0}, {2, 0}, {3, 1}, {0, 1}}, none)})).substr(0, 30),
            "region 'r' crosses the outline");
  Shape holed = square({circle("r", {0, 0}, 0.5, none)});
  holed.holes = {circle("h", {0, 0}, 1, 0)};
  EXPECT_EQ(problem(holed), "region 'r' lies inside hole 'h'; remove it");
  holed.holes = {circle("h", {0.5, 0}, 0.5, 0)};
  EXPECT_EQ(problem(holed).substr(0, 28), "region 'r' crosses hole 'h' ");
  EXPECT_EQ(problem(square({circle("r", {0, 0}, 0.5, none), circle("s", {0.5, 0}, 0.5, none)})).substr(0, 30),
            "region 's' crosses region 'r' ");
  EXPECT_EQ(problem(square({circle("r", {0, 0}, 0.5, none), circle("s", {0, 0}, 0.5, none)})).substr(0, 31),
            "region 's' overlaps region 'r' ");
  EXPECT_EQ(problem(square({polygon("r", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, none)})),
            "region 'r' crosses itself at (0.5, 0.5); a loop must be simple");
  EXPECT_EQ(problem(square({polygon("r", {{0, 0}, {1, 1}}, none)})),
            "region 'r' has 2 sides; a closed polygon needs at least three");
  EXPECT_EQ(problem(square({circle("r", {0, 0}, -0.0, none)})).substr(0, 24), "side 1 of region 'r' has");
}

}  // namespace
}  // namespace kerf::region_test
