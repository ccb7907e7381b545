// Cook's membrane: the tip deflection of a clamped, sheared panel, with singular corners.

#include "kerf/mesher.hpp"
#include "tests/solver/scenes.hpp"

#include <gtest/gtest.h>

namespace kerf::cook_test {
namespace {

Shape membrane() {
  Shape shape;
  shape.outline = polygon("membrane", {{0, 0}, {48, 44}, {48, 60}, {0, 44}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  return shape;
}

// Graded towards the clamped corners, where the stress is singular.
Mesh graded(double size, double smallest) {
  const Shape shape = membrane();
  Mesh mesh = triangulate(shape, {.size = size});
  for (int round = 0; round < 3; ++round) {
    Background background{&mesh, {}};
    for (const Vec2& x : mesh.points) {
      const double r = std::min((x - Vec2(0, 0)).norm(), (x - Vec2(0, 44)).norm());
      background.size.push_back(std::clamp(0.4 * r, smallest, size));
    }
    mesh = triangulate(shape, {.size = size, .grading = 0.4}, background);
  }
  return mesh;
}

struct Case {
  const char* name;
  Material material;
  double deflection;
};

class Cook : public testing::TestWithParam<Case> {};

TEST_P(Cook, DeflectionOfTheTip) {
  Scene scene;
  scene.material = GetParam().material;
  scene.supports.push_back({3, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }});
  scene.tractions.push_back({1, [](const Vec2&, const Vec2&) { return Vec2(0, 1.0 / 16); }});
  const Vec2 tip(48, 52);
  const Model m = prepare(graded(3, 1e-3), element("bdms", 3), scene, 1);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  const Index t = locate(m.mesh, std::vector<Vec2>{tip})[0];
  ASSERT_NE(t, none);
  // 7e-7 at most; the references have eight digits.
  EXPECT_NEAR(recovered_displacement(m, s, t, tip)(1, 0) / GetParam().deflection, 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Materials, Cook,
                         testing::Values(Case{"nu_3", plane_strain(1, 0.3), 21.945019},
                                         Case{"nu_49", plane_strain(1, 0.49), 18.736729},
                                         Case{"nu_4999", plane_strain(1, 0.4999), 18.511925},
                                         Case{"nu_499999", plane_strain(1, 0.499999), 18.509645},
                                         Case{"plane_stress", plane_stress(1, 1.0 / 3), 23.967741}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace kerf::cook_test
