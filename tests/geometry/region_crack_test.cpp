// Cracks that cross the borders of regions, or end on them: random polylines and arcs against random regions, by what
// every mesh of them must keep; places and angles that are told apart.

#include "geometry/interfaces.hpp"
#include "geometry/plane.hpp"
#include "geometry/shape/drawing.hpp"
#include "kerf/mesher.hpp"
#include "tests/support/dice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace kerf::region_crack_test {
namespace {

Shape square(std::vector<Loop> regions, std::vector<Crack> cracks) {
  return {
      polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, std::move(cracks), {"side"}, std::move(regions)};
}

double area_of(const Mesh& m, Index region) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (region_of(m, Index(t)) == region) sum += area(m, Index(t));
  return sum;
}

double crack_length(const Mesh& m, Index crack) {
  double sum = 0;
  for (const CrackEdge& c : m.cracks[std::size_t(crack)]) sum += length(m, c.edge);
  return sum;
}

/// Vertices of a crack, in the order of its path, which must hang together.
std::vector<Index> path(const Mesh& m, Index crack) {
  std::vector<Index> v;
  for (const CrackEdge& c : m.cracks[std::size_t(crack)]) {
    const auto& [a, b] = m.edges[std::size_t(c.edge)];
    if (v.empty()) v.push_back(c.forward ? a : b);
    EXPECT_EQ(v.back(), c.forward ? a : b);
    v.push_back(c.forward ? b : a);
  }
  return v;
}

std::set<Index> on_borders(const Mesh& m) {
  std::set<Index> v;
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (is_interface(m, Index(e))) v.insert(m.edges[e].begin(), m.edges[e].end());
  return v;
}

bool has_vertex(const Mesh& m, const std::set<Index>& among, const Vec2& x, double within) {
  return std::ranges::any_of(among, [&](Index v) { return (m.points[std::size_t(v)] - x).norm() <= within; });
}

TEST(RegionCracks, CrossAPolygonAtVerticesOfBoth) {
  const Shape shape = square({polygon("stiff", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, none)},
                             {{"c", {{-1.5, 0.2}, {0.3, 0.2}, {0.6, 1.4}}, {}}});
  const Mesh m = triangulate(shape, {.size = 0.3});
  EXPECT_NEAR(area_of(m, 0), 4, 1e-12);
  EXPECT_NEAR(area_of(m, none), 12, 1e-12);
  EXPECT_NEAR(crack_length(m, 0), path_length(shape.cracks[0]), 1e-12);
  std::set<Index> on_both;
  const std::set<Index> border = on_borders(m);
  for (const Index v : path(m, 0))
    if (border.contains(v)) on_both.insert(v);
  EXPECT_EQ(on_both.size(), 2u);
  EXPECT_TRUE(has_vertex(m, on_both, {-1, 0.2}, 1e-14));
  EXPECT_TRUE(has_vertex(m, on_both, {0.5, 1}, 1e-14));
}

// A line or an arc across a circle or an ellipse, whole and made of two arcs, curved edges or not.
TEST(RegionCracks, CrossCurvedBorders) {
  const auto arc = [](double radius, double from, double to) { return arc_crack("c", {0, -2}, radius, from, to); };
  for (const bool curved : {false, true})
    for (const Loop& region : {circle("r", {0.1, 0}, 0.8, none), ellipse("r", {0.1, 0}, {1.1, 0.5}, 0.7, none)})
      for (const Crack& crack : {Crack{"c", {{-1.5, 0.3}, {1.5, -0.2}}, {}}, arc(2.2, 0.25 * pi, 0.75 * pi)}) {
        const Mesh m = triangulate(square({region}, {crack}), {.size = 0.2, .curved = curved});
        const Arc& border = *region.sides[0].arc;
        const double whole = pi * std::abs(determinant(border));
        if (!curved) {
          EXPECT_NEAR(area_of(m, 0), whole, 2e-4 * whole);
        }
        const std::set<Index> on = on_borders(m);
        std::vector<Vec2> both;
        for (const Index v : path(m, 0))
          if (on.contains(v)) both.push_back(m.points[std::size_t(v)]);
        ASSERT_EQ(both.size(), 2u);
        for (const Vec2& x : both) {
          EXPECT_LT((x - onto(border, x)).norm(), 1e-12);
          if (crack.arc)
            EXPECT_NEAR((x - crack.arc->center).norm(), 2.2, 1e-12);
          else
            EXPECT_LT(distance(x, crack.points[0], crack.points[1]), 1e-12);
        }
        for (const CrackEdge& c : m.cracks[0]) {
          const auto& [left, right] = m.sides[std::size_t(c.edge)];
          EXPECT_EQ(region_of(m, left), region_of(m, right)) << "both faces are of one material";
        }
      }
}

TEST(RegionCracks, EndAndBeginOnABorder) {
  const Loop box = polygon("box", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, none);
  for (const Vec2& end : {Vec2(1, 0), Vec2(1 + 1e-7, 0.1), Vec2(1, 1)}) {  // on a side, nearly so, at a corner
    const Mesh m = triangulate(square({box}, {{"c", {{0, 0}, end}, {}}}), {.size = 0.3});
    EXPECT_NEAR(area_of(m, 0), 4, 1e-6);
    const std::set<Index> border = on_borders(m);
    const std::vector<Index> v = path(m, 0);
    EXPECT_TRUE(border.contains(v.back()));
    EXPECT_EQ(std::ranges::count_if(v, [&](Index i) { return border.contains(i); }), 1);
  }
  const Mesh disc =
      triangulate(square({circle("disc", {0, 0}, 1, none)}, {{"c", {{0, 1}, {0, 1.8}}, {}}}), {.size = 0.3});
  EXPECT_NEAR(area_of(disc, 0), pi, 1e-3);
  EXPECT_TRUE(on_borders(disc).contains(path(disc, 0).front()));
  EXPECT_LT(quality(disc).h_min, 0.01) << "stresses are singular there, too";
}

// The seam of a circle at (1, 0) is no corner, wherever a crack comes by.
TEST(RegionCracks, CrossAtTheSeamOfACircle) {
  for (const double y : {0.0, 1e-9, -1e-9, 1e-7, 1e-3}) {
    const Mesh m =
        triangulate(square({circle("disc", {0, 0}, 1, none)}, {{"c", {{0.2, y}, {1.8, y}}, {}}}), {.size = 0.3});
    EXPECT_NEAR(area_of(m, 0), pi, 2e-3) << y;
    EXPECT_NEAR(crack_length(m, 0), 1.6, 1e-12) << y;
    EXPECT_GT(quality(m).min_angle_deg, 20) << y;
  }
}

// Two cracks that cross on a border; one that ends on the other there; a kink on it.
TEST(RegionCracks, JunctionsOnABorder) {
  const Loop box = polygon("box", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, none);
  const auto meshed = [&](std::vector<Crack> cracks) {
    Mesh m = triangulate(square({box}, std::move(cracks)), {.size = 0.3});
    EXPECT_NEAR(area_of(m, 0), 4, 1e-12);
    EXPECT_EQ(std::ranges::count(m.points, Vec2(1, 0)), 1);
    return m;
  };
  const Mesh cross = meshed({{"c", {{0.5, 0}, {1.5, 0}}, {}}, {"d", {{0.5, -0.5}, {1.5, 0.5}}, {}}});
  EXPECT_NEAR(crack_length(cross, 1), std::sqrt(2), 1e-12);
  meshed({{"c", {{0.5, 0}, {1, 0}}, {}}, {"d", {{0.5, -0.5}, {1.5, 0.5}}, {}}});
  const Mesh kink = meshed({{"c", {{0.5, 0.5}, {1, 0}, {0.5, -0.5}}, {}}});
  for (const CrackEdge& c : kink.cracks[0]) EXPECT_EQ(region_of(kink, kink.sides[std::size_t(c.edge)][0]), 0);
}

TEST(RegionCracks, AreFoundByOptimization) {
  const Loop disc = circle("disc", {0, 0}, 1, none);
  const Crack apart{"a", {{1.2, 0}, {1.6, 0.3}}, {}}, across{"b", {{0, 0.5}, {1.5, 0.5}}, {}},
      ends{"c", {{0, -1}, {0, -0.5}}, {}};
  EXPECT_EQ(crack_on_border(square({disc}, {apart})), none);
  EXPECT_EQ(crack_on_border(square({disc}, {apart, across})), 1);
  EXPECT_EQ(crack_on_border(square({disc}, {ends, apart})), 0);
  EXPECT_EQ(crack_on_border(square({}, {across})), none);
}

// Patches around tips keep away from borders; a tip on one has none.
TEST(RegionCracks, HaveMirroredTipsBesideBorders) {
  const Shape shape =
      square({circle("disc", {0, 0}, 1, none)}, {{"c", {{-0.5, 0}, {1.3, 0.1}}, {}}, {"d", {{0, 1}, {0, 1.5}}, {}}});
  const Mesh m = triangulate(shape, {.size = 0.3, .mirrored_tips = true});
  EXPECT_NEAR(area_of(m, 0), pi, 2e-3);
  EXPECT_NEAR(crack_length(m, 0), path_length(shape.cracks[0]), 1e-12);
  EXPECT_NEAR(crack_length(m, 1), 0.5, 1e-12);
}

// An interface in contact is a crack, too: another one may cross it or end on it.
TEST(RegionCracks, CrossInterfaces) {
  Shape shape = square({polygon("box", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, none)}, {});
  shape.cracks = {{"fit", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}, {}}, {"c", {{0.3, 0.2}, {1.5, 0.1}}, {}}};
  const Mesh m = triangulate(shape, {.size = 0.3});
  EXPECT_NEAR(crack_length(m, 0), 8, 1e-12);
  EXPECT_NEAR(crack_length(m, 1), path_length(shape.cracks[1]), 1e-12);
  EXPECT_NEAR(area_of(m, 0), 4, 1e-12);
}

TEST(RegionCracks, AreRefusedByName) {
  const auto problem = [](std::vector<Loop> regions, std::vector<Vec2> path) {
    return find_problem(square(std::move(regions), {{"c", std::move(path), {}}})).value_or("");
  };
  const Loop box = polygon("box", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, none);
  EXPECT_EQ(problem({box}, {{-0.5, 1}, {0.5, 1}}).substr(0, 35), "crack 'c' overlaps region 'box' at ");
  EXPECT_EQ(problem({box}, {{-1.5, 1.003}, {1.5, 0.997}}).substr(0, 32), "crack 'c' meets region 'box' at ");
  const std::string touches = problem({circle("disc", {0, 0}, 1, none)}, {{-1, 1}, {1, 1}});
  EXPECT_EQ(touches.substr(0, 36), "crack 'c' touches region 'disc' at (");
  EXPECT_NE(touches.find("; a crack crosses the border of a region, ends on it, or is made of its sides from corner to "
                         "corner"),
            std::string::npos);
}

/// Four regions apart, in the quarters of the square.
std::vector<Loop> random_regions(test::Dice& dice) {
  std::vector<Loop> regions;
  for (const Vec2& middle : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) {
    const Vec2 center = middle + Vec2(dice.between(-0.1, 0.1), dice.between(-0.1, 0.1));
    const std::string name = "r" + std::to_string(regions.size());
    const double kind = dice.between(0, 4);
    if (kind < 1) {
      regions.push_back(circle(name, center, dice.between(0.2, 0.8), none));
    } else if (kind < 2) {
      const Vec2 axes(dice.between(0.3, 0.8), dice.between(0.15, 0.6));
      regions.push_back(ellipse(name, center, axes, dice.between(0, pi), none));
    } else {
      std::vector<Vec2> corners;
      const int count = 3 + int(dice.between(0, 5));
      for (int k = 0; k < count; ++k) {
        const double angle = 2 * pi * (k + dice.between(-0.3, 0.3)) / count, r = dice.between(0.25, 0.8);
        corners.push_back(center + r * Vec2(std::cos(angle), std::sin(angle)));
      }
      regions.push_back(polygon(name, corners, none));
    }
  }
  return regions;
}

Crack random_crack(test::Dice& dice, const std::string& name) {
  const auto inside = [&] { return Vec2(dice.between(-1.9, 1.9), dice.between(-1.9, 1.9)); };
  if (dice.between(0, 3) < 1) {
    const double from = dice.between(0, 2 * pi);
    return arc_crack(name, {dice.between(-0.6, 0.6), dice.between(-0.6, 0.6)}, dice.between(0.3, 1.2), from,
                     from + dice.between(0.5, 5));
  }
  std::vector<Vec2> points{inside()};
  const int count = 1 + int(dice.between(0, 4));
  for (int k = 0; k < count; ++k) points.push_back(inside());
  return {name, points, {}};
}

bool straight(const Loop& loop) {
  return std::ranges::none_of(loop.sides, [](const Side& s) { return s.arc.has_value(); });
}

TEST(RegionCracks, RandomPathsAgainstRandomRegions) {
  test::Dice dice(48);
  int meshed = 0, crossings = 0;
  constexpr int shapes = 40;
  for (int k = 0; k < shapes; ++k) {
    Shape shape = square(random_regions(dice), {random_crack(dice, "c"), random_crack(dice, "d")});
    if (find_problem(shape)) continue;  // a crack that crosses itself, a grazing angle
    ++meshed;
    const Mesh m = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.1});
    double whole = 0;
    for (Index r = none; r < Index(shape.regions.size()); ++r) {
      whole += area_of(m, r);
      if (r == none) continue;
      const Loop& loop = shape.regions[std::size_t(r)];
      double drawn = std::abs(signed_area(loop));
      EXPECT_NEAR(area_of(m, r), drawn, straight(loop) ? 1e-9 : 6e-3 * drawn) << k;
    }
    EXPECT_NEAR(whole, 16, 1e-9) << "the triangles tile the body";
    const std::set<Index> border = on_borders(m);
    for (std::size_t c = 0; c < 2; ++c) {
      const Crack& crack = shape.cracks[c];
      const double drawn = path_length(crack);
      EXPECT_NEAR(crack_length(m, Index(c)), drawn, crack.arc ? 2e-2 * drawn : 1e-9) << k;
      for (const Index v : path(m, Index(c))) {
        const Vec2& x = m.points[std::size_t(v)];
        double away = infinity;
        for (std::size_t i = 0; i + 1 < crack.points.size() && !crack.arc; ++i)
          away = std::min(away, distance(x, crack.points[i], crack.points[i + 1]));
        if (crack.arc) away = std::abs((x - crack.arc->center).norm() - crack.arc->axes.col(0).norm());
        EXPECT_LT(away, 1e-8) << k;
      }
      // Where straight pieces cross straight sides is a vertex of both.
      for (std::size_t i = 0; i + 1 < crack.points.size() && !crack.arc; ++i)
        for (const Loop& loop : shape.regions)
          for (std::size_t j = 0; straight(loop) && j < loop.sides.size(); ++j) {
            const Vec2 &a = crack.points[i], &b = crack.points[i + 1];
            const auto s = crossing(a, b, loop.sides[j].start, loop.sides[(j + 1) % loop.sides.size()].start);
            if (!s) continue;
            ++crossings;
            EXPECT_TRUE(has_vertex(m, border, a + *s * (b - a), 1e-5)) << k;
          }
    }
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const Index r = region_of(m, Index(t));
      const Vec2 x = centroid(m, Index(t));
      for (std::size_t q = 0; q < shape.regions.size(); ++q) {
        if (!straight(shape.regions[q])) continue;
        std::vector<Vec2> corners;
        for (const Side& side : shape.regions[q].sides) corners.push_back(side.start);
        EXPECT_EQ(inside(corners, x), r == Index(q)) << k;
      }
    }
  }
  EXPECT_GT(meshed, shapes / 3);
  EXPECT_GT(crossings, 30);
}

}  // namespace
}  // namespace kerf::region_crack_test
