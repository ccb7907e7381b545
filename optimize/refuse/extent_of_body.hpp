#pragma once
// How deep points lie in a body, by its outline and its holes.

#include "geometry/plane.hpp"

namespace kerf {

/// Signed distance to the boundary, positive inside: it changes by no more than the way between two points, which makes
/// samples proofs.
class Depth {
 public:
  /// Arcs become chords, up to `chord` away from them.
  Depth(const Shape& body, double chord);
  explicit Depth(const Loop& loop, double chord);
  double operator()(const Vec2& x) const;
  /// At least the largest depth in the box; more than that by 1/48 of its diagonal at most.
  double most(const Vec2& low, const Vec2& high) const;
  double chord() const {
    return chord_;
  }

 private:
  void add(const Loop& loop);
  std::vector<std::array<Vec2, 2>> sides_;
  double chord_;
};

/// The bounding box of a loop.
std::array<Vec2, 2> box_of(const Loop& loop);

}  // namespace kerf
