#pragma once
// The body as drawn: an outline, holes, cracks, regions of other materials. Curved sides stay exact until the mesher
// splits them.

#include "kerf/types.hpp"

#include <optional>
#include <vector>

namespace kerf {

/// x(t) = center + axes (cos t, sin t), t from `from` to `to` (radians; either direction).
/// The columns of `axes` are the two semi-axis vectors: r I for a circle.
struct Arc {
  Vec2 center;
  Mat2 axes;
  double from, to;
};

struct Side {
  Vec2 start;  // it ends where the next side of the loop starts
  Index label = none;
  std::optional<Arc> arc;  // absent: straight
  bool keep = false;       // one edge of the mesh as it is, whatever the target size; straight sides only
  bool smooth = false;     // stands for a part of a smooth curve: its corners with others of its kind are no corners
};

struct Loop {  // closed; either orientation, find_problem does not mind
  std::string name;
  std::vector<Side> sides;
};

struct Crack {
  std::string name;
  std::vector<Vec2> points;  // polyline, closed only around a region; of an arc its start and its end
  std::optional<Arc> arc;    // of a circle, around a region also of an ellipse; absent: straight edges
};

struct Shape {
  Loop outline;
  std::vector<Loop> holes;
  std::vector<Crack> cracks;
  std::vector<std::string> labels;  // Side::label counts into this
  std::vector<Loop> regions;        // without labels; of nested ones the innermost counts
};

Loop circle(std::string name, const Vec2& center, double radius, Index label);
Loop ellipse(std::string name, const Vec2& center, const Vec2& semi_axes, double angle_rad, Index label);
Loop polygon(std::string name, const std::vector<Vec2>& points, Index label);
Crack arc_crack(std::string name, const Vec2& center, double radius, double from_rad, double to_rad);

double path_length(const Crack& crack);
/// Of the outline less that of the holes, which must lie inside and apart.
double area(const Shape& shape);

/// The loop as a counter-clockwise polygon whose vertices lie on it. No chord is further than `chord` from its arc, no
/// piece of an arc longer than `longest`; `label` per piece. Straight sides are not split.
struct Polygon {
  std::vector<Vec2> points;
  std::vector<Index> label;  // label[i] names points[i] -> points[i+1]
};
Polygon flatten(const Loop& loop, double chord, double longest);

/// The first thing that makes the shape unusable, in words that name it ("crack 'c' leaves the body at (1, 0)"), or
/// nothing. Knows: fewer than three sides, zero-length sides, non-finite numbers, a loop that crosses or touches
/// itself, holes outside the outline, touching it or each other, cracks outside the body or crossing its boundary,
/// overlapping cracks, cracks that meet at less than a degree, a crack that crosses itself or runs along the boundary.
/// Regions lie inside the body and touch nothing, neither one another nor holes, cracks and the outline, unless a crack
/// is made of their sides (an interface); they may lie inside one another and around holes and cracks. Cracks may
/// cross, and end on the outline, on a hole or on each other.
std::optional<std::string> find_problem(const Shape& shape);

/// Length scale of the shape: the diagonal of its bounding box.
double extent(const Shape& shape);

}  // namespace kerf
