// Material that hangs on the rest of a level set by one thin neck and bears nothing is turned into void. The material
// is cut into thick and thin parts: thick is what discs of the given radius inside it cover. Parts and the places where
// they meet form a graph; a part that bears nothing and meets others at one place at most is a leaf, and leaves go
// until none is left. So a bar between two bodies stays, as does all that touches a load, a support or what stays
// solid. The count of a thick part's joints is kept up to date as its neighbors go.

#include "optimize/level_set/dangling.hpp"

#include "optimize/level_set/parts.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace kerf {

namespace {

using Flags = std::vector<char>;

/// Vertices of the material that discs of radius half_width inside it cover, up to an edge of the canvas.
/// Each disc is a walk over neighbors within it: the cost is the number of vertices times those of a disc.
Flags thick_parts(const BackgroundMesh& b, double half_width, const Eigen::VectorXd& phi) {
  Flags thick(b.mesh.points.size(), 0);
  std::vector<Index> seen, looked_from(thick.size(), none);  // which center looked at a vertex last
  const double reach = half_width + b.size;
  for (std::size_t center = 0; center < thick.size(); ++center) {
    if (!(phi[static_cast<Eigen::Index>(center)] < -half_width)) continue;
    // The disc around it, within the material: across a slit lies something else.
    seen.assign(1, static_cast<Index>(center));
    looked_from[center] = static_cast<Index>(center);
    thick[center] = 1;
    for (std::size_t k = 0; k < seen.size(); ++k)
      for (const Index w : neighbors(b, seen[k])) {
        const auto at = static_cast<std::size_t>(w);
        if (std::exchange(looked_from[at], static_cast<Index>(center)) == static_cast<Index>(center)) continue;
        if (!(phi[w] < 0) || (b.mesh.points[at] - b.mesh.points[center]).norm() > reach) continue;
        seen.push_back(w);
        thick[at] = 1;
      }
  }
  return thick;
}

/// Parts of the material, each all thick or all thin.
struct Parts : MaterialParts {
  Flags thin, bears;  // per part
};

Parts parts_of(const BackgroundMesh& b, const Flags& thick, const Flags& bearing, const Eigen::VectorXd& phi) {
  Parts parts{material_parts(b, phi, thick), {}, {}};
  for (const Index v : parts.first) parts.thin.push_back(!thick[static_cast<std::size_t>(v)]);
  parts.bears.assign(parts.first.size(), 0);
  for (std::size_t v = 0; v < bearing.size(); ++v)
    if (bearing[v] && parts.of[v] != none) parts.bears[static_cast<std::size_t>(parts.of[v])] = 1;
  return parts;
}

/// Where a thin part meets thick ones: the part that it meets, once per connected place.
/// Vertices of a thick part that touch the thin one are grouped by their connections: one group is one joint.
std::vector<std::vector<Index>> joints(const BackgroundMesh& b, const Parts& parts) {
  std::vector<std::map<Index, Index>> touched(parts.thin.size());  // per thin part: thick vertices -> group
  for (std::size_t v = 0; v < parts.of.size(); ++v) {
    if (parts.of[v] == none || !parts.thin[static_cast<std::size_t>(parts.of[v])]) continue;
    for (const Index w : neighbors(b, static_cast<Index>(v)))
      if (const Index other = parts.of[static_cast<std::size_t>(w)]; other != none && other != parts.of[v])
        touched[static_cast<std::size_t>(parts.of[v])][w] = none;
  }
  std::vector<std::vector<Index>> met(parts.thin.size());
  std::vector<Index> open;
  for (std::size_t p = 0; p < touched.size(); ++p)
    for (auto& [vertex, group] : touched[p]) {
      if (group != none) continue;
      group = vertex;
      met[p].push_back(parts.of[static_cast<std::size_t>(vertex)]);
      open.assign(1, vertex);
      while (!open.empty()) {
        const Index at = open.back();
        open.pop_back();
        for (const Index w : neighbors(b, at))
          if (const auto found = touched[p].find(w); found != touched[p].end() && found->second == none) {
            found->second = group;
            open.push_back(w);
          }
      }
    }
  return met;
}

Flags bearing_vertices(const BackgroundMesh& b, std::span<const Index> labels) {
  Flags bearing = vertices_on(b, labels);
  for (Eigen::Index v = 0; v < b.frozen.size(); ++v)
    if (b.frozen[v] <= 0) bearing[static_cast<std::size_t>(v)] = 1;
  return bearing;
}

}  // namespace

// Without anything that bears there is nothing that material could hang on.
void drop_dangling(const BackgroundMesh& b, std::span<const Index> labels, double half_width, Eigen::VectorXd& phi) {
  const Flags bearing = bearing_vertices(b, labels);
  if (std::find(bearing.begin(), bearing.end(), 1) == bearing.end()) return;
  const Parts parts = parts_of(b, thick_parts(b, half_width, phi), bearing, phi);
  std::vector<std::vector<Index>> met = joints(b, parts);
  // Of thick parts the joints are those of the thin ones; leaves go until there are none.
  std::vector<int> count(met.size(), 0);
  for (std::size_t p = 0; p < met.size(); ++p) {
    count[p] += static_cast<int>(met[p].size());
    for (const Index other : met[p]) ++count[static_cast<std::size_t>(other)];
  }
  Flags gone(met.size(), 0);
  for (bool again = true; std::exchange(again, false);)
    for (std::size_t p = 0; p < met.size(); ++p) {
      if (gone[p] || parts.bears[p] || count[p] > 1) continue;
      gone[p] = 1;
      again = true;
      for (std::size_t q = 0; q < met.size(); ++q)
        if (!gone[q]) {
          if (parts.thin[p] && !parts.thin[q])
            count[q] -= static_cast<int>(std::count(met[p].begin(), met[p].end(), static_cast<Index>(q)));
          if (parts.thin[q] && !parts.thin[p])
            count[q] -= static_cast<int>(std::count(met[q].begin(), met[q].end(), static_cast<Index>(p)));
        }
    }
  empty_parts(b, parts, gone, phi);
}

}  // namespace kerf
