// Signed depth of points in a body, and an upper bound of it over a box: samples at distances that it cannot change
// more over.

#include "optimize/refuse/extent_of_body.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

Depth::Depth(const Shape& body, double chord) : chord_(chord) {
  add(body.outline);
  for (const Loop& hole : body.holes) add(hole);
}

Depth::Depth(const Loop& loop, double chord) : chord_(chord) {
  add(loop);
}

void Depth::add(const Loop& loop) {
  const Polygon p = flatten(loop, chord_, infinity);
  for (std::size_t i = 0; i < p.points.size(); ++i)
    sides_.push_back({p.points[i], p.points[(i + 1) % p.points.size()]});
}

// The nearest side tells how far, the inside or outside its sign.
double Depth::operator()(const Vec2& x) const {
  double least = infinity;
  for (const auto& [a, b] : sides_) least = std::min(least, squared_distance(x, a, b));
  return (inside(sides_, x) ? 1 : -1) * std::sqrt(least);
}

double Depth::most(const Vec2& low, const Vec2& high) const {
  // Depth is Lipschitz with constant 1: no point is farther than half a cell's diagonal from a sample.
  constexpr int pieces = 48;
  const Vec2 cell = (high - low) / pieces;
  const int columns = cell.x() > 0 ? pieces : 1, rows = cell.y() > 0 ? pieces : 1;
  double deepest = -infinity;
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k)
      deepest = std::max(deepest, (*this)(low + Vec2((i + 0.5) * cell.x(), (k + 0.5) * cell.y())));
  return deepest + 0.5 * cell.norm() + chord_;
}

// Of the loop's chords, 1e-6 of its size off its arcs.
std::array<Vec2, 2> box_of(const Loop& loop) {
  double size = 0;
  for (const Side& side : loop.sides)
    size = std::max({size, (side.start - loop.sides[0].start).norm(), side.arc ? largest_radius(*side.arc) : 0.0});
  std::array<Vec2, 2> box{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
  for (const Vec2& x : flatten(loop, 1e-6 * size, infinity).points) {
    box[0] = box[0].cwiseMin(x);
    box[1] = box[1].cwiseMax(x);
  }
  return box;
}

}  // namespace kerf
