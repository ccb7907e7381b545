// Cracks close beneath a side: the ligament is a beam on a foundation that only presses.

#include "kerf/adaptive.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "tests/solver/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::ligament_test {
namespace {

constexpr double top = 0.5, half_length = 0.25;

Shape beneath(double depth) {
  Shape shape;
  shape.outline = polygon("outline", {{-0.5, -0.5}, {0.5, -0.5}, {0.5, top}, {-0.5, top}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  shape.cracks = {{"c", {{-half_length, top - depth}, {half_length, top - depth}}, {}}};
  return shape;
}

/// Clamped below, `pull` on the top.
Scene pulled(const std::function<double(double)>& pull, CrackLaw::Kind kind = CrackLaw::Kind::Unilateral) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  s.tractions.push_back({2, [pull](const Vec2& x, const Vec2&) -> Vec2 { return {0, pull(x.x())}; }});
  s.laws.assign(1, {.kind = kind});
  return s;
}

double bending_stiffness(double depth) {
  return std::pow(depth, 3) / 12 / (1 - 0.3 * 0.3);
}

// A beam between clamps: deflections by Euler and Bernoulli, but for what the clamps give, some depths of length.
TEST(Ligament, BendsAsAClampedBeam) {
  for (const double depth : {1e-3, 1e-4}) {
    const Model m = prepare(triangulate(beneath(depth), {.size = 0.05, .long_ligaments = true}), element("bdms"),
                            pulled([](double) { return 1.0; }, CrackLaw::Kind::Open), 1);
    const State s = solve(m);
    EXPECT_TRUE(certified(s));
    double opening = 0;
    for (const CrackPoint& p : crack_profile(m, s, 0)) opening = std::max(opening, p.jump_n);
    const double beam = std::pow(2 * half_length, 4) / 384 / bending_stiffness(depth);
    EXPECT_NEAR(opening, beam, (0.01 + 20 * depth) * beam) << depth;
  }
}

// Pulled by 1 on |x| < a, pressed by 1 beside. It lifts on |x| < b, where moment and slope end with the opening, so
// that (b/a)^3 - 3 (b/a)^2 + 1 = 0; the opening in the middle by integration of its third derivative.
TEST(Ligament, LiftsAsABeamOnAFoundation) {
  constexpr double a = 0.05, b = 2.8793852 * a, depth = 3e-4;
  Adaptation how;
  const Adapted found = solve_graded(beneath(depth), {.size = 0.05, .long_ligaments = true}, element("bdms"),
                                     pulled([](double x) { return std::abs(x) < a ? 1.0 : -1.0; }), how);
  EXPECT_TRUE(certified(found.state));
  double from = 1, to = -1, opening = 0;
  for (const CrackPoint& p : crack_profile(found.model, found.state, 0)) {
    opening = std::max(opening, p.jump_n);
    if (p.status != CrackPoint::Status::Open || std::abs(p.s - half_length) > 0.9 * half_length) continue;
    from = std::min(from, p.s - half_length);
    to = std::max(to, p.s - half_length);
  }
  EXPECT_NEAR(to, b, 0.02 * b);
  EXPECT_NEAR(from, -b, 0.02 * b);
  const double beam =
      -(std::pow(a, 4) / 4 + 2 * a * (b * b * b - a * a * a) / 3 - (std::pow(b, 4) - std::pow(a, 4)) / 4) / 2 /
      bending_stiffness(depth);
  EXPECT_NEAR(opening, beam, 0.04 * beam);
}

// Nearly unloaded faces: the signs of their pressures are no guide to the set.
TEST(Ligament, IsSolvedWhereTheBodyBends) {
  Scene s = pulled([](double) { return 0.0; });
  for (const Index side : {1, 3})
    s.tractions.push_back({side, [](const Vec2& x, const Vec2& n) -> Vec2 { return {n.x() * x.y(), 0}; }});
  const Model m = prepare(triangulate(beneath(1e-4), {.size = 0.05, .long_ligaments = true}), element("bdms"), s, 1);
  const State state = solve(m);
  EXPECT_TRUE(certified(state));
  EXPECT_LT(state.contact_iterations, 100);
}

}  // namespace
}  // namespace kerf::ligament_test
