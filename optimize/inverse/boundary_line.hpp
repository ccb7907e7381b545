#pragma once
// A labeled part of the boundary as smooth curves that know their arc length.

#include "kerf/shape.hpp"

namespace kerf {

/// From corner to corner, or to where the label ends; counter-clockwise around its loop.
struct BoundaryCurve {
  std::vector<Vec2> points;
  std::vector<double> arc;         // length from the first point, per point
  Index joint[2] = {none, none};   // at its start and its end: the same number where curves of the label meet
  Index beside[2] = {none, none};  // the label on the other side of these ends
};

struct BoundaryLine {
  std::vector<BoundaryCurve> curves;
  Index joints = 0;
  double length = 0;
};

/// Empty when nothing of the outline and the holes has this label. Corners turn by more than 20 degrees.
BoundaryLine boundary_line(const Shape& shape, Index label);

struct Place {
  Index curve = none;
  double arc = 0, distance = 0;
};
Place nearest_place(const BoundaryLine& line, const Vec2& x);
Vec2 point_at(const BoundaryCurve& curve, double arc);

}  // namespace kerf
