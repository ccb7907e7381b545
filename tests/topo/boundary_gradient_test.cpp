// The derivative by the shape as a density on the free boundary.

#include "kerf/shape_gradient.hpp"

#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::boundary_gradient_test {
namespace {

using namespace scenes;

// The boundary form tends to the distributed one; of order 2, which is that of the polygon to its circle.
TEST(BoundaryGradient, TendsToTheDistributedForm) {
  const Vec2 center(0.2, 0.3);
  Shape shape = rectangle({-1, -1}, {1, 1});
  shape.labels.push_back("hole");
  shape.holes = {circle("hole", center, 0.3, 4)};
  shape.cracks = {{"crack", {Vec2(-0.6, -0.5), Vec2(0.1, -0.5)}}};
  Scene scene = pulled(plane_strain(1, 0.3), [](const Vec2& x) { return Vec2(0.1, 1 + x.x()); });
  scene.body = [](const Vec2& x) { return Vec2(0.1, -0.5 + 0.2 * x.y()); };
  const auto weight = [](const Vec2& x) { return 1 + 0.3 * x.x(); };
  const std::vector<Term> terms = {energy(),
                                   compliance(),
                                   displacement_tracking({}, weight),
                                   boundary_tracking(2, {}, {}),
                                   stress_pnorm(4, weight, true),
                                   misfit(2, [](const Vec2& x, const Vec2&) { return Vec2(0.1 * x.x(), 1); }),
                                   energy_release_rate({0.1, -0.5}, {1, 0}, {0.1, 0.3}, scene.body),
                                   crack_opening(0, {})};
  const auto theta = [&](const Vec2& x) -> Vec2 {
    const Vec2 d = x - center;
    const double r = std::max(0.0, 1 - d.squaredNorm() / 0.36);
    return r * r * r * Vec2(1 + d.y(), 0.5 - 2 * d.x() * d.y() + 2 * d.y());
  };
  std::vector<std::vector<double>> apart(terms.size());
  for (const double size : {0.05, 0.025}) {
    const Model model =
        prepare(triangulate(shape, {.size = size, .crack_tip_size = size}), element("bdms", 2), scene, 2);
    const State state = solve(model);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const Functional j{"", {terms[i]}};
      const Analysis a = analyze(j, model, state);
      const Points gradient = shape_gradient(a, j);
      double distributed = 0, boundary = 0;
      for (std::size_t v = 0; v < model.mesh.points.size(); ++v)
        distributed += gradient.col(static_cast<Eigen::Index>(v)).dot(theta(model.mesh.points[v]));
      for (const kerf::BoundaryGradient::Point& p : boundary_gradient(a, j).points) {
        EXPECT_NE(model.mesh.label[p.edge], 0);
        EXPECT_NE(model.mesh.label[p.edge], 2);
        boundary += p.weight * p.density * theta(p.at).dot(p.normal);
      }
      apart[i].push_back(std::abs(boundary / distributed - 1));
    }
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double order = std::log2(apart[i][0] / apart[i][1]);
    EXPECT_GT(order, 1.7) << terms[i].kind << " " << apart[i][0] << " " << apart[i][1];
    EXPECT_LT(apart[i][1], 0.035) << terms[i].kind;
  }
}

// Without a label there is neither support nor load. One with a load of zero is as free, one with another is not.
TEST(BoundaryGradient, IsOnWhatIsFree) {
  Shape shape = rectangle({-1, -1}, {1, 1});
  shape.labels.push_back("hole");
  const Scene scene = pulled(plane_strain(1, 0.3), [](const Vec2&) { return Vec2(0.1, 1); });
  const Functional j{"", {compliance()}};
  const auto gradient = [&](Index label, const Vec2& load) {
    shape.holes = {circle("hole", {0.1, 0.2}, 0.3, label)};
    Scene loaded = scene;
    loaded.laws.clear();
    if (label != none) loaded.tractions.push_back({label, [load](const Vec2&, const Vec2&) { return load; }});
    const Model m = prepare(triangulate(shape, {.size = 0.4}), element("bdms", 1), loaded, 1);
    const State state = solve(m);
    return boundary_gradient(analyze(j, m, state), j).points;
  };
  const auto unlabeled = gradient(none, {0, 0}), at_rest = gradient(4, {0, 0}), pushed = gradient(4, {0, 0.1});
  ASSERT_EQ(unlabeled.size(), at_rest.size());
  std::size_t on_hole = 0;
  for (std::size_t i = 0; i < unlabeled.size(); ++i) {
    EXPECT_NEAR(unlabeled[i].density, at_rest[i].density, 1e-12);
    if (unlabeled[i].at.cwiseAbs().maxCoeff() < 0.9) ++on_hole;
  }
  EXPECT_GT(on_hole, 20u);
  EXPECT_EQ(pushed.size(), at_rest.size() - on_hole);
}

}  // namespace
}  // namespace kerf::boundary_gradient_test
