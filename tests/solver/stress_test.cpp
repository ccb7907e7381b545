// Von Mises and principal stresses of known tensors, and the points where the stress of a body is singular, by hand.

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

// Behind rollers the body goes on as its mirror image: corners of up to a right angle with free or fixed sides are
// none, as where the rim of a hole meets a plane of symmetry. What stands beside them tells them apart.
TEST(Stress, SingularPointsAreNotWhereRollersMeetSidesSquarely) {
  struct Corner {
    double angle;
    bool other_held;
    int rollers;  // on how many of its sides
    bool singular;
  };
  for (const auto& [angle, other_held, rollers, singular] :
       {Corner{90, false, 1, false}, Corner{60, false, 1, false}, Corner{110, false, 1, true},
        Corner{90, true, 1, false}, Corner{110, true, 1, true}, Corner{90, false, 2, false},
        Corner{110, false, 2, true}, Corner{90, true, 0, true}, Corner{90, false, 0, false}}) {
    const double t = angle * pi / 180;
    Shape shape;
    shape.labels = {"far", "first", "second"};
    shape.outline = polygon("wedge", {{0, 0}, {1, 0}, {std::cos(t) + 1, std::sin(t)}, {std::cos(t), std::sin(t)}}, 0);
    shape.outline.sides[0].label = 1;
    shape.outline.sides[3].label = 2;
    Model m;
    m.mesh = triangulate(shape, {.size = 0.5});
    m.scene.material = plane_strain(1, 0.3);
    const auto zero = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
    if (rollers > 0) m.scene.supports.push_back({1, true, true, false, zero});
    if (rollers > 1) m.scene.supports.push_back({2, true, true, false, zero});
    if (other_held) m.scene.supports.push_back({2, false, true, true, zero});
    const std::vector<Vec2> found = singular_points(m);
    EXPECT_EQ(std::ranges::any_of(found, [](const Vec2& y) { return y.norm() < 1e-12; }), singular)
        << angle << ' ' << other_held << ' ' << rollers;
  }
  Shape quarter;
  quarter.labels = {"free", "below", "left"};
  quarter.outline = polygon("quarter", {{1, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 1}}, 0);
  quarter.outline.sides[0].label = 1;
  quarter.outline.sides[3].label = 2;
  quarter.outline.sides[4].arc = Arc{{0, 0}, Mat2::Identity(), pi / 2, 0};
  Model m;
  m.mesh = triangulate(quarter, {.size = 0.7, .curved = true});
  m.scene.material = plane_strain(1, 0.3);
  const auto zero = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  m.scene.supports = {{1, false, false, true, zero}, {2, false, true, false, zero}};
  EXPECT_TRUE(singular_points(m).empty());
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
