// Every functional, change and load as a product, against bodies that are drawn with the change. All of it by hand:
//   KERF_LOAD=... KERF_CHANGE=... test_truth --gtest_also_run_disabled_tests --gtest_filter=DrawnChanges.*Product
// (without the variables all loads and changes).

#include "kerf/shape_gradient.hpp"
#include "tests/truth/drawn.hpp"
#include "tests/truth/scene.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace kerf::topological_derivative_test {
namespace {

using drawn::Change;
using drawn::Comparison;
using drawn::Load;

template <class T>
const T& named(const std::vector<T>& all, const std::string& name) {
  for (const T& one : all)
    if (one.name == name) return one;
  throw Error(Fault::Usage, "no " + name);
}

std::string text(const std::string& what, const Comparison& c) {
  if (!c.refused.empty()) return fmt::format("{} refused: {}\n", what, c.refused);
  std::string s = fmt::format("{} T {:12.6g} drawn {:12.6g} off by {:8.1e} unsure {:8.1e}  quotients", what,
                              c.predicted, c.drawn, c.predicted - c.drawn, c.unsure);
  for (const double q : c.quotients) s += fmt::format(" {:.6g}", q);
  return s + "\n";
}

// What has no expansion says so, by name.
bool refusal(const Load& load, const Change& change, const std::string& functional) {
  if (load.fluid && functional == "energy_release_rate") return true;  // it would miss the work of the fluid
  return !has_series(change.p) && (load.regions || functional.starts_with("stress"));
}

// By hand: more radii, and a table.
void expect_drawn(const Load& load, const Change& change, bool by_hand) {
  std::vector<double> radii = drawn::radii();
  if (!by_hand) radii.pop_back();
  const std::vector<drawn::Named> all = drawn::functionals(load);
  const std::vector<Comparison> compared = drawn::compare(load, change, all, radii);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Comparison& c = compared[i];
    const std::string what = text(fmt::format("{:20} {:13} {:22}", load.name, change.name, all[i].name), c);
    if (by_hand) fmt::print("{}", what);
    EXPECT_EQ(!c.refused.empty(), refusal(load, change, all[i].name)) << what;
    if (!c.refused.empty()) continue;
    EXPECT_LE(std::abs(c.predicted - c.drawn), 0.008 * std::abs(c.drawn) + 1.5 * c.unsure + 1e-9) << what;
  }
}

TEST(DrawnChanges, DISABLED_Product) {
  const char *only_load = std::getenv("KERF_LOAD"), *only_change = std::getenv("KERF_CHANGE");
  for (const Load& load : drawn::loads())
    for (const Change& change : drawn::changes())
      if ((!only_load || load.name == only_load) && (!only_change || change.name == only_change)) {
        expect_drawn(load, change, true);
        std::fflush(stdout);
      }
}

class DrawnChange : public testing::TestWithParam<const char*> {};
// Tractions, a body force, moving supports, a crack partly in contact and another material, all at once.
TEST_P(DrawnChange, UnderEverythingAtOnce) {
  expect_drawn(named(drawn::loads(), "all"), named(drawn::changes(), GetParam()), false);
}
INSTANTIATE_TEST_SUITE_P(Kinds, DrawnChange, testing::Values("hole", "inclusion", "ellipse", "crack"),
                         [](const auto& info) { return std::string(info.param); });

TEST(DrawnChanges, ClampedUnderABodyForceAndMovingSupports) {
  expect_drawn(named(drawn::loads(), "body_and_prescribed"), named(drawn::changes(), "clamped_hole"), false);
}

// A pressure in the crack, which is partly closed all the same.
TEST(DrawnChanges, BesideACrackUnderPressure) {
  expect_drawn(named(drawn::loads(), "fluid_and_contact"), named(drawn::changes(), "hole"), false);
}

// The direction that an ellipse or a crack takes sees the densities of the stress: none is better.
TEST(DrawnChanges, DirectionsSeeTheDensitiesOfTheStress) {
  const Load& load = named(drawn::loads(), "body_and_prescribed");
  const drawn::Solved s = drawn::solve_body(load);
  const std::vector<Vec2> at = {drawn::place()};
  for (const char* name : {"stress_power", "stress_pnorm"}) {
    const std::vector<drawn::Named> all = drawn::functionals(load);
    const Functional& j = named(all, name).j;
    const Analysis a = analyze(j, *s.model, *s.state);
    for (const char* kind : {"ellipse", "crack"}) {
      Perturbation p = named(drawn::changes(), kind).p;
      p.angle = {};
      const MapPoint best = map_at(a, j, {.perturbation = p}, at)[0];
      for (int k = 0; k < 30; ++k) {
        p.angle = k * pi / 30;
        const double T = map_at(a, j, {.perturbation = p}, at)[0].value;
        if (p.kind == Perturbation::Kind::Ellipse) {
          EXPECT_GE(T, best.value - 1e-6 * std::abs(best.value)) << name << ' ' << *p.angle;
        } else {
          EXPECT_LE(std::abs(T), std::abs(best.value) * (1 + 1e-6)) << name << ' ' << *p.angle;
        }
      }
    }
  }
}

// The derivative by the radius of a hole that is there, against larger and smaller ones.
TEST(DrawnChanges, ShapeGradientsByTheRadius) {
  const Load& load = named(drawn::loads(), "all");
  const Change& hole = named(drawn::changes(), "hole");
  constexpr double radius = 0.25, step = 0.02;
  const auto solve = [&](double at) { return drawn::solve_drawn(load, hole, at, 0, false); };
  const drawn::Solved s = solve(radius);
  std::vector<drawn::Solved> others;
  for (const double by : {-1., -0.5, 0.5, 1.}) others.push_back(solve(radius + by * step));
  for (const drawn::Named& n : drawn::functionals(load)) {
    const Analysis a = analyze(n.j, *s.model, *s.state);
    const Points gradient = shape_gradient(a, n.j);
    std::vector<bool> rim(s.model->mesh.points.size(), false);
    for (std::size_t e = 0; e < s.model->mesh.edges.size(); ++e)
      if (s.model->mesh.label[e] == drawn::rim)
        for (const Index v : s.model->mesh.edges[e]) rim[static_cast<std::size_t>(v)] = true;
    double by_radius = 0;
    for (std::size_t v = 0; v < rim.size(); ++v)
      if (rim[v])
        by_radius += gradient.col(static_cast<Eigen::Index>(v)).dot(s.model->mesh.points[v] - drawn::place()) / radius;
    std::vector<double> J;
    for (const drawn::Solved& o : others) J.push_back(analyze(n.j, *o.model, *o.state, true).value);
    const double wide = (J[3] - J[0]) / (2 * step), narrow = (J[2] - J[1]) / step, drawn = (4 * narrow - wide) / 3;
    EXPECT_NEAR(by_radius, drawn, 0.003 * std::abs(drawn) + std::abs(wide - narrow)) << n.name;
    if (!n.name.starts_with("compliance")) continue;
    double boundary = 0;
    for (const BoundaryGradient::Point& p : boundary_gradient(a, n.j).points)
      if (s.model->mesh.label[static_cast<std::size_t>(p.edge)] == drawn::rim) boundary -= p.weight * p.density;
    EXPECT_NEAR(boundary, drawn, 0.01 * std::abs(drawn)) << n.name;
  }
}

// Listed points of a J that is neither linear nor an energy: the map is made there, and right.
TEST_F(Truth, MapOfAClampedHoleAtListedPoints) {
  const std::string body = R"(
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0.3, "x"]
[mesh]
size = 0.06
[solver]
degree = 2
[functional]
kind = "displacement_tracking"
target = [0, "0.2 * y"]
)";
  constexpr double radius = 0.02;
  const nlohmann::json map = run_scene(
      body + fmt::format("[map]\nperturbation = \"clamped_hole\"\nradius = {}\npoints = [[0.55, 0.6], [0.01, 0.5]]\n",
                         radius),
      Job::Map);
  ASSERT_EQ(map["status"], "ok");
  const double predicted = map["map"]["points"][0]["value"];
  EXPECT_EQ(map["map"]["min"]["value"], predicted);
  EXPECT_TRUE(map["map"]["points"][1]["value"].is_null());
  const nlohmann::json hole = run_scene(body + fmt::format(R"(
[[hole]]
name = "h"
circle = {{ center = [0.55, 0.6], radius = {} }}
[[boundary]]
on = "hole:h"
displacement = [0, 0]
)",
                                                           radius));
  const double drawn = hole["functional"]["value"].get<double>() - map["functional"]["value"].get<double>();
  EXPECT_NEAR(predicted / drawn, 1, 0.01);
}

}  // namespace
}  // namespace kerf::topological_derivative_test
