// Meshes of second order: curves come back as they were drawn, and smooth curves as pieces of ellipses near them.

#include "io/mesh/second_order.hpp"

#include "geometry/plane.hpp"
#include "kerf/mesher.hpp"
#include "tests/io/mesh/meshes.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::second_order_test {
namespace {

using namespace meshes;

Shape square_with_hole(Loop hole) {
  Shape shape{polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, {}, {"outside", "hole"}, {}};
  shape.holes.push_back(std::move(hole));
  return shape;
}

Index count_of_arcs(const Mesh& mesh) {
  return Index(std::ranges::count_if(mesh.arc, [](Index a) { return a != none; }));
}

/// How far the arcs of the second are from those of the first, by their middles, and their ends.
void expect_same_arcs(const Mesh& a, const Mesh& b, double tolerance) {
  ASSERT_EQ(a.edges, b.edges);
  ASSERT_EQ(count_of_arcs(a), count_of_arcs(b));
  for (std::size_t e = 0; e < a.edges.size(); ++e) {
    if (a.arc[e] == none) continue;
    ASSERT_NE(b.arc[e], none);
    const Arc &p = a.arcs[std::size_t(a.arc[e])], &q = b.arcs[std::size_t(b.arc[e])];
    for (const double s : {0.0, 0.25, 0.5, 1.0})
      EXPECT_LT((at(p, p.from + s * (p.to - p.from)) - at(q, q.from + s * (q.to - q.from))).norm(), tolerance);
  }
}

TEST(SecondOrder, CirclesAndEllipsesComeBack) {
  for (const Loop& hole : {circle("hole", {0.1, 0}, 0.7, 1), ellipse("hole", {0, 0.2}, {0.9, 0.4}, 0.4, 1)}) {
    const Shape shape = square_with_hole(hole);
    const Mesh mesh = triangulate(shape, {.size = 0.3, .curved = true});
    for (const MshVersion version : {MshVersion::V4, MshVersion::V2}) {
      const MeshFile body = parse_mesh("a.msh", msh_text(mesh, shape, version));
      expect_same_arcs(mesh, body.mesh, 1e-10);
      EXPECT_NEAR(area(body.shape), area(shape), 1e-10);
      EXPECT_EQ(body.shape.labels, shape.labels);
      EXPECT_EQ(find_problem(body.shape), std::nullopt);
    }
  }
}

TEST(SecondOrder, AnArcIsACrackAndABorderOfRegions) {
  Shape shape{polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, {}, {"outside"}, {}};
  shape.regions.push_back(circle("core", {0.8, 0}, 0.5, none));
  shape.cracks.push_back(arc_crack("c", {-1, 0}, 0.6, 0.3, 2));
  const Mesh mesh = triangulate(shape, {.size = 0.3, .curved = true});
  const MeshFile body = parse_mesh("a.msh", msh_text(mesh, shape), {.materials = {"core"}});
  expect_same_arcs(mesh, body.mesh, 1e-10);
  ASSERT_EQ(body.shape.cracks.size(), 1u);
  ASSERT_TRUE(body.shape.cracks[0].arc);
  EXPECT_NEAR(path_length(body.shape.cracks[0]), 0.6 * 1.7, 1e-12);
  EXPECT_NEAR(body.shape.cracks[0].arc->from, 0.3, 1e-12);
  ASSERT_EQ(body.shape.regions.size(), 1u);
  EXPECT_TRUE(body.shape.regions[0].sides[0].arc);
  // Between surfaces of the same material nothing is bent.
  EXPECT_LT(count_of_arcs(parse_mesh("a.msh", msh_text(mesh, shape)).mesh), count_of_arcs(mesh));
}

TEST(SecondOrder, StraightEdgesStayStraight) {
  const Shape shape = square_with_hole(circle("hole", {0, 0}, 0.7, 1));
  Mesh mesh = triangulate(shape, {.size = 0.5, .curved = true});
  for (Arc& arc : mesh.arcs) {  // flat: the node in the middle lies on the chord
    const Vec2 a = at(arc, arc.from), b = at(arc, arc.to);
    arc = {(a + b) / 2, (Mat2() << (b - a) / 2, Vec2::Zero()).finished(), -pi, 0};
  }
  const MeshFile body = parse_mesh("a.msh", msh_text(mesh, shape));
  EXPECT_TRUE(body.mesh.arc.empty());
  EXPECT_TRUE(std::ranges::none_of(body.shape.holes[0].sides, [](const Side& s) { return s.arc.has_value(); }));
}

/// r = 1 + depth cos 3 t; above a depth of 1/8 it bends both ways.
Vec2 flower(double depth, double t) {
  return (1 + depth * std::cos(3 * t)) * Vec2(std::cos(t), std::sin(t));
}
double angle_of(const Vec2& x) {
  return std::atan2(x.y(), x.x());
}

struct Followed {
  double distance = 0, kink = 0;  // of edges that are bent; between neighbors, in radians
  Index straight = 0, edges = 0;
};

/// A mesh of a ring, its inner rim moved onto the flower: how the arcs follow it.
Followed follow(double depth, double size) {
  Shape shape{circle("outline", {0, 0}, 3, 0), {}, {}, {"outside", "hole"}, {}};
  shape.holes.push_back(circle("hole", {0, 0}, 1, 1));
  Mesh mesh = triangulate(shape, {.size = size, .curved = true});
  mesh.arc.clear();
  mesh.arcs.clear();
  for (Vec2& x : mesh.points) {
    const double far = (3 - x.norm()) / 2;  // 1 on the inner rim
    x = (1 - far) * x + far * x.norm() * flower(depth, angle_of(x));
  }
  MiddleNodes nodes{std::vector<Vec2>(mesh.edges.size(), Vec2::Constant(nan)),
                    std::vector<Index>(mesh.edges.size(), none)};
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.label[e] != 1) continue;
    const double a = angle_of(mesh.points[std::size_t(mesh.edges[e][0])]),
                 b = a + std::remainder(angle_of(mesh.points[std::size_t(mesh.edges[e][1])]) - a, 2 * pi);
    nodes.at[e] = flower(depth, (a + b) / 2);
    nodes.chain[e] = 0;
  }
  bend(mesh, nodes, 6);
  Followed out;
  std::vector<std::vector<Vec2>> at_vertex(mesh.points.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (nodes.chain[e] == none) continue;
    ++out.edges;
    const auto& [a, b] = mesh.edges[e];
    Vec2 start = mesh.points[std::size_t(b)] - mesh.points[std::size_t(a)], end = -start;
    if (mesh.arc[e] == none) {
      ++out.straight;
    } else {
      const Arc& arc = mesh.arcs[std::size_t(mesh.arc[e])];
      for (int k = 0; k <= 16; ++k) {
        const Vec2 x = at(arc, arc.from + (arc.to - arc.from) * k / 16);
        out.distance = std::max(out.distance, (x - flower(depth, angle_of(x))).norm());
      }
      const double way = arc.to > arc.from ? 1 : -1;
      start = way * velocity(arc, arc.from);
      end = -way * velocity(arc, arc.to);
    }
    at_vertex[std::size_t(a)].push_back(start.normalized());
    at_vertex[std::size_t(b)].push_back(end.normalized());
  }
  for (const auto& ways : at_vertex)
    if (ways.size() == 2) out.kink = std::max(out.kink, (ways[0] + ways[1]).norm());
  return out;
}

TEST(SecondOrder, SmoothCurvesHaveNoCorners) {
  for (const double depth : {0.08, 0.2}) {
    const Followed coarse = follow(depth, 0.1), fine = follow(depth, 0.05);
    for (const Followed& f : {coarse, fine}) {
      EXPECT_LT(f.straight, depth < 0.125 ? 1 : f.edges / 8) << depth;
      EXPECT_LT(f.kink, 1e-4) << depth;  // chords meet at 0.05 and more
    }
    // Chords where the curve turns over are of the third order, and so are the edges beside them.
    EXPECT_LT(fine.distance, depth < 0.125 ? 1e-6 : 2e-5) << depth;
    EXPECT_GT(std::log2(coarse.distance / fine.distance), depth < 0.125 ? 3.5 : 2) << depth;
  }
}

}  // namespace
}  // namespace kerf::second_order_test
