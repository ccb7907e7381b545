// A stop that is asked for while something long goes on: what is done comes back, nothing else is begun.

#include "kerf/stop.hpp"

#include "kerf/adaptive.hpp"
#include "kerf/validate.hpp"

#include <gtest/gtest.h>

namespace kerf::stop_test {
namespace {

class Stop : public testing::Test {
 protected:
  void TearDown() override {
    forget_stop();
  }
  Shape square{.outline = {"", {{{0, 0}, 0}, {{1, 0}, 1}, {{1, 1}, 2}, {{0, 1}, 3}}}, .labels = {"a", "b", "c", "d"}};
  Scene scene{.material = plane_strain(1, 0.3),
              .supports = {{.label = 0,
                            .value = [](const Vec2&, const Vec2&) -> Vec2 {
                              return {0, 0};
                            }}},
              .tractions = {{.label = 2, .value = [](const Vec2& x, const Vec2&) -> Vec2 {
                               return {x.x(), 1};
                             }}}};
};

TEST_F(Stop, ActsBeforeTheNextFactorizationAndSolution) {
  const Mesh mesh = triangulate(square, {.size = 0.3});
  const Model model = prepare(mesh, element("bdms"), scene, 1);
  request_stop();
  EXPECT_THROW(prepare(mesh, element("bdms"), scene, 1), Stopped);
  EXPECT_THROW(solve(model), Stopped);
  EXPECT_THROW(triangulate(square, {.size = 0.3}), Stopped);
  forget_stop();
  EXPECT_TRUE(certified(solve(model)));
}

TEST_F(Stop, LeavesTheLastRoundOfARefinement) {
  int meshes = 0;
  std::size_t first = 0;
  Adaptation how{.error = 1e-6};
  how.meshed = [&](const Mesh& mesh) {
    if (++meshes == 1) first = mesh.triangles.size();
    if (meshes == 2) request_stop();
  };
  const Adapted a = solve_adaptively(square, {.size = 0.3}, element("bdms"), scene, how);
  EXPECT_EQ(a.stopped, "stopped on request");
  EXPECT_EQ(a.model.mesh.triangles.size(), first);
  EXPECT_EQ(a.rounds.size(), 1u);
  EXPECT_TRUE(certified(a.state));
  EXPECT_EQ(meshes, 2);
  // In the first round there is nothing to leave.
  EXPECT_THROW(solve_adaptively(square, {.size = 0.3}, element("bdms"), scene, {.error = 1e-6}), Stopped);
}

TEST_F(Stop, SaysOfWhatWasNotValidatedThatNothingWasSaid) {
  // The loads are asked for on every mesh: first on that of the body, then on that with the balls.
  int asked = 0, most = 1 << 30;
  Scene counted = scene;
  counted.tractions[0].value = [&](const Vec2& x, const Vec2&) -> Vec2 {
    if (++asked > most) request_stop();
    return {x.x(), 1};
  };
  solve_graded(square, {.size = 0.2}, element("bdms"), counted, {});
  most = asked + 1;
  asked = 0;
  const Functional j{.kind = "compliance", .terms = {compliance()}};
  const ValidationRequest request{.points = {{0.5, 0.5}}, .radii = {0.1, 0.05, 0.025, 0.0125}};
  const std::vector<Validation> done = validate({square, {.size = 0.2}}, element("bdms"), counted, j, request);
  ASSERT_TRUE(stop_requested());
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].verdict, Verdict::NothingSaid);
  EXPECT_EQ(done[0].reason, "stopped before this point was done");
}

}  // namespace
}  // namespace kerf::stop_test
