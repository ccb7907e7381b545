#include "optimize/level_set/nucleate.hpp"

#include <algorithm>
#include <numeric>

namespace kerf {

std::vector<Disc> places_to_nucleate(const BackgroundMesh& background, const Eigen::VectorXd& distance,
                                     const Mesh& mesh, const Eigen::VectorXd& T, const Nucleation& how) {
  constexpr double clear = 3;  // radii
  std::vector<Index> order(static_cast<std::size_t>(T.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return std::tie(T[a], a) < std::tie(T[b], b); });
  std::vector<Disc> discs;
  double left = how.area;
  for (const Index t : order) {
    if (!(T[t] < how.multiplier) || left <= 0) break;
    const Vec2 x = centroid(mesh, t);
    double room = -value_at(background, distance, x);
    if (background.frozen.size() > 0) room = std::min(room, value_at(background, background.frozen, x));
    for (const Disc& d : discs) room = std::min(room, (d.center - x).norm() - d.radius);
    if (room < clear * how.least) continue;
    discs.push_back({x, std::min(room / clear, how.most)});
    left -= pi * discs.back().radius * discs.back().radius;
  }
  return discs;
}

}  // namespace kerf
