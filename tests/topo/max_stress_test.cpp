// The largest stress of bodies with known ones: tension, shear, the rim of a hole; and the norms that stand for it.

#include "topo/max_stress.hpp"

#include "kerf/analysis.hpp"
#include "kerf/mesher.hpp"
#include "kerf/shape_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::max_stress_test {
namespace {

constexpr int left = 0, bottom = 1, right = 2, top = 3;

/// [0, 2] x [0, 1] with an optional hole around (1, 0.5), on rollers on the left and at the bottom, under tractions on
/// the right and at the top.
struct Tension {
  Vec2 on_right = Vec2(3, 0), on_top = Vec2::Zero();
  double hole = 0, size = 0.15;
  bool curved = false;
};
Model make(const Tension& t) {
  Shape s;
  s.labels = {"left", "bottom", "right", "top", "hole"};
  s.outline.sides = {{{0, 0}, bottom, {}}, {{2, 0}, right, {}}, {{2, 1}, top, {}}, {{0, 1}, left, {}}};
  if (t.hole > 0) s.holes.push_back(circle("h", {1, 0.5}, t.hole, 4));
  Scene scene;
  scene.material = plane_stress(1, 0.3);
  const BoundaryField none_of_it = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  scene.supports = {{left, false, true, false, none_of_it}, {bottom, false, false, true, none_of_it}};
  scene.tractions = {{right, [=](const Vec2&, const Vec2&) { return t.on_right; }},
                     {top, [=](const Vec2&, const Vec2&) { return t.on_top; }}};
  return prepare(triangulate(s, {.size = t.size, .curved = t.curved}), bdms(1), std::move(scene), 1);
}

double value(const LargestStress& what, const Model& model, const Field& state) {
  return analyze({"max_stress", {max_stress(what)}}, model, state, true).value;
}

TEST(LargestStress, OfUniformStressesIsExact) {
  for (const auto& [on_right, on_top] : {std::pair(Vec2(3, 0), Vec2(0, 0)),
                                         {Vec2(-3, 0), Vec2(0, 1)},
                                         {Vec2(2, 0), Vec2(0, 2)},
                                         {Vec2(0, 0), Vec2(0, -5)}}) {
    const Model model = make({.on_right = on_right, .on_top = on_top});
    const State state = solve(model);
    const double a = on_right.x(), b = on_top.y();
    EXPECT_NEAR(value({}, model, state), std::sqrt(a * a - a * b + b * b), 1e-9);
    EXPECT_NEAR(value({.of = LargestStress::Of::Principal}, model, state), std::max(std::abs(a), std::abs(b)), 1e-9);
  }
}

// A small hole in a wide plate: three times the tension, 2.7 % more for this width [Peterson].
TEST(LargestStress, LiesAtTheRimOfAHole) {
  const Model model = make({.hole = 0.1, .size = 0.05, .curved = true});
  const State state = solve(model);
  const StressAt s = largest_stress({}, model, state);
  EXPECT_NEAR(s.value, 3 * 3.06, 0.04 * 9);
  EXPECT_NEAR(std::abs(s.at.y() - 0.5), 0.1, 2e-3);
  EXPECT_NEAR(s.at.x(), 1, 0.03);
}

TEST(LargestStress, ZonesAreLeftOut) {
  const Model model = make({.hole = 0.1, .size = 0.05});
  const State state = solve(model);
  LargestStress what{.zones = {{{1, 0.5}, {1, 0.5}, 0.45, "hole"}}};
  EXPECT_TRUE(what.leaves_out({1, 0.9}));
  EXPECT_FALSE(what.leaves_out({1, 0.96}));
  EXPECT_LT(value(what, model, state), 3.5);
  what.zones = {{{0, 0.5}, {2, 0.5}, 2, "all of it"}};
  EXPECT_EQ(largest_stress(what, model, state).value, 0);
}

// The derivative is that of the norm, scaled: twice the load, twice both.
TEST(LargestStress, HasTheDerivativeOfItsNorm) {
  const Model model = make({.hole = 0.2, .size = 0.1});
  const State state = solve(model);
  const Functional largest{"max_stress", {max_stress({})}}, norm{"norm", {stress_pnorm(12, {}, false)}};
  const Analysis a = analyze(largest, model, state), b = analyze(norm, model, state);
  EXPECT_EQ(a.value, largest_stress({}, model, state).value);
  const Points by_largest = shape_gradient(a, largest), by_norm = shape_gradient(b, norm);
  EXPECT_NEAR((by_largest - a.value / b.value * by_norm).norm(), 0, 1e-9 * by_largest.norm());
}

// Of boxes that cover the body the powers of the norms add up to that of the whole.
TEST(LargestStress, NormsOfBoxesAddUp) {
  for (const LargestStress::Of of : {LargestStress::Of::VonMises, LargestStress::Of::Principal}) {
    const LargestStress what{.of = of};
    const Model model = make({.on_right = {3, 1}, .hole = 0.2, .size = 0.1});
    const State state = solve(model);
    double sum = 0;
    for (int i = -1; i < 4; ++i)
      for (int k = -1; k < 3; ++k) {
        const Vec2 low(0.5 * i, 0.5 * k);
        sum += std::pow(analyze({"box", {norm_in_box(what, low, low + Vec2(0.5, 0.5))}}, model, state, true).value, 12);
      }
    const double whole = analyze({"all", {norm_in_box(what, {-9, -9}, {9, 9})}}, model, state, true).value;
    EXPECT_NEAR(std::pow(sum, 1.0 / 12), whole, 1e-12 * whole);
  }
}

// Moving a vertex beside the hole: differences of whole solves.
TEST(LargestStress, NormOfPrincipalStressesHasItsDerivative) {
  const LargestStress what{.of = LargestStress::Of::Principal};
  const Functional norm{"norm", {norm_in_box(what, {0.5, 0}, {1.5, 1})}};
  const Model model = make({.on_right = {3, 1}, .on_top = {0, 1}, .hole = 0.2, .size = 0.2});
  const State state = solve(model);
  const Points by = shape_gradient(analyze(norm, model, state), norm);
  Index vertex = 0;
  for (Index v = 0; v < Index(model.mesh.points.size()); ++v)
    if ((model.mesh.points[std::size_t(v)] - Vec2(1, 0.7)).norm() <
        (model.mesh.points[std::size_t(vertex)] - Vec2(1, 0.7)).norm())
      vertex = v;
  const auto moved = [&](double step) {
    Mesh mesh = model.mesh;
    mesh.points[std::size_t(vertex)].y() += step;
    const Model other = prepare(std::move(mesh), model.element, model.scene, 1);
    const State solved = solve(other);
    return analyze(norm, other, solved, true).value;
  };
  constexpr double step = 1e-5;
  EXPECT_NEAR((moved(step) - moved(-step)) / (2 * step), by(1, vertex), 1e-5 * by.norm());
}

TEST(LargestStress, OfPrincipalStressesHasNoMap) {
  const Term term = max_stress({.of = LargestStress::Of::Principal});
  EXPECT_THROW(term.local({}, {}), Error);
}

}  // namespace
}  // namespace kerf::max_stress_test
