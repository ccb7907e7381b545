// Triangulations of bodies with holes and cracks: they are valid, have the area and the crack lengths of their polygons
// and the promised angles and sizes; what is refused is named. Random bodies are meshed or named.

#include "kerf/mesher.hpp"

#include "geometry/plane.hpp"
#include "geometry/topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::mesher_test {
namespace {

Shape square(double half = 2) {
  Shape shape{polygon("outline", {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, 0), {}, {}, {}};
  shape.labels = {"bottom", "right", "top", "left", "hole"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[std::size_t(i)].label = i;
  return shape;
}
Shape with_cracks(std::vector<Crack> cracks) {
  Shape shape = square();
  shape.cracks = std::move(cracks);
  return shape;
}
Shape with_holes(std::vector<Loop> holes) {
  Shape shape = square();
  shape.holes = std::move(holes);
  return shape;
}

double total_area(const Mesh& m) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) sum += area(m, Index(t));
  return sum;
}

double path_length(const std::vector<Vec2>& path) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) sum += (path[i + 1] - path[i]).norm();
  return sum;
}

/// All that must hold whatever the shape: one piece, right number of holes, marked edges where they belong.
void expect_valid(const Shape& shape, const Mesh& m) {
  EXPECT_EQ(Index(m.points.size()) - Index(m.edges.size()) + Index(m.triangles.size()), 1 - Index(shape.holes.size()));
  const auto piece = pieces(m, std::vector<bool>(m.edges.size(), false));
  EXPECT_EQ(*std::ranges::max_element(piece), 0);
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    const bool boundary = m.sides[e][0] == none || m.sides[e][1] == none;
    ASSERT_EQ(boundary, m.label[e] != none);
    ASSERT_FALSE(boundary && m.crack[e] != none);
  }
  ASSERT_EQ(m.cracks.size(), shape.cracks.size());
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    // The path from its first point to its last, every edge taken in turn, through every given point.
    const std::vector<Vec2>& path = shape.cracks[c].points;
    double length = 0;
    std::size_t corner = 1;
    Index at = none;
    ASSERT_FALSE(m.cracks[c].empty());
    for (const auto& [e, forward] : m.cracks[c]) {
      ASSERT_EQ(m.crack[std::size_t(e)], Index(c));
      auto [a, b] = m.edges[std::size_t(e)];
      if (!forward) std::swap(a, b);
      if (at == none) {
        EXPECT_LE((m.points[std::size_t(a)] - path.front()).norm(), 1e-5);
      } else {
        ASSERT_EQ(a, at);
      }
      at = b;
      if (corner + 1 < path.size() && m.points[std::size_t(b)] == path[corner]) ++corner;
      length += (m.points[std::size_t(b)] - m.points[std::size_t(a)]).norm();
    }
    EXPECT_LE((m.points[std::size_t(at)] - path.back()).norm(), 1e-5);
    EXPECT_EQ(corner + 1, path.size());
    EXPECT_NEAR(length, path_length(path), 1e-5);
    EXPECT_EQ(std::ranges::count(m.crack, Index(c)), Index(m.cracks[c].size()));
  }
}

double length_on(const Mesh& m, Index label) {
  double sum = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (m.label[e] == label) sum += length(m, Index(e));
  return sum;
}

struct Case {
  const char* name;
  Shape shape;
  Sizing sizing;
  double area;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

/// Shapes without small input angles.
std::vector<Case> good_shapes() {
  const auto with = [](Shape shape, std::vector<Crack> cracks) {
    shape.cracks = std::move(cracks);
    return shape;
  };
  Shape l_shape{polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0), {}, {}, {"side"}};
  Shape disc{circle("outline", {0, 0}, 1, 0), {}, {}, {"side"}};
  Shape ring{circle("outline", {0, 0}, 1, 0), {circle("h", {0, 0}, 0.5, 1)}, {}, {"outer", "inner"}};
  Shape half{{"outline", {{{1, 0}, 0, Arc{{0, 0}, Mat2::Identity(), 0, pi}}, {{-1, 0}, 1, std::nullopt}}},
             {},
             {},
             {"arc", "flat"}};
  Shape two_arcs = half;
  two_arcs.outline.sides[1].arc = Arc{{0, 0}, Mat2::Identity(), pi, 2 * pi};
  Shape clockwise = square();
  std::ranges::reverse(clockwise.outline.sides);
  std::vector<Loop> many;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j)
      many.push_back(circle("h", {-1.5 + 0.5 * i, -1.5 + 0.5 * j}, 0.02 + 0.004 * (i + j), 4));
  double many_area = 16;
  for (const Loop& hole : many) many_area -= pi * hole.sides[0].arc->axes(0, 0) * hole.sides[0].arc->axes(0, 0);
  return {
      {"square", square(), {.size = 0.1}, 16},
      {"coarse_square", square(), {.size = 3}, 16},
      {"huge_size", square(), {.size = 1e9}, 16},
      {"default_size", square(), {}, 16},
      {"clockwise", clockwise, {.size = 0.2}, 16},
      {"tiny_body", square(1e-6), {.size = 1e-7}, 4e-12},
      {"large_body", square(1e6), {.size = 1e5}, 4e12},
      {"crack", with_cracks({{"c", {{-1, 0}, {1, 0}}}}), {.size = 0.1}, 16},
      {"oblique_crack", with_cracks({{"c", {{-1, -0.3}, {1, 0.7}}}}), {.size = 0.2}, 16},
      {"uniform_crack", with_cracks({{"c", {{-1, 0}, {1, 0}}}}), {.size = 0.1, .crack_tip_size = 0.1}, 16},
      {"sharp_tips", with_cracks({{"c", {{-1, 0}, {1, 0}}}}), {.size = 0.2, .crack_tip_size = 1e-6}, 16},
      {"kinked_crack", with_cracks({{"c", {{-1, 0}, {0, 0.4}, {1, 0}}}}), {.size = 0.15}, 16},
      {"edge_crack", with_cracks({{"c", {{-2, 0}, {0.5, 0}}}}), {.size = 0.15}, 16},
      {"through_crack", with_cracks({{"c", {{-2, 0.1}, {2, -0.2}}}}), {.size = 0.15}, 16},
      {"two_cracks", with_cracks({{"c", {{-1, 0.2}, {1, 0.2}}}, {"d", {{-1, -0.2}, {0.3, -0.3}}}}), {.size = 0.15}, 16},
      {"crack_from_corner", with_cracks({{"c", {{-2, -2}, {-1, -1}}}}), {.size = 0.2}, 16},
      {"hole", with_holes({circle("h", {0.3, 0.1}, 1, 4)}), {.size = 0.1}, 16 - pi},
      {"small_hole", with_holes({circle("h", {0.3, 0.1}, 1e-4, 4)}), {.size = 0.2}, 16 - pi * 1e-8},
      {"square_hole", with_holes({polygon("h", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 4)}), {.size = 0.15}, 15},
      {"ellipse", with_holes({ellipse("h", {0, 0}, {1, 0.2}, 0.3, 4)}), {.size = 0.15}, 16 - 0.2 * pi},
      {"many_holes", with_holes(many), {.size = 0.15}, many_area},
      {"ring", ring, {.size = 0.05}, 0.75 * pi},
      {"thin_ring",
       {circle("outline", {0, 0}, 1, 0), {circle("h", {0, 0}, 0.99, 0)}, {}, {"side"}},
       {.size = 0.1},
       pi * (1 - 0.99 * 0.99)},
      {"disc", disc, {.size = 0.1}, pi},
      {"coarse_disc", disc, {.size = 5}, pi},
      {"half_disc", half, {.size = 0.1}, -1},
      {"disc_of_two_arcs", two_arcs, {.size = 0.1}, -1},
      {"coarse_disc_of_two_arcs", two_arcs, {.size = 5}, -1},
      {"l_shape", l_shape, {.size = 0.1}, 3},
      {"crack_in_disc", with(disc, {{"c", {{1, 0}, {0.2, 0.1}}}}), {.size = 0.1}, -1},
      {"crack_outline_to_hole", with(ring, {{"c", {{1, 0}, {0.5, 0}}}}), {.size = 0.08}, -1},
      {"two_cracks_at_a_hole",
       with(with_holes({circle("h", {0, 0}, 0.3, 4)}), {{"c", {{0.3, 0}, {0.8, 0}}}, {"d", {{-0.3, 0}, {-0.8, 0.1}}}}),
       {.size = 0.15},
       -1},
      {"tip_near_side", with_cracks({{"c", {{0, 0}, {1.999, 0}}}}), {.size = 0.2}, 16},
      {"narrow_gap",
       with_holes({polygon("h", {{-1, -1.99}, {1, -1.99}, {1, 0}, {-1, 0}}, 4)}),
       {.size = 0.2},
       16 - 2 * 1.99},
  };
}

class GoodShape : public testing::TestWithParam<Case> {};

TEST_P(GoodShape, GivesAGoodMesh) {
  const Case& c = GetParam();
  const Mesh m = triangulate(c.shape, c.sizing);
  expect_valid(c.shape, m);
  if (c.area > 0) {
    EXPECT_NEAR(total_area(m), c.area, 1e-10 * c.area);
  }
  const Quality q = quality(m);
  EXPECT_GE(q.min_angle_deg, 25);
  EXPECT_GE(q.mean_quality, 0.86);  // two half squares have 0.866
}

INSTANTIATE_TEST_SUITE_P(All, GoodShape, testing::ValuesIn(good_shapes()),
                         [](const auto& info) { return info.param.name; });

TEST(Triangulate, HasTheAreaAndBoundaryOfThePolygon) {
  const Mesh m = triangulate(square(), {.size = 0.13});
  for (Index label = 0; label < 4; ++label) EXPECT_NEAR(length_on(m, label), 4, 1e-13);
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (m.label[e] != none) {
      // Counter-clockwise from the bottom: the normal, turned outwards, says the label.
      const Vec2 n = (m.sides[e][0] == none ? -1 : 1) * normal(m, Index(e));
      const Index expected = n.y() < -0.9 ? 0 : n.x() > 0.9 ? 1 : n.y() > 0.9 ? 2 : 3;
      EXPECT_EQ(m.label[e], expected);
    }
}

TEST(Triangulate, KeepsCrackLengthsToTheLastDigits) {
  const std::vector<Crack> cracks{{"a", {{-2, 1}, {-0.7, 1.1}, {0.4, 0.8}}},
                                  {"b", {{-1, 0}, {1, 0}}},
                                  {"c", {{1.5, -1}, {0, -1.5}, {-0.3, -0.9}, {-1.2, -1.3}}}};
  const Mesh m = triangulate(with_cracks(cracks), {.size = 0.1});
  for (std::size_t c = 0; c < cracks.size(); ++c) {
    double sum = 0;
    for (const CrackEdge& piece : m.cracks[c]) sum += length(m, piece.edge);
    EXPECT_NEAR(sum, path_length(cracks[c].points), 1e-12);
  }
}

TEST(Triangulate, SplitsVerticesAsTheCrackSays) {
  const auto extra = [](const Mesh& m) { return split_at_cracks(m).vertex.size() - m.points.size(); };
  const Mesh inner = triangulate(with_cracks({{"c", {{-1, 0}, {0.2, 0.3}, {1, 0}}}}), {.size = 0.2});
  EXPECT_EQ(extra(inner), inner.cracks[0].size() - 1);
  const Mesh edge = triangulate(with_cracks({{"c", {{-2, 0}, {0, 0.1}}}}), {.size = 0.2});
  EXPECT_EQ(extra(edge), edge.cracks[0].size());
  const Mesh through = triangulate(with_cracks({{"c", {{-2, 0}, {2, 0.1}}}}), {.size = 0.2});
  EXPECT_EQ(extra(through), through.cracks[0].size() + 1);
  std::vector<bool> cut(through.edges.size());
  for (std::size_t e = 0; e < cut.size(); ++e) cut[e] = through.crack[e] != none;
  const auto piece = pieces(through, cut);
  EXPECT_EQ(*std::ranges::max_element(piece), 1);
}

TEST(Triangulate, JoinsCrackEndsGivenInDecimals) {
  // Six decimals: 3e-7 off the circles, at both ends.
  Shape ring{circle("outline", {0, 0}, 1, 0), {circle("h", {0, 0}, 0.5, 1)}, {}, {"outer", "inner"}};
  ring.cracks = {{"c", {{0.707107, 0.707107}, {0.353553, 0.353553}}}};
  const Mesh m = triangulate(ring, {.size = 0.1});
  expect_valid(ring, m);
  EXPECT_EQ(split_at_cracks(m).vertex.size() - m.points.size(), m.cracks[0].size() + 1);
}

TEST(Triangulate, KeepsTheMeanQualityAt20000Triangles) {
  for (const auto& [shape, size] :
       std::vector<std::pair<Shape, double>>{{with_cracks({{"c", {{-1, 0}, {1, 0}}}}), 0.05},
                                             {with_cracks({{"c", {{-2, 0.3}, {0, 0.5}, {1, 0}}}}), 0.05},
                                             {with_holes({circle("h", {0.3, 0.1}, 1, 4)}), 0.04},
                                             {{circle("outline", {0, 0}, 1, 0), {}, {}, {"side"}}, 0.019}}) {
    const Mesh m = triangulate(shape, {.size = size});
    EXPECT_NEAR(double(m.triangles.size()), 20000, 4000);
    EXPECT_GE(quality(m).mean_quality, 0.98);
  }
}

TEST(Triangulate, MeansTheMeanEdgeLength) {
  for (const double size : {0.3, 0.1, 0.07, 0.03}) {
    const Mesh m = triangulate(square(), {.size = size});
    double sum = 0;
    for (std::size_t e = 0; e < m.edges.size(); ++e) sum += length(m, Index(e));
    EXPECT_NEAR(sum / double(m.edges.size()), size, 0.15 * size);
  }
}

TEST(Triangulate, GradesTowardsTips) {
  for (const double tip : {0.05, 0.01, 1e-3, 1e-5, 1e-8}) {
    const Mesh m = triangulate(with_cracks({{"c", {{-1, 0}, {0.9, 0.3}}}}), {.size = 0.1, .crack_tip_size = tip});
    for (const Index e : {m.cracks[0].front().edge, m.cracks[0].back().edge}) {
      EXPECT_GT(length(m, e), tip / 2);
      EXPECT_LT(length(m, e), tip * 2);
    }
    EXPECT_GE(quality(m).min_angle_deg, 25);
    EXPECT_LT(m.triangles.size(), 30000u);
  }
}

TEST(Triangulate, LaysTwoTrianglesAcrossGaps) {
  // A band 0.02 wide below the hole: no triangle may reach from one side to the other.
  const Shape shape = with_holes({polygon("h", {{-1, -1.98}, {1, -1.98}, {1, 0}, {-1, 0}}, 4)});
  const Mesh m = triangulate(shape, {.size = 0.2});
  std::vector<bool> low(m.points.size(), false), high(m.points.size(), false);
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    for (const Index v : m.edges[e]) {
      if (m.label[e] == 0) low[std::size_t(v)] = true;
      if (m.label[e] == 4) high[std::size_t(v)] = true;
    }
  for (const auto& [a, b] : m.edges)
    EXPECT_FALSE((low[std::size_t(a)] && high[std::size_t(b)]) || (low[std::size_t(b)] && high[std::size_t(a)]));
}

/// A square with cracks beneath its top, at depths that go from one to the other.
Shape beneath(double depth_left, double depth_right) {
  Shape shape = square(0.5);
  shape.cracks = {{"c", {{-0.25, 0.5 - depth_left}, {0.25, 0.5 - depth_right}}, {}}};
  return shape;
}

TEST(Triangulate, LaysLongTrianglesAlongLigaments) {
  for (const auto& [left, right] : {std::array{1e-2, 1e-2}, {1e-3, 1e-3}, {1e-4, 1e-4}, {1e-5, 1e-5}, {1e-3, 2e-3}}) {
    const Shape shape = beneath(left, right);
    const Mesh mesh = triangulate(shape, {.size = 0.05, .long_ligaments = true});
    double along = 0, longest = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_GT(area(mesh, Index(t)), 0);
    EXPECT_NEAR(total_area(mesh), 1, 1e-12);
    for (const CrackEdge& c : mesh.cracks[0]) {
      along += length(mesh, c.edge);
      longest = std::max(longest, length(mesh, c.edge));
    }
    EXPECT_NEAR(along, path_length(shape.cracks[0].points), 1e-12);
    EXPECT_LT(longest, 1.5 * 0.05 / 8);
    // The edges grow from the width by a quarter of the distance: a logarithm of the depth, where they would be its
    // inverse.
    EXPECT_LT(mesh.cracks[0].size(), 150 + 40 * std::log10(1e-2 / left)) << left;
  }
  EXPECT_GT(triangulate(beneath(1e-3, 1e-3), {.size = 0.05}).cracks[0].size(), 900);
}

TEST(Triangulate, SeesWhatLiesInALigament) {
  // A crack between, and a ligament that is no longer than a few widths.
  Shape between = beneath(1e-2, 1e-2);
  between.cracks.push_back({"d", {{0, 0.493}, {0.02, 0.497}}, {}});
  const Mesh mesh = triangulate(between, {.size = 0.05, .long_ligaments = true});
  EXPECT_EQ(mesh.cracks[0].size(), triangulate(between, {.size = 0.05}).cracks[0].size());
  Shape wide = beneath(0.02, 0.02);
  EXPECT_EQ(triangulate(wide, {.size = 0.05, .long_ligaments = true}).triangles,
            triangulate(wide, {.size = 0.05}).triangles);
  // Two cracks above each other: both sides of the upper one have a ligament, and one of them is meshed long.
  Shape two = beneath(1e-3, 1e-3);
  two.cracks.push_back({"d", {{-0.2, 0.497}, {0.2, 0.497}}, {}});
  const Mesh both = triangulate(two, {.size = 0.05, .long_ligaments = true});
  EXPECT_NEAR(total_area(both), 1, 1e-12);
  EXPECT_LT(both.triangles.size(), triangulate(two, {.size = 0.05}).triangles.size());
}

TEST(Triangulate, IsDeterministic) {
  Shape shape = with_holes({circle("h", {1, 1}, 0.3, 4), ellipse("e", {-1, -1}, {0.4, 0.1}, 1, 4)});
  shape.cracks = {{"c", {{-2, 0.1}, {0, 0.4}}}, {"d", {{0, -1}, {1.3, -0.3}}}};
  const Mesh a = triangulate(shape, {.size = 0.05}), b = triangulate(shape, {.size = 0.05});
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.crack, b.crack);
}

// The image is an ellipse of aspect 5, with tips where x = 0: a fifth of the edges' length there, the same elsewhere.
TEST(Triangulate, CurvedSidesAreAsFineAsTheirImagesWouldBe) {
  const Shape shape = with_holes({circle("h", {0, 0}, 0.3, 4)});
  const auto longest = [](const Mesh& mesh, const Vec2& at) {
    double all = 0;
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
      const Vec2 middle = 0.5 * (mesh.points[mesh.edges[e][0]] + mesh.points[mesh.edges[e][1]]);
      if (mesh.label[e] == 4 && (middle - at).norm() < 0.05) all = std::max(all, length(mesh, static_cast<Index>(e)));
    }
    return all;
  };
  Sizing sizing{.size = 0.5, .curved = true};
  const Mesh plain = triangulate(shape, sizing);
  sizing.images = {Eigen::DiagonalMatrix<double, 2>(1, 5)};
  const Mesh finer = triangulate(shape, sizing);
  const Vec2 tip(0, 0.3), flank(0.3, 0);
  EXPECT_NEAR(longest(finer, tip) / longest(plain, tip), 0.2, 0.08);
  EXPECT_GT(longest(finer, flank), 0.5 * longest(plain, flank));
}

TEST(Triangulate, KeepsSmallInputAnglesAndEndsThere) {
  for (const double angle : {20.0, 5.0, 1.0, 0.1}) {
    const double rise = std::tan(angle * pi / 180);
    const Shape wedge{polygon("outline", {{0, 0}, {2, 0}, {2, 2 * rise}}, 0), {}, {}, {"side"}};
    const Mesh m = triangulate(wedge, {.size = 0.1});
    expect_valid(wedge, m);
    EXPECT_NEAR(total_area(m), 2 * rise, 1e-10);
    const Shape shallow = with_cracks({{"c", {{-2, 0}, {-2 + rise, 1}}}});
    const Mesh n = triangulate(shallow, {.size = 0.2});
    expect_valid(shallow, n);
    EXPECT_NEAR(total_area(n), 16, 1e-10);
  }
}

TEST(Triangulate, RefinesAtReentrantCornersOnly) {
  const auto shortest = [](double angle) {  // of the body at the middle of the upper side
    const double dent = 2 * std::tan((angle - pi) / 2);
    const Shape plate{polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {0, 2 - dent}, {-2, 2}}, 0), {}, {}, {"side"}};
    return quality(triangulate(plate, {.size = 0.2})).h_min;
  };
  EXPECT_LT(shortest(reentrant_angle + 0.02), 0.02);
  EXPECT_GT(shortest(reentrant_angle - 0.02), 0.1);
}

TEST(Triangulate, SurvivesTinyGaps) {
  for (const double gap : {1e-3, 1e-4, 1e-5, 6e-6}) {
    const Shape tip = with_cracks({{"c", {{0, 0}, {2 - gap, 0}}}});
    expect_valid(tip, triangulate(tip, {.size = 0.2}));
    const Shape tips = with_cracks({{"c", {{-1, 0}, {0, 0}}}, {"d", {{gap, 0}, {1, 0.1}}}});
    expect_valid(tips, triangulate(tips, {.size = 0.2}));
    Shape hole = with_holes({circle("h", {0, 2 - 0.5 - gap}, 0.5, 4)});
    const Mesh m = triangulate(hole, {.size = 0.2});
    expect_valid(hole, m);
    EXPECT_GE(quality(m).min_angle_deg, 25);
  }
  const Shape slit = with_holes({polygon("h", {{-1, 0}, {1, 0}, {1, 1e-5}, {-1, 1e-5}}, 4)});
  const Mesh m = triangulate(slit, {.size = 0.2});
  expect_valid(slit, m);
  EXPECT_NEAR(total_area(m), 16 - 2e-5, 1e-10);
}

void expect_error(const Shape& shape, const Sizing& sizing, const std::string& words) {
  try {
    triangulate(shape, sizing);
    FAIL() << "accepted, instead of: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Geometry);
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Triangulate, NamesWhatItRefuses) {
  expect_error(with_cracks({{"c", {{0, 0}, {3, 0}}}}), {.size = 0.1}, "crack 'c' leaves the body at (2, 0)");
  expect_error(square(), {.size = -1}, "mesh.size");
  expect_error(square(), {.size = nan}, "mesh.size");
  expect_error(square(), {.size = 1e-4}, "mesh.size");
  expect_error(square(), {.size = 1e-12}, "mesh.size");
  expect_error(square(), {.size = 0.1, .crack_tip_size = -1}, "mesh.crack_tip_size");
  expect_error(square(), {.size = 0.1, .crack_tip_size = 1e-13}, "mesh.crack_tip_size");
  expect_error(square(), {.size = 0.1, .grading = 0}, "grading");
  expect_error(square(), {.size = 0.1, .min_angle_deg = 40}, "mesh.min_angle");
  expect_error(with_cracks({{"c", {{-1, 0}, {1, 0}}}, {"d", {{-1, 1e-5}, {1, 1e-5}}}}), {.size = 0.1},
               "gap between crack");
}

/// Random plates with holes and cracks, most of them impossible: refused by name, or meshed well.
TEST(Triangulate, RandomShapesAreNamedOrMeshed) {
  int meshed = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const auto pick = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
    Shape shape = square();
    for (int i = int(pick(0, 3)); i > 0; --i) {
      const Vec2 center(pick(-1.9, 1.9), pick(-1.9, 1.9));
      const std::string name(1, char('a' + i));
      const int kind = int(pick(0, 3));
      if (kind == 0) shape.holes.push_back(circle(name, center, std::pow(10, pick(-3, -0.1)), 4));
      if (kind == 1)
        shape.holes.push_back(ellipse(name, center, {pick(0.1, 0.8), std::pow(10, pick(-2, -0.3))}, pick(0, 3), 4));
      if (kind == 2) {
        std::vector<Vec2> corners;
        const int count = int(pick(3, 9));
        for (int k = 0; k < count; ++k)
          corners.push_back(center + pick(0.1, 0.7) * Vec2(std::cos(2 * pi * k / count), std::sin(2 * pi * k / count)));
        shape.holes.push_back(polygon(name, corners, 4));
      }
    }
    for (int i = int(pick(0, 4)); i > 0; --i) {
      Crack crack{std::string(1, char('p' + i)), {{pick(-1.9, 1.9), pick(-1.9, 1.9)}}};
      if (pick(0, 1) < 0.3) crack.points[0].x() = -2;
      for (int k = int(pick(1, 4)); k > 0; --k)
        crack.points.push_back(crack.points.back() + Vec2(pick(-0.8, 0.8), pick(-0.8, 0.8)));
      shape.cracks.push_back(crack);
    }
    SCOPED_TRACE(seed);
    if (const auto problem = find_problem(shape)) {
      EXPECT_NE(problem->find('\''), std::string::npos) << *problem;
      expect_error(shape, {.size = 0.2}, *problem);
      continue;
    }
    const Mesh m = triangulate(shape, {.size = 0.2});
    expect_valid(shape, m);
    EXPECT_GE(quality(m).mean_quality, 0.9);
    ++meshed;
  }
  EXPECT_GE(meshed, 60);
}

}  // namespace
}  // namespace kerf::mesher_test
