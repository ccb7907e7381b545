// Triangles of equal shape share one elimination: what each would give by itself.

#include "kerf/mesher.hpp"
#include "solver/system.hpp"
#include "tests/solver/scenes.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <random>

namespace kerf::alike_test {
namespace {

double off(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
}

void expect_same(const Condensed& a, const Condensed& b, double close) {
  EXPECT_LT(off(a.K, b.K), close);
  EXPECT_EQ(a.K, a.K.transpose().eval());
  EXPECT_LE((a.F - b.F).norm(), close * b.F.norm());
  ASSERT_EQ(a.trace.size(), b.trace.size());
  if (a.trace.size() == 0) return;
  EXPECT_LT(off(a.trace, b.trace), close);
  EXPECT_NEAR(a.own, b.own, close * (std::abs(b.own) + b.F.norm()));
  EXPECT_NEAR(a.by_theta, b.by_theta, close * std::abs(b.by_theta));
}

class SharedShapes : public testing::TestWithParam<Element> {
 protected:
  const Kernel k = kernel(GetParam());
  std::mt19937 random{11};
  double in() {
    return std::uniform_real_distribution<double>(-1, 1)(random);
  }
};

// Vertices in any order, edges in either direction, frames in or out.
TEST_P(SharedShapes, ATriangleFindsItsOwnHoweverItLies) {
  const std::array<Vec2, 3> corners{Vec2(3, 1), Vec2(3.4, 1.1), Vec2(3.1, 1.5)};
  const Material material = plane_strain(2, 0.4);
  for (const bool forced : {false, true})
    for (const double penalty : {0.0, 1e-3}) {
      Triangle first;
      first.x = corners;
      const SharedShape shape(k, turned(first, 0), material, penalty, forced);
      for (int turn = 0; turn < 3; ++turn)
        for (int flips = 0; flips < 8; ++flips) {
          LocalTriangle t;
          for (int i = 0; i < 3; ++i) t.shape.x[(i + turn) % 3] = corners[i];
          for (int e = 0; e < 3; ++e) {
            t.shape.forward[e] = (flips >> e & 1) != 0;
            t.shape.frame[e] = (in() > 0 ? 1 : -1) * turned(t.shape, 0).frame[e];
          }
          ASSERT_TRUE(can_share(t.shape));
          t.material = &material;
          t.penalty = {.a = penalty, .theta = penalty > 0 ? in() : 0};
          t.force.resize(forced ? displacement_count(k.element) : 0);
          for (double& f : t.force) f = in();
          LocalTriangle by_shape = t;
          by_shape.shared = &shape;
          by_shape.turn = turn;
          std::array<Condensed, 2> found;
          const std::array both{by_shape, t};
          condense(k, both, found);
          expect_same(found[0], found[1], 1e-9);
          Eigen::MatrixXd interior(interior_count(k.element), 2);
          std::array<Recovered, 2> back;
          back[0].m.resize(skeleton_count(k.element));
          for (double& m : back[0].m) m = in();
          back[1].m = back[0].m;
          for (int i = 0; i < 2; ++i) back[static_cast<std::size_t>(i)].interior = interior.col(i).data();
          interiors(k, both, back);
          EXPECT_LT(off(interior.col(0), interior.col(1)), 1e-9);
          EXPECT_LT(off(back[0].forces.of_trace, back[1].forces.of_trace), 1e-9);
          EXPECT_LE((back[0].forces.given - back[1].forces.given).norm(), 1e-9 * back[1].forces.given.norm());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Elements, SharedShapes, testing::Values(bdms(1), bdms(3), bdms(4), afw(1), afw(2)),
                         [](const auto& info) { return fmt::format("{}{}", info.param.name, info.param.degree); });

Shape square_with_a_disc() {
  Shape shape;
  shape.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0);
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  shape.regions = {circle("disc", {0.5, 0.5}, 0.3, none)};
  shape.labels = {"bottom", "right", "top", "left"};
  return shape;
}

Scene rolling(double poisson) {
  Scene scene;
  scene.material = plane_strain(1, poisson);
  scene.regions = {plane_strain(30, 0.2)};
  scene.supports = {{0, true, true, false,
                     [](const Vec2&, const Vec2&) -> Vec2 {
                       return {0, 0};
                     }},
                    {3, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 {
                       return {0, 0};
                     }}};
  scene.tractions = {{1, [](const Vec2&, const Vec2&) -> Vec2 { return {1, 0.2}; }}};
  return scene;
}

LocalTriangle local_of(const Model& m, Index t) {
  return {triangle(m, t),
          &material_of(m.mesh, m.scene, t),
          force_of(m.inner->system, t),
          {.a = m.inner->system.penalty / material_of(m.mesh, m.scene, t).mu}};
}

// Each material by itself, rollers and supports by themselves, with a force and without.
TEST(CongruentTriangles, MostTrianglesOfAMeshShareAndAllGetTheirOwn) {
  for (const double poisson : {0.3, 0.49999})
    for (const bool forced : {false, true}) {
      Scene scene = rolling(poisson);
      if (forced) scene.body = [](const Vec2& x) -> Vec2 { return {x.y(), 1 - x.x()}; };
      const Model m = prepare(triangulate(square_with_a_disc(), {.size = 0.025}), bdms(2), std::move(scene), 2);
      const CongruentTriangles& alike = *m.inner->system.alike;
      const auto triangles = static_cast<Index>(m.mesh.triangles.size());
      EXPECT_GT(alike.shared(), triangles / 2);
      EXPECT_LT(alike.shared(), triangles);
      Index shared = 0;
      for (Index t = 0; t < triangles; ++t) {
        const LocalTriangle own = local_of(m, t);
        LocalTriangle like = own;
        alike.share(t, like);
        if (!like.shared) continue;
        ++shared;
        std::array<Condensed, 2> found;
        condense(m.inner->kernel, std::array{like, own}, found);
        expect_same(found[0], found[1], 1e-9);
      }
      EXPECT_EQ(shared, alike.shared());
      EXPECT_TRUE(certified(solve(m)));
    }
}

TEST(CongruentTriangles, OtherLoadsOnTheSameBodyAreNotOverlooked) {
  const Model plain = prepare(triangulate(square_with_a_disc(), {.size = 0.05}), bdms(1), rolling(0.3), 1);
  ASSERT_GT(plain.inner->system.alike->shared(), 0);
  Scene heavy = rolling(0.3);
  heavy.body = [](const Vec2&) -> Vec2 { return {0, -1}; };
  const State by_factor = solve(with_loads(plain, heavy)), anew = solve(prepare(Mesh(plain.mesh), bdms(1), heavy, 1));
  EXPECT_LT(off(by_factor.interior, anew.interior), 1e-10);
}

// Near nu = 1/2 the iterations take the mean trace that loads cause in a triangle: that of the loads before is gone,
// also where the next ones are none.
TEST(CongruentTriangles, LoadsBeforeLeaveNothingBehind) {
  const Mesh mesh = triangulate(square_with_a_disc(), {.size = 0.2});
  const auto swelling = [](const Vec2& x) -> Vec2 { return {1 + x.x(), 2}; };
  for (const Element& e : {bdms(1), bdms(2)}) {
    Scene strained = rolling(0.49999);
    strained.body = [](const Vec2& x) -> Vec2 { return {x.y(), -1 - x.x() * x.x()}; };
    for (int region = 0; region < 2; ++region) strained.eigenstrain.push_back({.normal = swelling, .shear = swelling});
    const Model before = prepare(Mesh(mesh), e, strained, 1);
    ASSERT_GT(before.inner->system.penalty, 0);
    const State by_factor = solve(with_loads(before, rolling(0.49999))),
                anew = solve(prepare(Mesh(mesh), e, rolling(0.49999), 1));
    EXPECT_LT(off(by_factor.interior, anew.interior), 1e-9) << e.degree;
  }
}

TEST(CongruentTriangles, StrainedBodiesAndFewTrianglesShareNothing) {
  Scene strained = rolling(0.3);
  const auto swelling = [](const Vec2&) -> Vec2 { return {1e-3, 2e-3}; };
  strained.eigenstrain.push_back({.normal = swelling, .shear = swelling});
  EXPECT_EQ(prepare(triangulate(square_with_a_disc(), {.size = 0.05}), bdms(1), std::move(strained), 1)
                .inner->system.alike->shared(),
            0);
  EXPECT_EQ(
      prepare(triangulate(square_with_a_disc(), {.size = 0.5}), bdms(1), rolling(0.3), 1).inner->system.alike->shared(),
      0);
}

}  // namespace
}  // namespace kerf::alike_test
