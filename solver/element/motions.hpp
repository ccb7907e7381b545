#pragma once
// The traces of rigid motions on one triangle.

#include "geometry/plane.hpp"
#include "solver/element/local.hpp"

#include <Eigen/LU>

namespace kerf {

/// visit(first unknown, frame, from, to, s, beyond) for every pair of unknowns that are displacements at the point from
/// + s (to - from) + beyond. Edges go in their own direction, so that both sides of an edge agree on its points to the
/// last bit.
template <class Visit>
void for_each_point(const Kernel& k, const Triangle& t, const Visit& visit) {
  const int points = points_per_edge(k.element);
  for (int e = 0; e < 3; ++e) {
    const Vec2 &a = t.x[(e + (t.forward[e] ? 1 : 2)) % 3], &b = t.x[(e + (t.forward[e] ? 2 : 1)) % 3];
    for (int g = 0; g < points; ++g) {
      const double s = k.trace.s[g];
      visit(2 * (points * e + g), frame_at(t, e, g), a, b, s,
            t.curvature[e] ? Vec2(s * (1 - s) * height(*t.curvature[e], s)) : Vec2::Zero().eval());
    }
  }
  if (k.element.at_vertices == AtVertices::Displacement)
    for (int v = 0; v < 3; ++v)
      visit(6 * points + 2 * v, Mat2(t.corner[v].topLeftCorner<2, 2>()), t.x[v], t.x[v], 0.0, Vec2::Zero().eval());
}

/// Of the translations and of the rotation by 1/h about the center, a column each; and the inverse of their Gram
/// matrix.
struct MotionTraces {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, max_skeleton, 3> span;
  Eigen::Matrix3d inverse;
};
/// The rotation is x -> (cross(d, e1), cross(d, e2)) with d the place over h. In the sign of (N.1) its rotation is
/// -1/h. Least squares against these columns take a rigid motion out of a trace: P of (E.18).
inline MotionTraces motion_traces(const Kernel& k, const Triangle& t, const Vec2& center, double h) {
  MotionTraces m;
  m.span.setZero(skeleton_count(k.element), 3);
  for_each_point(k, t, [&](int first, const Mat2& frame, const Vec2& a, const Vec2& b, double at, const Vec2& beyond) {
    const Vec2 d = (a + at * (b - a) + beyond - center) / h;
    for (int c = 0; c < 2; ++c) m.span.row(first + c) << frame(0, c), frame(1, c), cross(d, frame.col(c));
  });
  if (k.element.at_vertices == AtVertices::Rotation) m.span.bottomRightCorner<3, 1>().setConstant(-1 / h);
  m.inverse = Eigen::Matrix3d(m.span.transpose() * m.span).inverse();
  return m;
}

}  // namespace kerf
