// Meshes whose neighborhoods of crack tips are their own mirror images.

#include "geometry/adapt.hpp"
#include "geometry/mesh/mirror.hpp"
#include "kerf/mesher.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::mirrored_tips_test {
namespace {

Shape square(std::vector<Crack> cracks) {
  return {.outline = polygon("outline", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0),
          .holes = {},
          .cracks = std::move(cracks),
          .labels = {"side"}};
}

/// How far from a tip every triangle has its image.
double mirrored_radius(const Mesh& mesh, const Vec2& tip) {
  const MirrorImages mirror = mirror_at_tips(mesh);
  double least = 10;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mirror.triangle[t] != none) continue;
    for (const Index v : mesh.triangles[t]) least = std::min(least, (mesh.points[std::size_t(v)] - tip).norm());
  }
  return least;
}

std::vector<Vec2> ends(const Mesh& mesh, std::size_t crack) {
  std::vector<Vec2> found;
  for (const CrackEdge& c : {mesh.cracks[crack].front(), mesh.cracks[crack].back()}) {
    const bool start = c.edge == mesh.cracks[crack].front().edge;
    found.push_back(mesh.points[std::size_t(mesh.edges[std::size_t(c.edge)][c.forward == start ? 0 : 1])]);
  }
  return found;
}

TEST(MirroredTips, ReachTenEdges) {
  const double tip = 2e-3;
  const Shape shape =
      square({{"straight", {{-0.6, -0.5}, {0.3, -0.3}}}, {"bent", {{-0.7, 0.2}, {0, 0.3}, {0.6, 0.1}}}});
  const Mesh with = triangulate(shape, {.size = 0.1, .crack_tip_size = tip, .mirrored_tips = true}),
             without = triangulate(shape, {.size = 0.1, .crack_tip_size = tip});
  for (std::size_t c = 0; c < 2; ++c)
    for (const Vec2& x : ends(with, c)) {
      EXPECT_GT(mirrored_radius(with, x), 9 * tip);
      EXPECT_LT(mirrored_radius(without, x), 4 * tip);
    }
  EXPECT_GE(quality(with).min_angle_deg, 25);
  EXPECT_NEAR(double(with.triangles.size()), double(without.triangles.size()), 0.05 * double(without.triangles.size()));
}

TEST(MirroredTips, FollowArcsAndKeepTheirDistance) {
  Shape shape = square({arc_crack("arc", {0, 0}, 0.5, 0, 2)});
  shape.holes = {circle("h", {0.53, -0.05}, 0.03, 0)};
  const Mesh mesh = triangulate(shape, {.size = 0.1, .crack_tip_size = 1e-3, .mirrored_tips = true});
  EXPECT_GE(quality(mesh).min_angle_deg, 25);
  EXPECT_GT(mirrored_radius(mesh, {0.5, 0}), 3e-3);
  for (const CrackEdge& c : mesh.cracks[0])
    for (const Index v : mesh.edges[std::size_t(c.edge)]) EXPECT_NEAR(mesh.points[std::size_t(v)].norm(), 0.5, 1e-12);
}

TEST(MirroredTips, StayWithinTheirMaterial) {
  Shape shape = square({{"c", {{-0.5, 0}, {0.1, 0.02}}}});
  shape.regions = {circle("r", {0.1, 0.02}, 0.2, none)};
  shape.cracks[0].points[0] = {-0.05, 0};
  const Mesh mesh = triangulate(shape, {.size = 0.1, .mirrored_tips = true});
  double inside = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (region_of(mesh, Index(t)) == 0) inside += area(mesh, Index(t));
  EXPECT_NEAR(inside, pi * 0.04, 1e-3);
}

TEST(MirroredTips, SurviveBisection) {
  const Shape shape = square({{"c", {{-0.5, -0.1}, {0.4, 0.2}}}});
  Mesh mesh =
      longest_edges_first(triangulate(shape, {.size = 0.2, .crack_tip_size = 5e-3, .mirrored_tips = true}), true);
  std::mt19937 random(3);
  for (int round = 0; round < 6; ++round) {
    std::vector<Index> marked;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (random() % 7 == 0) marked.push_back(Index(t));
    mesh = bisect(mesh, marked, true);
    for (const Vec2& x : ends(mesh, 0)) EXPECT_GT(mirrored_radius(mesh, x), 0.04) << round;
  }
}

// Angles beside patches, which are not to be split: as good as without.
TEST(MirroredTips, KeepTheAngles) {
  std::mt19937 random(1);
  const auto between = [&](double a, double b) { return a + (b - a) * double(random() % 100000) / 1e5; };
  int meshes = 0;
  for (int i = 0; i < 60; ++i) {
    Shape shape = square({});
    for (int c = 0; c < 3; ++c) {
      const Vec2 x(between(-0.8, 0.8), between(-0.8, 0.8));
      const double turn = between(0, 2 * pi), length = std::pow(10, between(-2, -0.2));
      shape.cracks.push_back(
          c == 2 ? arc_crack("arc", x, length, turn, turn + between(-2, 2))
                 : Crack{fmt::format("c{}", c), {x, x + length * Vec2(std::cos(turn), std::sin(turn))}});
    }
    if (find_problem(shape)) continue;
    const Sizing sizing{.size = 0.2, .crack_tip_size = 0.2 * std::pow(10, between(-3, 0)), .mirrored_tips = true};
    Sizing plain = sizing;
    plain.mirrored_tips = false;
    const double least = std::min(25.0, quality(triangulate(shape, plain)).min_angle_deg);
    EXPECT_GE(quality(triangulate(shape, sizing)).min_angle_deg, least - 1e-6) << i;
    ++meshes;
  }
  EXPECT_GT(meshes, 20);
}

}  // namespace
}  // namespace kerf::mirrored_tips_test
