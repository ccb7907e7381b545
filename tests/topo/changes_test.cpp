// Changes of finite size against each other, where the answer is known without a series: what superposes, and what a
// motion of the whole body does.

#include "topo/changes.hpp"

#include "tests/topo/validation.hpp"
#include "topo/map/modes.hpp"
#include "topo/validate/sites.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::changes_test {
namespace {

using namespace scenes;
using Kind = Perturbation::Kind;

const Perturbation stiff{.kind = Kind::Inclusion, .inclusion = plane_strain(3, 0.2)};
const Vec2 force(0.2, -0.5);

Scene loaded(const Vec2& moved = {0, 0}) {
  Scene s = pulled(plane_strain(1, 0.3), opens);
  s.laws.clear();
  s.body = [](const Vec2&) { return force; };
  s.supports[0].value = [moved](const Vec2&, const Vec2&) { return moved; };
  return s;
}

double change_of(const Scene& scene, const std::vector<Term>& terms, const Perturbation& p) {
  const Shape square = rectangle({-1, -1}, {1, 1});
  const Sizing sizing{.size = 0.5};
  const Element e = element("bdms", 1);
  const Functional j{"", terms};
  const std::vector<SmallChange> one{{{0.2, 0.1}, 0.15}};
  return changes_at({{square, sizing}, e, std::span(&scene, 1), j}, p, one).difference(0, 0);
}

// Supports that move the body as it is leave the stress as it was. The work is then that of fields and no energy, and
// what it loses with a hole besides is the force on the place of the hole times the motion.
TEST(ChangesMade, OfTheWorkInABodyThatIsMoved) {
  const Vec2 moved(0.3, 0.7);
  for (const Perturbation& p : {Perturbation{}, stiff}) {
    const double at_rest = change_of(loaded(), {compliance()}, p), area = -change_of(loaded(), {volume()}, p);
    EXPECT_NEAR(area, p.kind == Kind::Hole ? pi * 0.15 * 0.15 : 0, 1e-12);
    EXPECT_NEAR(change_of(loaded(moved), {compliance()}, p), at_rest - area * force.dot(moved), 1e-9) << word(p.kind);
  }
}

TEST(ChangesMade, OfASumAreTheSumOfTheirs) {
  std::vector<Term> terms = {energy(),
                             volume(),
                             displacement_tracking({}, {}),
                             stress_power(2, {}, true),
                             misfit(2, [](const Vec2& x, const Vec2&) { return Vec2(0.1, 1 + x.x()); }),
                             turning()};
  for (std::size_t i = 0; i < terms.size(); ++i) terms[i].factor = 1 + 0.5 * static_cast<double>(i);
  for (const Perturbation& p : {Perturbation{}, stiff}) {
    double sum = 0, size = 0;
    for (const Term& term : terms) {
      const double one = change_of(loaded(), {term}, p);
      sum += one;
      size += std::abs(one);
    }
    EXPECT_NEAR(change_of(loaded(), terms, p), sum, 1e-9 * size) << word(p.kind);
  }
}

// What is clear around a place: of sides and holes negative beyond, of other materials and cracks on both sides.
TEST(Sites, AreClearOfTheNextFeature) {
  Shape s = rectangle({-1, -1}, {1, 1});
  s.labels.push_back("hole");
  s.holes = {polygon("hole", {{0.4, 0.4}, {0.8, 0.4}, {0.8, 0.8}, {0.4, 0.8}}, 4)};
  s.regions = {polygon("stiff", {{-0.8, -0.8}, {-0.4, -0.8}, {-0.4, -0.4}, {-0.8, -0.4}}, none)};
  s.cracks = {{"straight", {Vec2(-0.5, 0.5), Vec2(-0.1, 0.5)}}, arc_crack("arc", {0.5, -0.5}, 0.2, 0, pi)};
  const Functional plain{"", {energy()}}, rate{"", {energy_release_rate({-0.1, 0.5}, {1, 0}, {0.05, 0.15}, {})}};
  const auto at = [&](const Vec2& x, const Functional& j) { return site_at(s, j, x, 0); };
  EXPECT_NEAR(at({0.9, 0.1}, plain).clear, 0.1, 1e-12);
  EXPECT_NEAR(at({0.6, 0.35}, plain).clear, 0.05, 1e-12);
  for (const Vec2& x : {Vec2(-0.45, -0.6), Vec2(-0.35, -0.6)}) {
    EXPECT_NEAR(at(x, plain).clear, 0.05, 1e-12);
    EXPECT_TRUE(at(x, plain).inside);
  }
  EXPECT_NEAR(at({-0.3, 0.45}, plain).clear, 0.05, 1e-12);
  EXPECT_NEAR(at({0.5, -0.4}, plain).clear, 0.1, 1e-4);
  EXPECT_NEAR(at({0.1, 0.5}, plain).clear, 0.2, 1e-12);
  EXPECT_NEAR(at({0.1, 0.5}, rate).clear, 0.05, 1e-12);
  EXPECT_NEAR(at({-0.1, 0.4}, rate).clear, -0.05, 1e-12);
  EXPECT_TRUE(at({-0.1, 0.4}, rate).inside);
  // Outside, whatever else is around.
  const Functional wide{"", {energy_release_rate({-0.1, 0.5}, {1, 0}, {0.05, 3}, {})}};
  for (const Functional* j : {&plain, &wide})
    for (const Vec2& x : {Vec2(1.2, 0), Vec2(0.6, 0.7)}) {
      EXPECT_LT(at(x, *j).clear, 0) << x.transpose();
      EXPECT_FALSE(at(x, *j).inside);
    }
  EXPECT_TRUE(at({1, 0.1}, plain).inside);
  EXPECT_NEAR(at({1, 0.1}, plain).clear, 0, 1e-15);
}

// The energy and a misfit leave that of the body with measured displacements: its parts are those of its stress.
TEST(Modes, OfAGapThatHidesTheState) {
  const Scene scene = loaded();
  const Model m = prepare(triangulate(rectangle({-1, -1}, {1, 1}), {.size = 0.5}), element("bdms", 1), scene, 1);
  const State s = solve(m);
  const Functional j{"", {energy(), misfit(2, [](const Vec2& x, const Vec2&) { return Vec2(0.1, 1 + x.x()); })}};
  const Analysis a = analyze(j, m, s);
  const Expansion e(a, j, stiff);
  const PointValues v{.material = scene.material, .stress = {5, 4, 3}, .measured = {1, 3, 0.5}};
  std::vector<bool> closed;
  const Oriented whole = expand(e, v, closed);
  const Mat2 measured = (Mat2() << 1, 0.5, 0.5, 3).finished(), mean = 2 * Mat2::Identity(), shear = measured - mean;
  const auto part = [&](const Mat2& of) { return -0.5 * inclusion_form(scene.material, stiff.inclusion, of, of); };
  EXPECT_NEAR(whole.value, part(measured), 1e-12);
  const std::vector<Mode> modes = modes_of(e, v, whole);
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0].value, part(mean), 1e-12);
  EXPECT_NEAR(modes[1].value, part(shear), 1e-12);
}

}  // namespace
}  // namespace kerf::changes_test
