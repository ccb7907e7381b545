// Where contact on a crack ends, adjoints are singular: T on any mesh against a hole that is drawn, with another
// element, another contact solver and one degree more, the contact free, at two radii.

#include "geometry/part.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/analysis.hpp"
#include "kerf/map.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

namespace kerf::contact_end_test {
namespace {

using namespace scenes;

const Vec2 hole_at(0.15, 0.45);

double value(const Mesh& mesh, const Scene& scene, const Term& term) {
  const Model m = prepare(mesh, element("afw", 2), scene, 2);
  const State s = solve(m, ContactMethod::ActiveSet);
  EXPECT_TRUE(certified(s));
  return analyze({"", {term}}, m, s, true).value;
}

// (J(eps) - J(0)) / area, both on the triangles outside of the hole.
double quotient_of_drawn(const Body& b, const Term& term, double eps) {
  const double rounder = eps * std::sqrt(2 * pi / 48 / std::sin(2 * pi / 48));  // the polygon has the circle's area
  const Ball ball{hole_at, rounder, 48};
  Shape holed = b.shape;
  holed.labels.emplace_back("rim");
  holed.holes.push_back(ball_hole("drawn", ball, static_cast<Index>(holed.labels.size()) - 1));
  const Mesh outside = triangulate(holed, b.sizing);
  const Filled filled = fill(outside, {ball_mesh(ball, {})});
  return (value(outside, b.scene, term) - value(filled.mesh, b.scene, term)) / (pi * eps * eps);
}

TEST(ContactEnd, EverySizeGivesTheSameCoefficient) {
  const Scene scene = pulled(plane_strain(1, 0.3), closes_half);
  const Shape shape = cracked_square();
  const Adapted fine = solve_graded(shape, {.size = 0.08}, element("afw", 2), scene, {.threads = 2});
  const Body better{shape, scene, fine.sizing};
  for (const Term& term : {crack_opening(0, {}), crack_pressure(0, {}, {})}) {
    const double truth = (4 * quotient_of_drawn(better, term, 0.02) - quotient_of_drawn(better, term, 0.04)) / 3;
    for (const double size : {0.1, 0.06, 0.05}) {
      const Adapted a = solve_graded(shape, {.size = size}, element("bdms", 1), scene, {.threads = 2});
      const Functional j{"", {term}};
      const double T = map_at(analyze(j, a.model, a.state), j, {}, std::span(&hole_at, 1))[0].value;
      EXPECT_NEAR(T / truth, 1, 0.01) << term.kind << " size " << size;
    }
  }
}

// Once is enough where nothing ends.
TEST(ContactEnd, CracksAllOpenOrAllClosedAreSolvedOnce) {
  for (const double sign : {1., -1.}) {
    const Scene scene = pulled(plane_strain(1, 0.3), [=](const Vec2&) { return Vec2(0, sign); });
    const Adapted a = solve_graded(cracked_square(), {.size = 0.15}, element("bdms", 1), scene, {});
    EXPECT_EQ(a.rounds.size(), 1u);
    EXPECT_TRUE(a.sizing.ends.empty());
  }
}

}  // namespace
}  // namespace kerf::contact_end_test
