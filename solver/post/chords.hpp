#pragma once
// Edges of a mesh that stand for arcs of the shape.

#include "kerf/shape.hpp"

#include <array>
#include <vector>

namespace kerf {

/// The sides of a shape, asked for the arc that an edge is a chord of.
class Chords {
 public:
  explicit Chords(const Shape& shape);
  bool empty() const {
    return arcs_.empty();
  }
  /// The curvature of the arc that the edge from a to b is a chord of, or a part of a chord as long as h; 0 for none:
  /// what lies on a straight side is no chord, and no chord is longer than the circle is wide.
  double curvature(const Vec2& a, const Vec2& b, double h) const;

 private:
  bool is_straight(const Vec2& a, const Vec2& b) const;
  std::vector<Arc> arcs_;
  std::vector<std::array<Vec2, 2>> straight_;
};

}  // namespace kerf
