// The parts of a mesh that several processes have, divided: together the divided whole, and what they know of each
// other the same on both sides.

#include "geometry/mesh_part.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>

namespace kerf::spread_test {
namespace {

constexpr int count = 3, divisions = 2;

/// A rectangle with a hole and two cracks, one of which runs along the border between two parts.
Mesh body() {
  const Shape shape{
      .outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0),
      .holes = {polygon("hole", {{1.4, 0.4}, {1.6, 0.4}, {1.5, 0.6}}, 0)},
      .cracks = {{"middle", {{1, 0.2}, {1, 0.8}}, {}}, {"across", {{0.3, 0.5}, {0.7, 0.55}, {0.9, 0.4}}, {}}},
      .labels = {"side"}};
  return triangulate(shape, {.size = 0.2, .crack_tip_size = 0.1});
}

/// With a round hole, and an arc of a crack that runs along a border.
Mesh curved_body() {
  const Shape shape{.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0),
                    .holes = {circle("hole", {1.5, 0.5}, 0.2, 0)},
                    .cracks = {{"middle", {{1, 0.2}, {1, 0.8}}, {}}, arc_crack("bent", {0.6, 0.5}, 0.25, -1.2, 1.3)},
                    .labels = {"side"}};
  return triangulate(shape, {.size = 0.2, .crack_tip_size = 0.1, .curved = true});
}

/// By x: the first crack lies between two of them.
std::vector<Index> process_of(const Mesh& mesh) {
  std::vector<Index> process;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const double x = centroid(mesh, t).x();
    process.push_back(x < 0.5 ? 2 : x < 1 ? 0 : 1);
  }
  return process;
}

std::vector<MeshPart> parts_of(const Mesh& mesh) {
  std::vector<MeshPart> parts;
  for (Index p = 0; p < count; ++p) parts.push_back(mesh_part(mesh, process_of(mesh), count, p, divisions));
  return parts;
}

std::set<std::pair<double, double>> corners(const Mesh& mesh, Index t) {
  std::set<std::pair<double, double>> all;
  for (const Index v : mesh.triangles[static_cast<std::size_t>(t)])
    all.insert({mesh.points[static_cast<std::size_t>(v)].x(), mesh.points[static_cast<std::size_t>(v)].y()});
  return all;
}

/// By the points of its ends: what it follows.
std::map<std::set<std::pair<double, double>>, std::set<double>> arcs_by_ends(const Mesh& mesh, Index own) {
  std::map<std::set<std::pair<double, double>>, std::set<double>> arcs;
  for (std::size_t e = 0; e < mesh.arc.size(); ++e) {
    if (mesh.arc[e] == none || (mesh.sides[e][0] >= own && mesh.sides[e][1] >= own)) continue;
    const Arc& arc = mesh.arcs[static_cast<std::size_t>(mesh.arc[e])];
    std::set<std::pair<double, double>> ends;
    for (const Index v : mesh.edges[e])
      ends.insert({mesh.points[static_cast<std::size_t>(v)].x(), mesh.points[static_cast<std::size_t>(v)].y()});
    arcs[ends] = {arc.from, arc.to, arc.center.x()};
  }
  return arcs;
}

class SpreadMesh : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Both, SpreadMesh, testing::Bool());

TEST_P(SpreadMesh, OwnTrianglesAreThoseOfTheDividedWhole) {
  const Mesh coarse = GetParam() ? curved_body() : body();
  Mesh fine = coarse;
  for (int k = 0; k < divisions; ++k) fine = refine(fine);
  std::set<std::set<std::pair<double, double>>> whole, found;
  for (Index t = 0; t < static_cast<Index>(fine.triangles.size()); ++t) whole.insert(corners(fine, t));
  const auto of_whole = arcs_by_ends(fine, static_cast<Index>(fine.triangles.size()));
  EXPECT_EQ(of_whole.empty(), !GetParam());
  std::size_t own = 0;
  for (const MeshPart& part : parts_of(coarse)) {
    own += static_cast<std::size_t>(part.own);
    for (Index t = 0; t < part.own; ++t) found.insert(corners(part.mesh, t));
    for (Index t = 0; t < static_cast<Index>(part.mesh.triangles.size()); ++t)
      EXPECT_EQ(t < part.own, part.process[static_cast<std::size_t>(t)] == part.process[0]);
    for (const auto& [ends, arc] : arcs_by_ends(part.mesh, part.own)) EXPECT_EQ(arc, of_whole.at(ends));
  }
  EXPECT_EQ(own, fine.triangles.size());
  EXPECT_EQ(found, whole);  // bit for bit
}

TEST(Spread, NeighborsOfOwnTrianglesAreThereWithBothSidesOfCracks) {
  for (const MeshPart& part : parts_of(body())) {
    for (std::size_t e = 0; e < part.mesh.edges.size(); ++e) {
      const auto [left, right] = part.mesh.sides[e];
      const bool one_sided = left == none || right == none;
      EXPECT_FALSE(one_sided && part.mesh.crack[e] != none);
      const bool cut_off = one_sided && part.mesh.label[e] == none;
      EXPECT_TRUE(!cut_off || (left == none ? right : left) >= part.own);
    }
  }
}

TEST(Spread, WhatIsShownIsWhatIsSeenInTheSameOrder) {
  const std::vector<MeshPart> parts = parts_of(body());
  for (std::size_t p = 0; p < count; ++p)
    for (std::size_t q = 0; q < count; ++q) {
      const auto &shown = parts[p].shown[q], &seen = parts[q].seen[p];
      ASSERT_EQ(shown.size(), seen.size());
      EXPECT_EQ(shown.empty(), p == q || p + q == 3);  // 1 and 2 do not meet
      for (std::size_t i = 0; i < shown.size(); ++i) {
        EXPECT_LT(shown[i], parts[p].own);
        EXPECT_GE(seen[i], parts[q].own);
        const auto& a = parts[p].mesh.triangles[static_cast<std::size_t>(shown[i])];
        const auto& b = parts[q].mesh.triangles[static_cast<std::size_t>(seen[i])];
        for (std::size_t k = 0; k < 3; ++k) {  // the same vertices in the same order, the edges in the same direction
          EXPECT_EQ(parts[p].mesh.points[static_cast<std::size_t>(a[k])],
                    parts[q].mesh.points[static_cast<std::size_t>(b[k])]);
          const auto of = [&](const MeshPart& part, Index t) {
            const auto e = part.mesh.edges_of[static_cast<std::size_t>(t)][k];
            return part.mesh.points[static_cast<std::size_t>(part.mesh.edges[static_cast<std::size_t>(e)][0])];
          };
          EXPECT_EQ(of(parts[p], shown[i]), of(parts[q], seen[i]));
        }
      }
    }
}

TEST(Spread, EdgesOfCracksKnowWhereTheyBegin) {
  const Mesh coarse = body();
  for (const MeshPart& part : parts_of(coarse)) {
    ASSERT_EQ(part.whole.size(), 2u);
    EXPECT_NEAR(part.whole[0], 0.6, 1e-14);
    for (std::size_t k = 0; k < part.mesh.cracks[0].size(); ++k) {
      const auto& [a, b] = part.mesh.edges[static_cast<std::size_t>(part.mesh.cracks[0][k].edge)];
      const Vec2& begin = part.mesh.points[static_cast<std::size_t>(part.mesh.cracks[0][k].forward ? a : b)];
      EXPECT_NEAR(part.from[0][k], begin.y() - 0.2, 1e-14);
    }
  }
}

TEST(Spread, WhatDoesNotFitIsRefused) {
  EXPECT_THROW(mesh_part(body(), {0, 1}, 2, 0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kerf::spread_test
