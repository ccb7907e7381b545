// Bodies with curved sides against closed forms: meshes draw chords.

#include "tests/truth/scene.hpp"

#include "base/quadrature.hpp"
#include "kerf/adaptive.hpp"
#include "solver/system.hpp"

#include <cmath>

namespace kerf::curved_test {
namespace {

using nlohmann::json;

constexpr double inner = 0.5, outer = 1, pressure = 0.01;

// Lame's annulus under internal pressure, a quarter of it on rollers.
const char* const annulus = R"(
[domain]
outline = [{ arc_to = [0.5, 0], center = [0, 0] }, [1, 0], { arc_to = [0, 1], center = [0, 0] }, [0, 0.5]]
sides = ["bottom", "outside", "left", "inside"]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "inside"
pressure = 0.01
[[boundary]]
on = "left"
displacement_x = 0
[[boundary]]
on = "bottom"
displacement_y = 0
[mesh]
size = 0.2
)";

Mat2 lame(const Vec2& x) {
  const double scale = pressure * inner * inner / (outer * outer - inner * inner), r = x.norm();
  const double radial = scale * (1 - outer * outer / (r * r)), hoop = scale * (1 + outer * outer / (r * r));
  const Vec2 n = x / r, t(-n.y(), n.x());
  return radial * n * n.transpose() + hoop * t * t.transpose();
}

TEST_F(Truth, ReachedIsOfTheBodyNotOfItsPolygon) {
  const std::filesystem::path file = folder / "annulus.toml";
  std::ofstream(file) << annulus;
  const Case c = read_case(file);
  struct Row {
    int degree;
    double wanted;
    int divisions;  // of the mesh of each round, whose chords stay as long as they are
  };
  for (const auto& [degree, wanted, divisions] :
       {Row{1, 1e-2, 0}, Row{1, 3e-3, 0}, Row{2, 1e-2, 0}, Row{2, 3e-3, 0}, Row{1, 1e-2, 1}, Row{2, 3e-3, 2}}) {
    const Adapted a = solve_adaptively(c.shape, c.sizing, bdms(degree), c.scene,
                                       {.error = wanted, .threads = 2, .divisions = divisions});
    ASSERT_TRUE(a.stopped.starts_with("reached")) << a.stopped;
    const TriangleRule rule = triangle_rule(8);
    double difference = 0, size = 0;
    for (Index t = 0; t < static_cast<Index>(a.model.mesh.triangles.size()); ++t) {
      const Triangle shape = triangle(a.model, t);
      const Points x = rule_points(rule, shape);
      const Eigen::Matrix4Xd s = evaluate(a.model, a.state, t, x).stress;
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const Mat2 exact = lame(x.col(q));
        difference += area(shape) * rule.w[q] *
                      (s.col(q) - Eigen::Vector4d(exact(0, 0), exact(0, 1), exact(1, 0), exact(1, 1))).squaredNorm();
        size += area(shape) * rule.w[q] * exact.squaredNorm();
      }
    }
    EXPECT_LE(std::sqrt(difference / size), wanted) << degree << " " << divisions;
  }
}

// E = -p^2 pi a / 4 u_r(a): the bounds of chords may miss it, and say whose they are.
TEST_F(Truth, BoundsOfChordsSayThatTheyAreOfThePolygon) {
  const json state = run_scene(annulus, Job::Solve, {"mesh.curved=false"})["state"];
  EXPECT_EQ(state["energy_bounds_of"], "polygon");
  EXPECT_EQ(run_scene(annulus)["state"]["energy_bounds_of"], "body");
  const json straight =
      run_scene(annulus, Job::Solve, {"domain.outline=[[0.5, 0], [1, 0], [0, 1], [0, 0.5]]"})["state"];
  EXPECT_EQ(straight["energy_bounds_of"], "body");
}

}  // namespace
}  // namespace kerf::curved_test
