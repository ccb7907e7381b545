#pragma once
// The boundary of a body side by side, the body on the left: points, tangents, and exact distances to it.

#include "kerf/shape.hpp"

#include <span>

namespace kerf {

/// A side of a loop from `a` to `b`; an arc runs from its `from` to its `to`.
struct DrawnSide {
  Vec2 a, b;
  std::optional<Arc> arc;
  Index label = none;
  bool keep = false, smooth = false;  // as of a Side
};

/// Those of a loop in their order, counter-clockwise or, of a hole, clockwise, whatever the loop's own orientation.
void add_sides(const Loop& loop, bool hole, std::vector<DrawnSide>& out);
/// Those of the outline and of all holes.
std::vector<DrawnSide> sides_of(const Shape& body);

Vec2 at(const DrawnSide& side, double part);       // part: 0 at a, 1 at b
Vec2 tangent(const DrawnSide& side, double part);  // of length 1
double length(const DrawnSide& side);              // at most; exact but for ellipses
/// The area to the left of a closed loop, for its sign: arcs are taken in pieces.
double signed_area(const std::vector<DrawnSide>& loop);
/// Adds the t with A cos t + B sin t + C = 0 between `from` and `to`, as parts in (0, 1) of the way.
void add_roots(double A, double B, double C, double from, double to, std::vector<double>& parts);
bool is_round(const Arc& arc);  // of a circle
/// The loop that has these sides, one behind the other.
Loop loop_of(const std::string& name, const std::vector<DrawnSide>& sides);
/// Where on the side the point nearest to x lies. Exact for lines and circles, to rounding for ellipses.
double nearest(const DrawnSide& side, const Vec2& x);

/// A closed region by the sides around it.
class Region {
 public:
  explicit Region(std::vector<DrawnSide> sides);
  explicit Region(const Shape& body) : Region(sides_of(body)) {}
  explicit Region(const Loop& loop);

  /// Distance to the boundary, positive inside, to rounding.
  double depth(const Vec2& x) const;
  /// Distance to the boundary.
  double away(const Vec2& x) const;
  const std::vector<DrawnSide>& sides() const {
    return sides_;
  }

 private:
  struct Foot {
    std::size_t side;
    double part, squared;
  };
  Foot foot_of(const Vec2& x) const;
  std::vector<DrawnSide> sides_;
  std::vector<std::size_t> before_, after_;  // of each side its neighbors
  struct Ball {
    Vec2 center;
    double radius;
  };
  std::vector<Ball> around_;  // each side
};

}  // namespace kerf
