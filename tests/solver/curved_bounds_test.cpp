// Bounds of quantities of bodies with curved sides against closed forms: Kirsch, Lame, Inglis, an inclusion, an arc.

#include "tests/solver/scenes.hpp"
#include "tests/support/exact_families.hpp"

#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "solver/stress_norm.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kerf::curved_bounds_test {
namespace {

using exact::ExactField;

const Material steel{1, 0.1};  // nu = .3
const Mat2 pull = (Mat2() << 1, .3, .3, -.4).finished();

/// The exact displacement on `held`, the exact traction on `pulled`, which lie on the body's labels.
Scene loaded(const ExactField& f, const std::vector<Index>& held, const std::vector<Index>& pulled) {
  Scene s;
  s.material = f.material;
  const auto side = [f](const Vec2& x) { return f.side ? f.side(x) : 0; };
  for (const Index label : held)
    s.supports.push_back(
        {label, false, true, true, [f, side](const Vec2& x, const Vec2&) { return f.displacement(x, side(x)); }});
  for (const Index label : pulled)
    s.tractions.push_back({label, [f, side](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, side(x)) * n); }});
  return s;
}

const Loop square = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);

Shape with_hole(Loop hole) {
  Shape shape{square, {}, {}, {"outside", "hole"}, {}};
  shape.holes.push_back(std::move(hole));
  return shape;
}

struct Solved {
  Model model;
  State state;
  Solved(const Shape& shape, double size, const Element& e, const Scene& scene, bool curved = true)
      : model(prepare(triangulate(shape, {.size = size, .curved = curved}), e, scene, 1)), state(solve(model)) {}
};

void expect_contains(const Bounded& b, double exact, const std::string& which) {
  EXPECT_LE(b.lower, exact) << which << " " << b.note;
  EXPECT_GE(b.upper, exact) << which << " " << b.note;
}

double width(const Bounded& b) {
  return b.upper - b.lower;
}

/// Of the stress at a point, the widest of its components.
double contain_stress(const QuantityBounds& bounds, const Vec2& x, const Mat2& exact, const std::string& which) {
  const StressBounds s = bounds.stress(x);
  expect_contains(s.s11, exact(0, 0), which + " s11");
  expect_contains(s.s22, exact(1, 1), which + " s22");
  expect_contains(s.s12, exact(0, 1), which + " s12");
  return std::max({width(s.s11), width(s.s22), width(s.s12)});
}

std::string words(const Element& e, const Vec2& x) {
  return fmt::format("{} at ({}, {})", title(e), x.x(), x.y());
}

class CurvedBounds : public testing::TestWithParam<Element> {};
std::string name_of(const testing::TestParamInfo<Element>& info) {
  return title(info.param);
}
INSTANTIATE_TEST_SUITE_P(All, CurvedBounds, testing::Values(bdms(1), bdms(2), bdms(3), bdms(4), afw(2)), name_of);

// A round hole, free: Kirsch.
TEST_P(CurvedBounds, HoldStressesAboutARoundHole) {
  const Element& e = GetParam();
  const ExactField f = exact::kirsch(steel, pull, 0.7);
  const Solved s(with_hole(circle("hole", {0, 0}, 0.7, 1)), 0.4, e, loaded(f, {}, {0}));
  const QuantityBounds bounds(s.model, s.state);
  for (const Vec2& x : {Vec2(1.2, 0.4), Vec2(-0.3, 1.1)}) {
    if (e.stress == 3 && x.x() < 0) continue;  // dear
    const double wide = contain_stress(bounds, x, f.stress(x, 0), words(e, x));
    EXPECT_LT(wide, e.stress == 1 ? 0.3 : e.stress == 2 ? 0.05 : 2e-3) << words(e, x);
  }
  EXPECT_FALSE(bounds.stress({1.2, 0.4}).s11.guaranteed);
}

Solved ring_under_pressure(const Element& e) {
  Scene scene;
  scene.material = steel;
  scene.tractions.push_back({1, [](const Vec2&, const Vec2& n) { return Vec2(-n); }});
  return Solved({circle("outline", {0, 0}, 2, 0), {circle("hole", {0, 0}, 1, 1)}, {}, {"rim", "hole"}, {}}, 0.3, e,
                scene);
}

// Of a ring under pressure inside, Lame: compliance, mean displacements, the mean over a disc and along a line.
TEST_P(CurvedBounds, HoldMeansAndWorksOfARing) {
  const Element& e = GetParam();
  const Solved s = ring_under_pressure(e);
  const QuantityBounds bounds(s.model, s.state);
  constexpr double A = 1.0 / 3, B = 4.0 / 3, at_hole = 0.5 * (0.4 * A + B), at_rim = 0.5 * (0.8 * A + B / 2);
  const double small = e.stress == 1 ? 0.05 : e.stress == 2 ? 2e-3 : 1e-4;
  const Bounded compliance = bounds.work_of_loads();
  expect_contains(compliance, 2 * pi * at_hole, title(e) + " compliance");
  EXPECT_LT(width(compliance), small * 2 * pi * at_hole);
  const Bounded radial = bounds.work({{0, [](const Vec2&, const Vec2& n) { return Vec2(n / (4 * pi)); }}});
  expect_contains(radial, at_rim, title(e) + " displacement of the rim");
  EXPECT_LT(width(radial), small * at_rim);
  // s11 + s22 = 2 A everywhere, also in the mean.
  expect_contains(bounds.mean_stress(OverDisc{{1.5, 0.1}, 0.2}).trace, 2 * A, title(e) + " disc");
  if (e.stress == 3) return;  // dear
  const StressBounds line = bounds.mean_stress(AlongLine{{1.3, 0}, {1.7, 0}});
  // s_t along the radius: A + B mean(1/r^2), 1/(r1 r2)
  expect_contains(line.s22, A + B / (1.3 * 1.7), title(e) + " line");
  expect_contains(line.s11, A - B / (1.3 * 1.7), title(e) + " line");
  EXPECT_LT(width(line.s22), 30 * small);
}

// Of an elliptic hole, Inglis, with the outside held: a force of the support, and a stress.
TEST_P(CurvedBounds, HoldStressAndForceAboutAnEllipse) {
  const Element& e = GetParam();
  const ExactField f = exact::inglis("hole", steel, {pull, {0.8, 0.4}});
  Shape shape = with_hole(ellipse("hole", {0, 0}, {0.8, 0.4}, 0, 1));
  shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  shape.outline.sides[1].label = 2;
  shape.outline.sides[3].label = 3;
  shape.labels.insert(shape.labels.end(), {"right", "left"});
  const Solved s(shape, 0.4, e, loaded(f, {2, 3}, {0}));
  const QuantityBounds bounds(s.model, s.state);
  const Vec2 x(0.4, 1.0);
  contain_stress(bounds, x, f.stress(x, 0), words(e, x));
  Vec2 force = Vec2::Zero();
  const EdgeRule rule = gauss(20);
  for (int piece = 0; piece < 8; ++piece)
    for (Eigen::Index q = 0; q < rule.s.size(); ++q)
      force += 0.5 * rule.w[q] * f.stress({2, -2 + 0.5 * (piece + rule.s[q])}, 0).col(0);
  for (const int component : {0, 1})
    expect_contains(bounds.reaction({2}, component), force[component], title(e) + " force");
}

// A round inclusion: a stress inside, where it is constant, by a field that is cut off, and the work of the loads.
TEST_P(CurvedBounds, HoldAcrossARoundInterface) {
  const Element& e = GetParam();
  const Material hard{10, 0.01};
  const exact::TwoPhases f = exact::inclusion("inclusion", steel, hard, {pull, 0.6, 1.5});
  Shape shape{circle("outline", {0, 0}, 1.5, 0), {}, {}, {"rim"}, {}};
  shape.regions.push_back(circle("core", {0, 0}, 0.6, none));
  Scene scene = loaded(f.outside, {}, {0});
  scene.regions = {hard};
  const Solved s(shape, e.stress == 1 ? 0.12 : 0.2, e, scene);
  const QuantityBounds bounds(s.model, s.state);
  const StressBounds inside = bounds.stress({0, 0});
  const Mat2 there = f.inside.stress({0, 0}, 0);
  expect_contains(inside.s11, there(0, 0), title(e) + " inside " + inside.s11.note);
  expect_contains(inside.s12, there(0, 1), title(e) + " inside");
  double work = 0;
  constexpr int n = 64;
  for (int k = 0; k < n; ++k) {
    const Vec2 x = 1.5 * Vec2(std::cos(2 * pi * k / n), std::sin(2 * pi * k / n));
    work += 1.5 * (2 * pi / n) * f.outside.displacement(x, 0).dot(f.outside.stress(x, 0) * x.normalized());
  }
  expect_contains(bounds.work_of_loads(), work, title(e) + " work");
}

// The integral of the squared von Mises stress of a ring under pressure, plane strain.
TEST_P(CurvedBounds, HoldTheSquareOfTheStressOfARing) {
  const Element& e = GetParam();
  const Solved s = ring_under_pressure(e);
  // 3/2 |dev|^2 + (1/2 - nu)^2 tr^2, dev: B/r^2 twice, opposite
  constexpr double A = 1.0 / 3, B = 4.0 / 3;
  const double exact = 3 * B * B * pi * (1 - 1.0 / 4) + 0.04 * 4 * A * A * 3 * pi;
  const Bounded b = squared_stress_bounds(s.model, s.state, [](const Material&, const Mat2& m) {
    const double half = 0.5 * m.trace();
    return 1.5 * (m - half * Mat2::Identity()).squaredNorm() + 0.04 * m.trace() * m.trace();
  });
  expect_contains(b, exact, title(e));
  EXPECT_LT(width(b), (e.stress == 1 ? 0.5 : e.stress == 2 ? 0.1 : 0.02) * exact);
}

// A disc of radius 1 whose material wants to grow by r^2 in all directions:
// s_r = E (1 - r^2)/4, s_t = E (1 - 3 r^2)/4, the energy pi E/24 with 1/E = 1/(4 mu) + c.
TEST(CurvedBound, HoldsTheEnergyOfAnEigenstrainThatChanges) {
  Scene scene{.material = steel};
  scene.eigenstrain = {{.normal = [](const Vec2& x) -> Vec2 { return Vec2::Constant(x.squaredNorm()); },
                        .shear = [](const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  const double exact = pi / 24 / (0.25 / steel.mu + steel.c);
  const Shape disc{circle("outline", {0, 0}, 1, 0), {}, {}, {"rim"}, {}};
  for (const int degree : {1, 2}) {
    std::array<double, 2> gap{};
    for (std::size_t i = 0; i < 2; ++i) {
      const Solved s(disc, i == 0 ? 0.2 : 0.1, bdms(degree), scene);
      const EnergyBounds b = energy_bounds(s.model, s.state);
      EXPECT_LE(b.lower, exact) << degree << " " << b.note;
      EXPECT_GE(b.upper, exact) << degree << " " << b.note;
      gap[i] = b.upper - b.lower;
    }
    EXPECT_GT(std::log2(gap[0] / gap[1]), 2 * degree) << gap[0] << " " << gap[1];
  }
}

// The same disc: its rim moves out by 1/2, and the stress at a point is known. In curved triangles the strain changes,
// too.
TEST_P(CurvedBounds, HoldQuantitiesOfAnEigenstrainThatChanges) {
  const Element& e = GetParam();
  Scene scene{.material = steel};
  scene.eigenstrain = {{.normal = [](const Vec2& x) -> Vec2 { return Vec2::Constant(x.squaredNorm()); },
                        .shear = [](const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  for (const double size : {0.5, 0.25}) {  // with 0.5 most triangles are curved
    const Solved s({circle("outline", {0, 0}, 1, 0), {}, {}, {"rim"}, {}}, size, e, scene);
    const QuantityBounds bounds(s.model, s.state);
    const Bounded out = bounds.work({{0, [](const Vec2&, const Vec2& n) { return n; }}});
    expect_contains(out, pi, title(e) + " rim");
    EXPECT_LT(width(out), (e.stress == 1 ? 0.5 : 0.1) * pi) << title(e);
    const Bounded wide = bounds.work({{0, [](const Vec2& x, const Vec2& n) -> Vec2 { return x.x() * x.x() * n; }}});
    expect_contains(wide, pi / 2, title(e) + " rim, by x^2");
  }
}

// Intervals of arcs hold the truth and are as narrow as those of a polygon about a value of its own.
TEST(CurvedBound, IsFarNarrowerThanWhatAPolygonIsAway) {
  const ExactField f = exact::kirsch(steel, pull, 0.7);
  const Vec2 x(0.9, 0.1);
  for (const int degree : {2, 3}) {
    const Scene scene = loaded(f, {}, {0});
    const Solved bowed(with_hole(circle("hole", {0, 0}, 0.7, 1)), 0.3, bdms(degree), scene),
        chords(with_hole(circle("hole", {0, 0}, 0.7, 1)), 0.3, bdms(degree), scene, false);
    const double arcs =
        contain_stress(QuantityBounds(bowed.model, bowed.state), x, f.stress(x, 0), words(bdms(degree), x));
    const double straight = width(QuantityBounds(chords.model, chords.state).stress(x).s22);
    EXPECT_LT(arcs, 0.4 * straight) << degree << " " << arcs << " " << straight;
  }
}

// K at both tips of an open arc, in closed form.
TEST_P(CurvedBounds, HoldKOfAnArc) {
  const Element& e = GetParam();
  const ExactField f = exact::arc_crack("arc", steel, {pull + Mat2::Identity(), 1, 0.8, pi / 2});
  Shape shape{square, {}, {arc_crack("arc", {0, 0}, 1, pi / 2 + 0.8, pi / 2 - 0.8)}, {"outside"}, {}};
  Scene scene = loaded(f, {}, {0});
  scene.laws = {{.kind = CrackLaw::Kind::Open}};
  const Solved s(shape, 0.3, e, scene);
  const QuantityBounds bounds(s.model, s.state);
  const std::vector<TipIntensity> tips = crack_tips(s.model, s.state);
  ASSERT_EQ(tips.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const TipBounds b = bounds.tip(tips[i]);
    const double size = std::hypot(f.tips[i].k1, f.tips[i].k2);
    expect_contains(b.K_I, f.tips[i].k1, title(e) + " K_I");
    expect_contains(b.K_II, f.tips[i].k2, title(e) + " K_II");
    expect_contains(b.G, size * size / plane_modulus(steel), title(e) + " G");
    EXPECT_LT(width(b.K_I), 0.1 * size) << title(e);
  }
}

}  // namespace
}  // namespace kerf::curved_bounds_test
