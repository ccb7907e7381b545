// Meshes made of points and triangles: Euler's formula, normals that close up, vertices split by cracks counted by
// hand, refinement, and the triangle of a point against a search through all of them.

#include "kerf/mesh.hpp"
#include "geometry/plane.hpp"
#include "geometry/topology.hpp"
#include "kerf/folded.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace kerf::mesh_test {
namespace {

/// Union-jack-free grid on [0, n] x [0, m], squares cut along one diagonal; squares in `missing` left out.
Mesh grid(int n, int m, const std::set<std::pair<int, int>>& missing = {}, std::vector<Marked> marked = {}) {
  std::vector<Vec2> points;
  std::vector<Index> number(std::size_t((n + 1) * (m + 1)), none);
  std::vector<std::array<Index, 3>> triangles;
  const auto vertex = [&](int i, int j) {
    Index& v = number[std::size_t(j * (n + 1) + i)];
    if (v == none) {
      v = Index(points.size());
      points.emplace_back(i, j);
    }
    return v;
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      if (missing.contains({i, j})) continue;
      const Index a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  return connect(points, triangles, marked);
}

Index vertex_at(const Mesh& mesh, const Vec2& x) {
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (mesh.points[v] == x) return Index(v);
  return none;
}

/// The grid with a crack along the given lattice path.
Mesh cracked(int n, int m, const std::vector<Vec2>& path) {
  const Mesh plain = grid(n, m);
  std::vector<Marked> marked;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    marked.push_back({vertex_at(plain, path[i]), vertex_at(plain, path[i + 1]), none, 0});
  return connect(plain.points, plain.triangles, marked);
}

TEST(Connect, SatisfiesEulersFormula) {
  // Pieces - holes = vertices - edges + triangles.
  for (const auto& [missing, holes] : std::vector<std::pair<std::set<std::pair<int, int>>, int>>{
           {{}, 0}, {{{1, 1}}, 1}, {{{1, 1}, {3, 2}}, 2}, {{{1, 1}, {2, 1}, {4, 3}, {1, 3}}, 3}}) {
    const Mesh m = grid(6, 5, missing);
    EXPECT_EQ(Index(m.points.size()) - Index(m.edges.size()) + Index(m.triangles.size()), 1 - holes);
  }
}

TEST(Connect, EdgesAndSidesFit) {
  const Mesh m = grid(5, 4, {{2, 1}});
  std::size_t uses = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    const auto [a, b] = m.edges[e];
    EXPECT_LT(a, b);
    const Vec2 n = normal(m, Index(e)), middle = (m.points[std::size_t(a)] + m.points[std::size_t(b)]) / 2;
    EXPECT_NEAR(n.norm(), 1, 1e-15);
    EXPECT_NEAR(n.dot(tangent(m, Index(e))), 0, 1e-15);
    EXPECT_NEAR(
        (m.points[std::size_t(b)] - m.points[std::size_t(a)] - length(m, Index(e)) * tangent(m, Index(e))).norm(), 0,
        1e-15);
    for (int side = 0; side < 2; ++side) {
      const Index t = m.sides[e][std::size_t(side)];
      if (t == none) continue;
      ++uses;
      // The normal points from left to right.
      EXPECT_GT((side == 0 ? -1 : 1) * n.dot(centroid(m, t) - middle), 0);
      EXPECT_NE(std::ranges::count(m.edges_of[std::size_t(t)], Index(e)), 0);
    }
    EXPECT_FALSE(m.sides[e][0] == none && m.sides[e][1] == none);
  }
  EXPECT_EQ(uses, 3 * m.triangles.size());
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    EXPECT_DOUBLE_EQ(area(m, Index(t)), 0.5);
    for (std::size_t i = 0; i < 3; ++i) {  // edge i is opposite vertex i
      const auto [a, b] = m.edges[std::size_t(m.edges_of[t][i])];
      EXPECT_NE(a, m.triangles[t][i]);
      EXPECT_NE(b, m.triangles[t][i]);
    }
  }
}

TEST(Connect, OutwardNormalsCloseUp) {
  const Mesh m = grid(4, 3, {{1, 1}});
  Vec2 sum = Vec2::Zero();
  double flux = 0;  // of x: twice the area
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    if (m.sides[e][0] != none && m.sides[e][1] != none) continue;
    const Vec2 n = (m.sides[e][0] == none ? -1 : 1) * length(m, Index(e)) * normal(m, Index(e));
    sum += n;
    flux += n.dot(m.points[std::size_t(m.edges[e][0])]);
  }
  EXPECT_NEAR(sum.norm(), 0, 1e-13);
  EXPECT_NEAR(flux, 2 * (12 - 1), 1e-12);
}

TEST(Connect, CarriesLabelsAndCracksInPathOrder) {
  const std::vector<Vec2> path{{1, 2}, {2, 2}, {3, 3}, {3, 2}};
  const Mesh m = cracked(5, 5, path);
  ASSERT_EQ(m.cracks.size(), 1u);
  ASSERT_EQ(m.cracks[0].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [e, forward] = m.cracks[0][i];
    EXPECT_EQ(m.crack[std::size_t(e)], 0);
    auto [a, b] = m.edges[std::size_t(e)];
    if (!forward) std::swap(a, b);
    EXPECT_EQ(m.points[std::size_t(a)], path[i]);
    EXPECT_EQ(m.points[std::size_t(b)], path[i + 1]);
  }
  EXPECT_EQ(std::ranges::count(m.crack, none), Index(m.edges.size()) - 3);
  const Mesh plain = grid(2, 1);
  const Mesh labeled = connect(plain.points, plain.triangles,
                               std::vector<Marked>{{vertex_at(plain, {2, 0}), vertex_at(plain, {1, 0}), 4}});
  EXPECT_EQ(std::ranges::count(labeled.label, 4), 1);
}

TEST(Connect, RefusesWhatIsNoMesh) {
  const std::vector<Vec2> points{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0.2}};
  const auto fails = [&](std::vector<std::array<Index, 3>> triangles, std::vector<Marked> marked = {}) {
    EXPECT_THROW(connect(points, triangles, marked), std::invalid_argument);
  };
  fails({{0, 2, 1}});                                                 // clockwise
  fails({{0, 1, 1}});                                                 // degenerate
  fails({{0, 1, 9}});                                                 // no such vertex
  fails({{0, 1, 2}, {1, 3, 2}, {0, 1, 4}});                           // two on one side of an edge
  fails({{0, 1, 2}}, {{0, 3, 1}});                                    // marked pair is no edge
  fails({{0, 1, 2}}, {{0, 7, 1}});                                    // nor this
  fails({{0, 1, 2}}, {{0, 1, none, 0}});                              // crack on the boundary
  fails({{0, 1, 2}, {1, 3, 2}}, {{1, 2, none, 0}, {2, 1, none, 0}});  // crack twice
  std::vector<Vec2> bad = points;
  bad[0].x() = nan;
  EXPECT_THROW(connect(bad, {{0, 1, 2}}, {}), std::invalid_argument);
}

TEST(Connect, KeepsEmptyMesh) {
  const Mesh m = connect({}, {}, {});
  EXPECT_TRUE(m.edges.empty());
  EXPECT_TRUE(locate(m, std::vector<Vec2>{{0, 0}})[0] == none);
  EXPECT_EQ(quality(m).mean_quality, 0);
}

TEST(Quality, OfKnownTriangles) {
  const double h = std::sqrt(3.0) / 2;
  const Quality equilateral = quality(connect({{0, 0}, {1, 0}, {0.5, h}}, {{0, 1, 2}}, {}));
  EXPECT_NEAR(equilateral.mean_quality, 1, 1e-14);
  EXPECT_NEAR(equilateral.min_angle_deg, 60, 1e-12);
  const Quality half = quality(connect({{0, 0}, {1, 0}, {0, 2 * h}}, {{0, 1, 2}}, {}));
  EXPECT_NEAR(half.min_angle_deg, 30, 1e-12);
  EXPECT_NEAR(half.mean_quality, 4 * std::sqrt(3.0) * h / 8, 1e-14);
  EXPECT_NEAR(half.h_min, 1, 1e-15);
  EXPECT_NEAR(half.h_max, 2, 1e-15);
  const Quality obtuse = quality(connect({{0, 0}, {4, 0}, {2, 0.1}}, {{0, 1, 2}}, {}));
  EXPECT_NEAR(obtuse.min_angle_deg, std::atan(0.05) * 180 / std::acos(-1.0), 1e-12);
}

/// Corner numbers beyond one per vertex.
Index split(const Mesh& m) {
  return Index(split_at_cracks(m).vertex.size()) - Index(m.points.size());
}

TEST(SplitAtCracks, CountsSplitVertices) {
  EXPECT_EQ(split(grid(4, 4)), 0);
  EXPECT_EQ(split(cracked(6, 6, {{2, 3}, {3, 3}})), 0);                          // two tips
  EXPECT_EQ(split(cracked(6, 6, {{1, 3}, {2, 3}, {3, 3}, {4, 3}, {5, 3}})), 3);  // n - 1
  EXPECT_EQ(split(cracked(6, 6, {{0, 3}, {1, 3}, {2, 3}})), 2);                  // the mouth opens too
  EXPECT_EQ(split(cracked(4, 4, {{0, 2}, {1, 2}, {2, 2}, {3, 2}, {4, 2}})), 5);  // cut in two
  EXPECT_EQ(split(cracked(6, 6, {{1, 1}, {2, 2}, {3, 2}, {3, 3}, {4, 4}})), 3);  // kinked
}

TEST(SplitAtCracks, NumbersAgreeAcrossUncrackedEdgesOnly) {
  const Mesh m = cracked(6, 6, {{1, 3}, {2, 3}, {3, 4}, {4, 4}});
  const Corners corners = split_at_cracks(m);
  const auto corner = [&](Index t, Index vertex) {
    const auto& v = m.triangles[std::size_t(t)];
    return corners.of[std::size_t(t)][std::size_t(std::ranges::find(v, vertex) - v.begin())];
  };
  const std::set<Index> tips{vertex_at(m, {1, 3}), vertex_at(m, {4, 4})};
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    const auto [left, right] = m.sides[e];
    if (left == none || right == none) continue;
    for (const Index v : m.edges[e])
      EXPECT_EQ(corner(left, v) == corner(right, v), m.crack[e] == none || tips.contains(v));
  }
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(corners.vertex[std::size_t(corners.of[t][i])], m.triangles[t][i]);
}

TEST(SplitAtCracks, SeparatesTrianglesThatMeetInAVertexOnly) {
  const Mesh bow = connect({{0, 0}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}, {{0, 1, 2}, {0, 3, 4}}, {});
  EXPECT_EQ(split(bow), 1);
}

TEST(Pieces, CountsWhatTheCutsLeave) {
  const Mesh m = cracked(4, 4, {{0, 2}, {1, 2}, {2, 2}, {3, 2}, {4, 2}});
  std::vector<bool> cut(m.edges.size(), false);
  const auto count = [&] {
    const auto p = pieces(m, cut);
    return *std::ranges::max_element(p) + 1;
  };
  EXPECT_EQ(count(), 1);
  for (std::size_t e = 0; e < cut.size(); ++e) cut[e] = m.crack[e] != none;
  EXPECT_EQ(count(), 2);
  cut.assign(cut.size(), true);
  EXPECT_EQ(count(), Index(m.triangles.size()));
}

TEST(Refine, QuartersAndKeepsMarks) {
  const Mesh m = cracked(5, 5, {{1, 2}, {2, 2}, {3, 3}, {3, 2}});
  const Mesh fine = refine(m);
  EXPECT_EQ(fine.triangles.size(), 4 * m.triangles.size());
  EXPECT_EQ(fine.edges.size(), 2 * m.edges.size() + 3 * m.triangles.size());
  for (std::size_t t = 0; t < fine.triangles.size(); ++t) EXPECT_DOUBLE_EQ(area(fine, Index(t)), 0.125);
  EXPECT_DOUBLE_EQ(quality(fine).min_angle_deg, quality(m).min_angle_deg);
  ASSERT_EQ(fine.cracks[0].size(), 6u);
  Vec2 at(1, 2);
  for (const auto& [e, forward] : fine.cracks[0]) {
    auto [a, b] = fine.edges[std::size_t(e)];
    if (!forward) std::swap(a, b);
    EXPECT_EQ(fine.points[std::size_t(a)], at);
    at = fine.points[std::size_t(b)];
  }
  EXPECT_EQ(at, Vec2(3, 2));
  EXPECT_EQ(split(fine), 5);
}

// A flat triangle on an arc that rises above its other middles: the quarter between the three would turn over.
TEST(Refine, NamesATriangleThatAnArcTurnsOver) {
  const auto on_arc = [](double height) {
    const double r = (1 + 0.04) / 0.4;  // through (-1, 0), (1, 0) and (0, 0.2)
    Mesh m = connect({{-1, 0}, {1, 0}, {0, height}}, {{0, 1, 2}}, std::array{Marked{.a = 0, .b = 1, .label = 0}});
    m.arc.assign(m.edges.size(), none);
    m.arc[0] = 0;
    m.arcs = {{{0, 0.2 - r}, r * Mat2::Identity(), pi - std::acos(1 / r), std::acos(1 / r)}};
    return m;
  };
  const Mesh fine = refine(on_arc(0.5));
  EXPECT_NEAR(fine.points[3].y(), 0.2, 1e-15);
  EXPECT_EQ(std::ranges::count(fine.arc, none), Index(fine.edges.size()) - 2);
  EXPECT_THROW(refine(on_arc(0.3)), FoldedTriangle);
}

bool holds(const Mesh& m, Index t, const Vec2& x, double slack) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 &a = m.points[std::size_t(m.triangles[std::size_t(t)][i])],
               &b = m.points[std::size_t(m.triangles[std::size_t(t)][(i + 1) % 3])];
    if (cross(b - a, x - a) < -slack) return false;
  }
  return true;
}

TEST(Locate, FindsPointsEdgesAndVertices) {
  // A grid bent into a quarter ring with graded rows: triangles of very different sizes.
  Mesh m = grid(20, 20, {{5, 5}, {12, 7}});
  for (Vec2& x : m.points) {
    const double r = 1 + std::pow(x.x() / 20, 4), phi = x.y() / 20 * 1.5;
    x = {r * std::cos(phi), r * std::sin(phi)};
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2> inside;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    double s = unit(random), r = unit(random);
    if (s + r > 1) s = 1 - s, r = 1 - r;
    const auto [a, b, c] = m.triangles[t];
    inside.push_back((1 - s - r) * m.points[std::size_t(a)] + s * m.points[std::size_t(b)] +
                     r * m.points[std::size_t(c)]);
  }
  const auto found = locate(m, inside);
  for (std::size_t t = 0; t < inside.size(); ++t) EXPECT_EQ(found[t], Index(t));

  std::vector<Vec2> seams = m.points;
  for (const auto& [a, b] : m.edges) seams.push_back((m.points[std::size_t(a)] + m.points[std::size_t(b)]) / 2);
  const auto at = locate(m, seams);
  for (std::size_t i = 0; i < seams.size(); ++i) {
    ASSERT_NE(at[i], none);
    EXPECT_TRUE(holds(m, at[i], seams[i], 1e-13));
  }
}

TEST(Locate, FindsTheNearestTriangle) {
  // Graded over eight decades, with a hole.
  Mesh m = grid(16, 12, {{5, 5}});
  for (Vec2& x : m.points) x = {std::pow(10, x.x() / 2 - 8), x.y() / 12};
  const Locator locator = make_locator(m);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec2 x(std::pow(10, 9 * unit(random) - 8), 1.4 * unit(random) - 0.2);
    // The least distance to a triangle, by way of every edge.
    double least = infinity;
    const auto to = [&](Index t) {
      if (holds(m, t, x, 0)) return 0.0;
      double best = infinity;
      for (const Index e : m.edges_of[std::size_t(t)]) {
        const Vec2 &a = m.points[std::size_t(m.edges[std::size_t(e)][0])],
                   &b = m.points[std::size_t(m.edges[std::size_t(e)][1])];
        best = std::min(best, distance(x, a, b));
      }
      return best;
    };
    for (std::size_t t = 0; t < m.triangles.size(); ++t) least = std::min(least, to(Index(t)));
    const Index found = nearest_triangle(m, locator, x);
    EXPECT_LE(to(found), least * (1 + 1e-12));
    EXPECT_EQ(locate(m, locator, x) != none, least == 0);
  }
}

TEST(Locate, SaysWhatLiesOutside) {
  const Mesh m = grid(6, 4, {{2, 1}});
  const std::vector<Vec2> outside{{-1, 0}, {7, 2}, {3, 9}, {2.5, 1.5}, {-1e-9, 1}, {nan, 0}, {1e300, 1e300}};
  for (const Index t : locate(m, outside)) EXPECT_EQ(t, none);
  for (const Index t : locate(m, std::vector<Vec2>{{-1e-13, 1}, {6 + 1e-13, 4}, {0, 0}})) EXPECT_NE(t, none);
}

}  // namespace
}  // namespace kerf::mesh_test
