// What is drawn for a validation comes from elsewhere than the formula: where it is something else, nothing holds.

#include "tests/topo/validation.hpp"
#include "topo/validate/changed_scene.hpp"

#include <gtest/gtest.h>

namespace kerf::drawn_scene_test {
namespace {

using namespace scenes;

TEST(DrawnScene, ABodyThatIsDrawnOtherwiseDoesNotHold) {
  const Material matrix = plane_strain(1, 0.3);
  Scene scene = pulled(matrix, opens);
  scene.laws.clear();
  const auto across = [](double e33) {
    return Eigenstrain{[=](const Vec2&) -> Vec2 { return Vec2::Constant(0.3 * e33); },
                       [=](const Vec2&) { return Vec2(0, e33); }, true};
  };
  scene.eigenstrain = {across(0.5)};
  const Shape shape = rectangle({-1, -1}, {1, 1});
  const Functional j{"", {boundary_displacement(2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }, {})}};
  const auto verdict = [&](const ScenesOfChanges& drawn) {
    ValidationRequest r{{{0.1, 0.2}}, {0.1, 0.05, 0.025}, {Perturbation::Kind::Inclusion, plane_strain(1, 0.15)}, 2};
    r.scenes = drawn;
    return validate({shape, {.size = 0.25}}, element("bdms", 2), scene, j, r)[0];
  };
  EXPECT_EQ(verdict({}).verdict, Verdict::Holds) << verdict({}).reason;
  // With the host's Poisson's ratio, as if the plane problem saw the same inside.
  const ScenesOfChanges wrong = [&](const Perturbation& p, const DrawnChangeAt&) {
    Scene with = scene;
    with.regions.push_back(p.inclusion);
    with.eigenstrain.resize(2);
    with.eigenstrain[1] = across(0.5);
    return with;
  };
  const Validation v = verdict(wrong);
  EXPECT_EQ(v.verdict, Verdict::Fails) << v.reason;
  EXPECT_NE(v.reason.find("say it again"), std::string::npos) << v.reason;
}

// The library's own rule: the last region, with the eigenstrain of its place as the plane problem sees it there.
TEST(DrawnScene, OfTheLibraryTakesTheEigenstrainOfThePlace) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.regions = {plane_strain(2, 0.2)};
  s.eigenstrain = {{[](const Vec2&) { return Vec2(1 + 0.3, 2 + 0.3); }, [](const Vec2&) { return Vec2(3, 1); }, true}};
  const Perturbation p{Perturbation::Kind::Inclusion, plane_strain(5, 0.1)};
  const Scene body = changed_scene(s, 4, p, {}, {none, {0, 0}, 0.1});
  ASSERT_EQ(body.eigenstrain.size(), 3u);
  EXPECT_NEAR((body.eigenstrain[2].normal({0, 0}) - Vec2(1.1, 2.1)).norm(), 0, 1e-14);
  EXPECT_EQ(body.eigenstrain[2].shear({0, 0}), Vec2(3, 1));
  const Scene region = changed_scene(s, 4, p, {}, {0, {0, 0}, 0.1});
  EXPECT_FALSE(region.eigenstrain.size() > 2 && region.eigenstrain[2]);
  EXPECT_EQ(changed_scene(s, 4, {Perturbation::Kind::ClampedHole}, {}, {}).supports.back().label, 4);
  EXPECT_EQ(changed_scene(s, 4, {Perturbation::Kind::Crack}, {}, {}).laws.size(), 1u);
}

}  // namespace
}  // namespace kerf::drawn_scene_test
