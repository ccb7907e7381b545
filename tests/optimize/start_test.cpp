// Patterns of holes to start from: their number and place by hand; random ones repeat.

#include "optimize/level_set/starts.hpp"

#include "geometry/carve.hpp"
#include "optimize/constraints/sides.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::start_test {
namespace {

TEST(StartDiscs, RegularPatternsLieInTheBoxAndRandomOnesRepeat) {
  const StartHoles regular{.columns = 4, .rows = 3, .radius = 0.1};
  const std::vector<Disc> discs = start_discs(regular, {0, 0}, {2, 1});
  EXPECT_EQ(discs.size(), 14u);  // columns of 3 and 4 by turns
  for (const Disc& d : discs)
    EXPECT_TRUE(d.center.x() > 0 && d.center.x() < 2 && d.center.y() >= 0 && d.center.y() <= 1);

  const StartHoles random{.random = 5, .seed = 7};
  const std::vector<Disc> a = start_discs(random, {0, 0}, {2, 1}), b = start_discs(random, {0, 0}, {2, 1});
  ASSERT_EQ(a.size(), 5u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].center, b[i].center);
  EXPECT_NE(a[0].center, start_discs({.random = 5, .seed = 8}, {0, 0}, {2, 1})[0].center);
}

/// [0, 2] x [0, 1], turned.
Problem body(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto at = [&](double x, double y) { return Vec2(c * x - s * y, s * x + c * y); };
  Problem p;
  p.frame.labels = {"free"};
  p.frame.outline = polygon("outline", {at(0, 0), at(2, 0), at(2, 1), at(0, 1)}, 0);
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 0, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.sizing.size = 0.1;
  p.objective = {"compliance", {compliance()}};
  return p;
}

// Sides of the frame that the design has stay its own, on whichever side they lie.
TEST(StartDesign, IsBegunWithUpToTheFrame) {
  for (int k = 0; k < 12; ++k) {
    const Problem p = body(k * pi / 6);
    OptimizeRequest r;
    Shape design = p.frame;
    const double cut = 0.2 + 0.05 * k;  // a corner of the frame
    const std::vector<Side> sides = p.frame.outline.sides;
    const auto part = [&](std::size_t i, double share) {
      return Vec2((1 - share) * sides[i].start + share * sides[(i + 1) % 4].start);
    };
    const std::size_t corner = std::size_t(k % 4), before = (corner + 3) % 4;
    design.labels.push_back("design");
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == corner) points.push_back(part(before, 1 - cut));
      points.push_back(i == corner ? part(corner, cut) : sides[i].start);
    }
    design.outline = polygon("outline", points, 0);
    design.holes = {circle("hole", part(corner, 0.5) * 0.5 + part((corner + 2) % 4, 0.5) * 0.5, 0.15, 1)};
    r.level_set.start_design = design;
    const Ground g = make_ground(p, r);
    const LevelSetStart start = best_start(g);
    EXPECT_EQ(start.name, "the design given");
    EXPECT_NEAR(negative_area(g.background.mesh, start.phi), area(design), 0.015 * area(design)) << k;
    const Region there(design);
    for (Eigen::Index v = 0; v < start.phi.size(); ++v) {
      const double depth = there.depth(g.background.mesh.points[std::size_t(v)]);
      if (std::abs(depth) > 1e-9) {
        EXPECT_EQ(start.phi[v]<0, depth> 0) << k;
      }
    }
  }
}

}  // namespace
}  // namespace kerf::start_test
