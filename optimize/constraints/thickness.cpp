// Local thickness by discs that touch the boundary at a sample p with the normal n into the body: the largest empty one
// has the diameter min over q of |q - p|^2 / (n . (q - p)) [Ma, Bae, Choi 2012: shrinking balls]. Where the nearest q
// faces p, normals more than 120 degrees apart, both are the sides of a member; elsewhere the disc lies in a corner,
// whose branch of the medial axis ends on the boundary and says nothing about members. q goes over the samples that
// face p: with a step s along the boundary the diameter t of parallel sides is at most s^2 / (4 t) too large.

#include "optimize/constraints/thickness.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

struct Touch {
  Vec2 at, inward;
  bool moves;
};

using Cell = std::pair<long, long>;
Cell cell_of(const Vec2& x, double size) {
  return {std::lround(std::floor(x.x() / size)), std::lround(std::floor(x.y() / size))};
}

}  // namespace

Thinnest thinnest(const std::vector<DrawnSide>& sides, const std::vector<bool>& moves, bool gaps, double most) {
  constexpr double per_width = 24, facing = -0.5;
  const double step = most / per_width;
  std::vector<Touch> all;
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const int n = std::max(1, int(std::ceil(length(sides[i]) / step)));
    for (int k = 0; k < n; ++k) {
      const double part = (k + 0.5) / n;
      const Vec2 t = tangent(sides[i], part), x = at(sides[i], part), left(-t.y(), t.x());
      cells[cell_of(x, most)].push_back(all.size());
      all.push_back({x, gaps ? Vec2(-left) : left, moves[i]});
    }
  }
  Thinnest found;
  for (const Touch& p : all) {
    const auto [x, y] = cell_of(p.at, most);
    for (long dx = -1; dx <= 1; ++dx)
      for (long dy = -1; dy <= 1; ++dy) {
        const auto here = cells.find({x + dx, y + dy});
        if (here == cells.end()) continue;
        for (const std::size_t k : here->second) {
          const Touch& q = all[k];
          if (!(p.moves || q.moves) || p.inward.dot(q.inward) > facing) continue;
          const Vec2 way = q.at - p.at;
          const double across = p.inward.dot(way), squared = way.squaredNorm();
          if (!(across > 0) || !(squared < std::min(found.width, most) * across)) continue;
          // It touches q from the inside, too.
          if (!(q.inward.dot(-way) > 0.5 * way.norm()) || across < 0.5 * way.norm()) continue;
          found = {squared / across, 0.5 * (p.at + q.at)};
        }
      }
  }
  return found;
}

}  // namespace kerf
