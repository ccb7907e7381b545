#pragma once
// What a crack that grows may run into, and the borders of regions that it crosses.

#include "kerf/growth.hpp"

#include <optional>
#include <string>
#include <vector>

namespace kerf::growth {

/// A straight piece, or one of the chords of an arc, which must outlive it.
struct PathObstacle {
  Vec2 a, b;
  std::string name;
  const Arc* arc = nullptr;
};
/// The sides of a loop, which must outlive them.
void add_sides(const Loop& loop, const std::string& name, std::vector<PathObstacle>& all);
/// Of a tip: the outline, holes and cracks of a shape, which must outlive them, without the `own_edges` next to the
/// tip, which it grows from.
std::vector<PathObstacle> obstacles(const Shape& shape, const CrackEnd& own, std::size_t own_edges);

struct Hit {
  Vec2 at;
  std::string name;
  double along = 0;  // of the path up to there, in edges
};
/// The first thing that a path from the tip crosses, its last edge drawn longer by `reach`.
std::optional<Hit> first_hit(const std::vector<PathObstacle>& all, const Vec2& tip, std::vector<Vec2> path,
                             double reach);

/// Where a path crosses the border of a region; `inside`: whether its end lies there, `odd`: its two ends on two sides.
struct BorderCrossing {
  Hit first;
  bool odd = false, inside = false;
};
std::optional<BorderCrossing> crossing_of(const Loop& region, const Vec2& tip, const std::vector<Vec2>& path);

}  // namespace kerf::growth
