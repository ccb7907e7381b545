// Derivatives of every functional by the adjoint, for load and Young's modulus, against central differences of whole
// solves.

#include "kerf/analysis.hpp"

#include "tests/support/exact.hpp"
#include "tests/topo/validation.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/young_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::functional_test {
namespace {

// [-2, 2]^2 with a crack from (-1, 0) to (1, 0), held at the bottom, loaded on top by t (0.1, x - 0.3), which closes
// the left part of the crack; region 0 is |x - (0.8, 0.9)| < 0.5.
struct Load {
  double load = 1, young = 2, poisson = 0.3;
  std::string element = "bdms";
  int degree = 1;
  bool closed = false;
};
Model make(const Load& s) {
  Mesh mesh = exact::crack_mesh(8, 0, 0.15, 3);
  mesh.region.assign(mesh.triangles.size(), none);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    if ((centroid(mesh, t) - Vec2(0.8, 0.9)).norm() < 0.5) mesh.region[t] = 0;
  Scene scene;
  scene.material = plane_strain(1, s.poisson);
  scene.regions = {plane_strain(s.young, 0.25)};
  scene.laws.resize(1);
  scene.supports.push_back({0, false, true, true, [](const Vec2& x, const Vec2&) { return Vec2(0, 0.01 * x.x()); }});
  const double shift = s.closed ? -4 : -0.3;
  scene.tractions.push_back({2, [=](const Vec2& x, const Vec2&) -> Vec2 { return s.load * Vec2(0.1, x.x() + shift); }});
  return prepare(std::move(mesh), element(s.element, s.degree), std::move(scene), 2);
}

struct Named {
  std::string name;
  Term term;
};
std::vector<Named> terms() {
  const auto target = [](const Vec2& x) { return Vec2(0.3 * x.y(), 0.1); };
  const auto weight = [](const Vec2& x) { return 1 + 0.2 * x.x(); };
  std::vector<Named> all{
      {"work", compliance()},
      {"displacement", displacement_tracking(target, weight)},
      {"boundary", boundary_tracking(
                       1, [=](const Vec2& x, const Vec2&) { return target(x); },
                       [=](const Vec2& x, const Vec2&) { return weight(x); })},
      {"power2", stress_power(2, weight, true)},
      {"power4", stress_power(4, weight, true)},
      {"norm", stress_pnorm(5, weight, true)},
      {"rate", energy_release_rate({1, 0}, {1, 0}, {0.3, 0.9}, {})},
      {"opening", crack_opening(0, weight)},
      {"pressure", crack_pressure(
                       0, [](const Vec2&) { return 0.1; }, weight)},
      {"along", boundary_displacement(
                    1, [](const Vec2& x, const Vec2& n) -> Vec2 { return 0.3 * n + Vec2(0.1, x.x()); },
                    [=](const Vec2& x, const Vec2&) { return weight(x); })},
      {"turning", scenes::turning()},
      {"opening_mode", stress_intensity({.along = {1, 0}}, {1, 0}, {0.3, 0.9}, {}, 0)},
      {"sliding_mode", stress_intensity({TipQuantity::SlidingMode, {1, 0}}, {1, 0}, {0.3, 0.9}, {})},
  };
  return all;
}

TEST(Differentiated, HasTheBitsOfTheIntegral) {
  const Model model = make({});
  const State state = solve(model);
  for (const Named& t : terms()) {
    const Differentiated both = differentiated(t.term, model, state);
    EXPECT_EQ(both.value, integral(t.term, model, state)) << t.name;
    const Sensitivity alone = derivative(t.term, model, state);
    EXPECT_EQ(both.derivative.interior, alone.interior) << t.name;
    EXPECT_EQ(both.derivative.skeleton, alone.skeleton) << t.name;
  }
}

class Gradient : public testing::TestWithParam<std::tuple<int, Load>> {};

// The gradient is that of the discrete problem: adjoint against central differences of whole solves.
TEST_P(Gradient, AgreesWithCentralDifferences) {
  const auto& [number, setup] = GetParam();
  const Functional j{"", {terms()[number].term}};
  Model model = make(setup);
  const State state = solve(model);
  ASSERT_TRUE(certified(state));
  const Analysis a = analyze(j, model, state);
  if (!a.adjoint) GTEST_SKIP() << "nothing to differentiate";
  const auto value = [&](const Load& s) {
    const Model m = make(s);
    return analyze(j, m, solve(m), true).value;
  };
  const auto frozen = [&](const Load& s) { return analyze(j, make(s), state, true).value; };
  const double scale = std::abs(a.value);
  // Fourth order, with steps that keep the rounding of near-incompressible solves small.
  const auto slope = [&](const auto& of, double Load::*what) {
    const double h = 4e-3;
    const auto at = [&](double step) {
      Load l = setup;
      l.*what += step;
      return of(l);
    };
    return (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
  };
  {  // the load
    const double expected = slope(value, &Load::load);
    const double derivative = a.adjoint->skeleton.dot(traction_loads(model.mesh, model.inner->kernel,
                                                                     model.inner->skeleton, model.inner->data)) /
                                  setup.load +
                              slope(frozen, &Load::load);
    EXPECT_NEAR(derivative, expected, 1e-6 * std::max(std::abs(expected), 0.01 * scale));
  }
  if (setup.element != "arnold-winther-nc") {  // Young's modulus of the region; its rotation depends on it by itself
    const double expected = slope(value, &Load::young);
    double derivative = slope(frozen, &Load::young);
    for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
      if (model.mesh.region[t] == none) continue;
      const Triangle shape = triangle(model, t);
      const Points x = rule_points(model.inner->kernel.rule, shape);
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const Mat2 s = tensor(stress_at(model.inner->kernel, shape, state.interior.col(t), x.col(q)));
        const Mat2 z = tensor(stress_at(model.inner->kernel, shape, a.adjoint->interior.col(t), x.col(q)));
        derivative -= area(shape) * model.inner->kernel.rule.w[q] / setup.young *
                      strain(model.scene.regions[0], s).cwiseProduct(z).sum();
      }
    }
    EXPECT_NEAR(derivative, expected, 1e-6 * std::max(std::abs(expected), 1e-3 * scale));
    EXPECT_NEAR(young_gradient(a, j, model, 0, setup.young), derivative,
                1e-8 * std::max(std::abs(expected), 1e-3 * scale));
  }
}

std::string name_of(const testing::TestParamInfo<Gradient::ParamType>& info) {
  const auto& [number, s] = info.param;
  std::string name = terms()[number].name + "_" + s.element + std::to_string(s.degree) + "_nu" +
                     std::to_string(static_cast<int>(std::lround(1e7 * s.poisson))) + (s.closed ? "_closed" : "");
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Bdms, Gradient,
                         testing::Combine(testing::Range(0, 13),
                                          testing::Values(Load{}, Load{.poisson = 0.49}, Load{.poisson = 0.4999999},
                                                          Load{.poisson = 0.5}, Load{.closed = true})),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Elements, Gradient,
                         testing::Combine(testing::Range(0, 13),
                                          testing::Values(Load{.degree = 2}, Load{.degree = 3}, Load{.element = "afw"},
                                                          Load{.element = "peers"}, Load{.element = "bdms-c"},
                                                          Load{.element = "arnold-winther-nc"})),
                         name_of);

}  // namespace
}  // namespace kerf::functional_test
