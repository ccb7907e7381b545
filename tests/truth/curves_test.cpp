// The hole of a given size that weakens a plate the least is an ellipse whose axes are as the stresses at infinity, and
// the hoop stress around it is constant, their sum [Cherepanov 1974]. Told by displacement elements on a fine mesh.

#include "optimize/curves.hpp"
#include "kerf/recover.hpp"
#include "tests/optimize/curves.hpp"

#include <gtest/gtest.h>

namespace kerf::curves_test {

TEST(CurvesTruth, AHoleUnderTwoStressesBecomesTheEllipseOfConstantHoopStress) {
  const double side = 4;
  const Problem p = scenes::quarter_plate(side, 0.08);
  const Carved carved = scenes::quarter_hole(p, 0.6, 10);
  OptimizeRequest r;
  r.volume_at_most = carved.area / area(p.frame);
  const FinishedCurves f = finish_curves(p, r, carved, {}, {});
  EXPECT_LE(f.residual, 0.01) << f.why;
  double a = 0, b = 0;  // semi-axes
  for (const Side& s : f.shape.outline.sides) {
    if (std::abs(s.start.y()) < 1e-9 && s.start.x() < 0.5 * side) a = s.start.x();
    if (std::abs(s.start.x()) < 1e-9 && s.start.y() < 0.5 * side) b = s.start.y();
  }
  EXPECT_NEAR(a / b, 2, 0.08);  // the plate is not infinite
  EXPECT_NEAR(a * b, 0.36, 0.01);

  Sizing fine = p.sizing;
  fine.size = 0.04;
  const Model m = prepare(triangulate(f.shape, fine), element("p2", 1), p.scene, 1);
  const State state = solve(m);
  double sum = 0, squares = 0, length = 0, least = infinity, most = 0;
  for (std::size_t e = 0; e < m.mesh.edges.size(); ++e) {
    if (m.mesh.label[e] != carved.design_label) continue;
    const Index t = std::max(m.mesh.sides[e][0], m.mesh.sides[e][1]);
    const Vec2 way = tangent(m.mesh, Index(e)),
               x = 0.5 * (m.mesh.points[m.mesh.edges[e][0]] + m.mesh.points[m.mesh.edges[e][1]]);
    const Eigen::Vector4d s = evaluate(m, state, t, x).stress;
    const double hoop =
        way.x() * way.x() * s[0] + 2 * way.x() * way.y() * 0.5 * (s[1] + s[2]) + way.y() * way.y() * s[3];
    sum += hoop * kerf::length(m.mesh, Index(e));
    squares += hoop * hoop * kerf::length(m.mesh, Index(e));
    length += kerf::length(m.mesh, Index(e));
    least = std::min(least, hoop);
    most = std::max(most, hoop);
  }
  const double mean = sum / length;
  EXPECT_NEAR(mean, 3, 0.15);                                         // 3 in an infinite plate
  EXPECT_LT(std::sqrt(squares / length - mean * mean), 0.05 * mean);  // around a circle it runs from 1 to 5
  EXPECT_GT(least, 0.9 * mean);
  EXPECT_LT(most, 1.1 * mean);
}

}  // namespace kerf::curves_test
