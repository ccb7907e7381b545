// What a path meets first: crossings of its edges with sides and cracks, arcs among these by chords whose crossings are
// put onto the arc.

#include "growth/obstacles.hpp"

#include "geometry/plane.hpp"

#include <fmt/format.h>

namespace kerf::growth {

namespace {

/// The arc must outlive them.
void add_arc(const Arc& arc, const std::string& name, std::vector<PathObstacle>& all) {
  constexpr int pieces = 64;
  const std::vector<Vec2> p = points_on(arc, pieces);
  for (std::size_t k = 0; k < pieces; ++k) all.push_back({p[k], p[k + 1], name, &arc});
}
}  // namespace

void add_sides(const Loop& loop, const std::string& name, std::vector<PathObstacle>& all) {
  for (std::size_t i = 0; i < loop.sides.size(); ++i) {
    const Side& side = loop.sides[i];
    if (!side.arc) {
      all.push_back({side.start, loop.sides[(i + 1) % loop.sides.size()].start, name});
      continue;
    }
    add_arc(*side.arc, name, all);
  }
}
std::vector<PathObstacle> obstacles(const Shape& shape, const CrackEnd& own, std::size_t own_edges) {
  std::vector<PathObstacle> all;
  add_sides(shape.outline, "the outline", all);
  for (const Loop& hole : shape.holes) add_sides(hole, fmt::format("hole \"{}\"", hole.name), all);
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    const Crack& crack = shape.cracks[c];
    const auto& p = crack.points;
    const bool is_own = static_cast<Index>(c) == own.crack;
    if (crack.arc) {
      add_arc(*crack.arc, fmt::format("crack \"{}\"", crack.name), all);
      continue;
    }
    const std::size_t count = p.size() - 1;  // edges
    for (std::size_t i = 0; i < count; ++i) {
      // The edges next to the tip are what it grows from.
      const std::size_t away = own.at_start ? i : count - 1 - i;
      if (is_own && away < own_edges) continue;
      all.push_back({p[i], p[i + 1], fmt::format("crack \"{}\"", crack.name)});
    }
  }
  return all;
}

std::optional<Hit> first_hit(const std::vector<PathObstacle>& all, const Vec2& tip, std::vector<Vec2> path,
                             double reach) {
  const Vec2 before = path.size() > 1 ? path[path.size() - 2] : tip;
  path.back() += reach * (path.back() - before).normalized();
  Vec2 from = tip;
  for (std::size_t k = 0; k < path.size(); ++k) {
    std::optional<Hit> nearest;
    for (const PathObstacle& o : all)
      if (const auto s = crossing(from, path[k], o.a, o.b);
          s && (!nearest || *s + static_cast<double>(k) < nearest->along)) {
        const Vec2 at = from + *s * (path[k] - from);
        // Of pieces on one line rounding alone decides which side is which: what lies elsewhere is not met.
        if (distance(at, o.a, o.b) > 1e-6 * (path[k] - from).norm()) continue;
        nearest = Hit{o.arc ? onto(*o.arc, at) : at, o.name, static_cast<double>(k) + *s};
      }
    if (nearest) return nearest;
    from = path[k];
  }
  return std::nullopt;
}

std::optional<BorderCrossing> crossing_of(const Loop& region, const Vec2& tip, const std::vector<Vec2>& path) {
  std::vector<PathObstacle> sides;
  add_sides(region, fmt::format("region \"{}\"", region.name), sides);
  const std::optional<Hit> first = first_hit(sides, tip, path, 0);
  if (!first) return std::nullopt;
  std::vector<Vec2> border;
  for (const PathObstacle& side : sides) border.push_back(side.a);
  const bool within = inside(border, path.back());
  return BorderCrossing{*first, inside(border, tip) != within, within};
}

}  // namespace kerf::growth
