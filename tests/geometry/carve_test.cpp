#include "geometry/carve.hpp"

#include "geometry/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace kerf {
namespace {

constexpr double pi = std::numbers::pi;
using Field = std::function<double(const Vec2&)>;

Shape plate(double width = 2, double height = 1) {
  Shape shape{polygon("outline", {{0, 0}, {width, 0}, {width, height}, {0, height}}, 0), {}, {}, {}};
  shape.labels = {"bottom", "right", "top", "left", "hole"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[std::size_t(i)].label = i;
  return shape;
}

/// Edges of one length everywhere, at cracks too.
Mesh uniform(const Shape& shape, double size) {
  const Mesh coarse = triangulate(shape, {.size = size});
  const std::vector<double> sizes(coarse.points.size(), size);
  return triangulate(shape, {.size = size}, {&coarse, sizes});
}

Eigen::VectorXd values(const Mesh& mesh, const Field& phi) {
  Eigen::VectorXd f(Index(mesh.points.size()));
  for (Index v = 0; v < f.size(); ++v) f[v] = phi(mesh.points[std::size_t(v)]);
  return f;
}

Field void_circle(const Vec2& center, double radius) {
  return [=](const Vec2& x) { return radius - (x - center).norm(); };
}
Field both(Field f, Field g) {  // the material of both
  return [=](const Vec2& x) { return std::max(f(x), g(x)); };
}

double total_area(const Mesh& m) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) sum += area(m, Index(t));
  return sum;
}
double length_of(const Mesh& m, Index label) {
  double sum = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (m.label[e] == label) sum += length(m, Index(e));
  return sum;
}
bool says(const Carved& carved, const std::string& words) {
  return std::any_of(carved.notes.begin(), carved.notes.end(),
                     [&](const std::string& n) { return n.find(words) != std::string::npos; });
}

TEST(Carve, zero_line_of_a_circle) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Eigen::VectorXd phi = values(mesh, void_circle({1, 0.5}, 0.3));
  double length = 0, moment = 0;
  for (const ZeroPiece& p : zero_line(mesh, phi)) {
    length += (p.b - p.a).norm();
    moment += cross(p.a - Vec2(1, 0.5), p.b - Vec2(1, 0.5));
  }
  EXPECT_NEAR(length, 2 * pi * 0.3, 5e-3);
  EXPECT_NEAR(moment / 2, -pi * 0.09, 1e-3);  // clockwise around the hole
  EXPECT_NEAR(negative_area(mesh, phi), 2 - pi * 0.09, 1e-3);
  EXPECT_NEAR(negative_area(mesh, phi), 2 + moment / 2, 1e-12);
}

TEST(Carve, hole) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Eigen::VectorXd phi = values(mesh, void_circle({1, 0.5}, 0.3));
  const Carved carved = carve(plate(), mesh, phi, {.tolerance = 0.005, .spacing = 0.05});
  ASSERT_EQ(carved.shape.holes.size(), 1u);
  EXPECT_EQ(carved.shape.labels.back(), "design");
  EXPECT_EQ(carved.design_label, 5);
  EXPECT_EQ(carved.shape.outline.sides.size(), 4u);
  EXPECT_TRUE(carved.notes.empty()) << carved.notes.front();
  EXPECT_NEAR(carved.area, negative_area(mesh, phi), 1e-6);
  for (const Side& side : carved.shape.holes[0].sides) EXPECT_NEAR((side.start - Vec2(1, 0.5)).norm(), 0.3, 0.005);
  EXPECT_GE(carved.shape.holes[0].sides.size(), 30u);
  EXPECT_LE(carved.shape.holes[0].sides.size(), 40u);
  const Mesh result = triangulate(carved.shape, {.size = 0.05});
  EXPECT_NEAR(total_area(result), carved.area, 1e-12);
  EXPECT_LT(double(result.triangles.size()), 1.2 * double(mesh.triangles.size()));
}

TEST(Carve, over_the_outline) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Eigen::VectorXd phi = values(mesh, both(void_circle({1, 1}, 0.4), void_circle({2, 0}, 0.3)));
  const Carved carved = carve(plate(), mesh, phi, {.tolerance = 0.005, .spacing = 0.05});
  EXPECT_TRUE(carved.shape.holes.empty());
  EXPECT_NEAR(carved.area, negative_area(mesh, phi), 1e-6);
  const Mesh result = triangulate(carved.shape, {.size = 0.05});
  EXPECT_NEAR(total_area(result), carved.area, 1e-12);
  EXPECT_NEAR(length_of(result, 2), 1.2, 0.005);  // top
  EXPECT_NEAR(length_of(result, 0), 1.7, 0.005);
  EXPECT_NEAR(length_of(result, 1), 0.7, 0.005);
  EXPECT_NEAR(length_of(result, 3), 1, 1e-12);
  EXPECT_NEAR(length_of(result, 5), pi * 0.4 + pi / 2 * 0.3, 1e-2);
  EXPECT_EQ(std::ranges::count_if(carved.shape.outline.sides, [](const Side& s) { return s.label == 2; }), 2);
}

TEST(Carve, island_is_dropped) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Field ring = [](const Vec2& x) {
    const double r = (x - Vec2(1, 0.5)).norm();
    return std::min(r - 0.15, 0.35 - r);
  };
  const Eigen::VectorXd phi = values(mesh, ring);
  const Carved carved =
      carve(plate(), mesh, phi, {.tolerance = 0.005, .spacing = 0.05, .keep = {1, 3}, .holding = {3}});
  EXPECT_EQ(carved.shape.holes.size(), 1u);
  EXPECT_NEAR(carved.area, 2 - pi * 0.35 * 0.35, 2e-3);
  EXPECT_TRUE(says(carved, "island"));
}

TEST(Carve, crack_is_cut) {
  Shape frame = plate();
  frame.cracks = {{"c", {{0.4, 0.5}, {1.6, 0.5}}, {}}};
  const Mesh mesh = uniform(frame, 0.05);
  const Eigen::VectorXd phi = values(mesh, void_circle({1, 0.52}, 0.2));
  const Carved carved = carve(frame, mesh, phi, {.tolerance = 0.005, .spacing = 0.05});
  ASSERT_EQ(carved.shape.cracks.size(), 2u);
  EXPECT_EQ(carved.shape.cracks[0].name, "c");
  EXPECT_EQ(carved.shape.cracks[1].name, "c.2");
  EXPECT_EQ(carved.crack_of, (std::vector<Index>{0, 0}));
  const double half = std::sqrt(0.04 - 0.0004);
  EXPECT_NEAR(path_length(carved.shape.cracks[0]), 0.6 - half, 0.005);
  EXPECT_NEAR(path_length(carved.shape.cracks[1]), 0.6 - half, 0.005);
  const Mesh result = triangulate(carved.shape, {.size = 0.05});
  EXPECT_EQ(result.cracks.size(), 2u);
}

}  // namespace
}  // namespace kerf
