#include "solver/stress.hpp"

#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::stress_test {
namespace {

TEST(Stress, ScalarsOfKnownStresses) {
  const Eigen::Vector4d pull(2, 0, 0, 0), shear(0, 3, 3, 0), pressure(-1, 0, 0, -1);
  const Material flat = plane_stress(1, 0.3), deep = plane_strain(1, 0.25);
  EXPECT_NEAR(von_mises(flat, false, pull), 2, 1e-15);
  EXPECT_NEAR(von_mises(flat, false, shear), 3 * std::sqrt(3.0), 1e-14);
  // s33 = 2 nu s11 under equal stresses: the deviator is (1 - 2 nu) of them.
  EXPECT_NEAR(von_mises(deep, true, pressure), 0.5, 1e-15);
  EXPECT_EQ(symmetric_part({1, 2, 4, 5}), Eigen::Vector3d(1, 5, 3));
  const PrincipalStresses p = principal_stresses({1, 2, 2, 4});
  EXPECT_NEAR(p.first, 5, 1e-15);
  EXPECT_NEAR(p.second, 0, 1e-15);
}

// A bracket on its lower side, with a kinked crack.
TEST(Stress, SingularPointsAreCornersEndsOfSupportsTipsAndKinks) {
  const std::vector<Vec2> crack = {{0.3, 0.5}, {0.6, 0.5}, {0.8, 0.8}};
  Shape shape;
  shape.labels = {"free", "held"};
  shape.outline = polygon("bracket", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0);
  shape.outline.sides[0].label = 1;
  shape.cracks = {{"kinked", crack, {}}};
  Scene scene;
  scene.material = plane_strain(1, 0.3);
  scene.supports = {{1, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }}};
  scene.laws.resize(1);
  const Model m = prepare(triangulate(shape, {.size = 0.5}), element("bdms"), scene, 1, {.factorize = false});
  std::vector<Vec2> expected = crack;
  for (const Vec2& x : {Vec2(0, 0), Vec2(2, 0), Vec2(1, 1)}) expected.push_back(x);
  const std::vector<Vec2> found = singular_points(m);
  EXPECT_EQ(found.size(), expected.size());
  for (const Vec2& x : expected)
    EXPECT_TRUE(std::ranges::any_of(found, [&](const Vec2& y) { return (x - y).norm() < 1e-12; })) << x.transpose();
}

// Behind rollers that it meets squarely a joint goes on as its own mirror image: no end, unless it slants or the side
// is free.
TEST(Stress, SingularPointsAreNotWhereAJointMeetsRollersSquarely) {
  for (const double slant : {0.0, 0.3})
    for (const bool held : {true, false}) {
      const std::vector<Vec2> joint = {{0, 1}, {2, 1 + slant}};
      Shape shape;
      shape.labels = {"free", "left"};
      shape.outline = polygon("blocks", {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, 0);
      shape.outline.sides[3].label = 1;
      shape.cracks = {{"joint", joint, {}}};
      Scene scene;
      scene.material = plane_strain(1, 0.3);
      const auto zero = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
      if (held) scene.supports = {{1, false, true, false, zero}};
      if (!held) scene.supports = {{1, false, true, true, zero}};
      scene.laws = {{.friction = 0.1}};
      const Mesh mesh = triangulate(shape, {.size = 0.5});
      Model m;
      m.mesh = mesh, m.scene = scene;
      const std::vector<Vec2> found = singular_points(m);
      const auto has = [&](const Vec2& x) {
        return std::ranges::any_of(found, [&](const Vec2& y) { return (x - y).norm() < 1e-12; });
      };
      EXPECT_EQ(has(joint[0]), !held || slant != 0) << slant;
      EXPECT_TRUE(has(joint[1]));
      EXPECT_EQ(ends_inside(mesh), (std::vector<std::array<bool, 2>>{{false, false}}));
    }
}

}  // namespace
}  // namespace kerf::stress_test
