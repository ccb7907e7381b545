// Connected parts of the material of a level set, by a walk over neighboring vertices; parts that bear nothing become
// void.

#include "optimize/level_set/parts.hpp"

#include <algorithm>

namespace kerf {

std::span<const Index> neighbors(const BackgroundMesh& b, Index v) {
  const auto k = static_cast<std::size_t>(v);
  return {b.around.data() + b.start[k], static_cast<std::size_t>(b.start[k + 1] - b.start[k])};
}

// Flood fill over neighbors of the same kind; without kinds all material is alike.
MaterialParts material_parts(const BackgroundMesh& b, const Eigen::VectorXd& phi, std::span<const char> kind) {
  const std::size_t n = b.mesh.points.size();
  MaterialParts parts{std::vector<Index>(n, none), {}};
  std::vector<Index> open;
  const auto like = [&](std::size_t v, std::size_t w) { return kind.empty() || kind[v] == kind[w]; };
  for (std::size_t v = 0; v < n; ++v) {
    if (!(phi[static_cast<Eigen::Index>(v)] < 0) || parts.of[v] != none) continue;
    const auto number = static_cast<Index>(parts.first.size());
    parts.first.push_back(static_cast<Index>(v));
    parts.of[v] = number;
    open.assign(1, static_cast<Index>(v));
    while (!open.empty()) {
      const Index at = open.back();
      open.pop_back();
      for (const Index w : neighbors(b, at)) {
        const auto k = static_cast<std::size_t>(w);
        if (!(phi[w] < 0) || parts.of[k] != none || !like(v, k)) continue;
        parts.of[k] = number;
        open.push_back(w);
      }
    }
  }
  return parts;
}

std::vector<char> vertices_on(const BackgroundMesh& b, std::span<const Index> labels) {
  std::vector<char> on(b.mesh.points.size(), 0);
  for (std::size_t e = 0; e < b.mesh.edges.size(); ++e)
    if (b.mesh.label[e] != none && std::find(labels.begin(), labels.end(), b.mesh.label[e]) != labels.end())
      for (const Index v : b.mesh.edges[e]) on[static_cast<std::size_t>(v)] = 1;
  return on;
}

void empty_parts(const BackgroundMesh& b, const MaterialParts& parts, const std::vector<char>& gone,
                 Eigen::VectorXd& phi) {
  for (std::size_t v = 0; v < parts.of.size(); ++v)
    if (parts.of[v] != none && gone[static_cast<std::size_t>(parts.of[v])]) {
      double& value = phi[static_cast<Eigen::Index>(v)];
      // At least a tenth of an edge away from the zero line.
      value = std::max(-value, 0.1 * b.size);
    }
}

// Without loads the largest part stays; with them all parts that touch a loaded side.
void drop_islands(const BackgroundMesh& b, std::span<const Index> labels, Eigen::VectorXd& phi) {
  const MaterialParts parts = material_parts(b, phi, {});
  if (parts.first.size() < 2) return;
  std::vector<char> gone(parts.first.size(), 1);
  if (labels.empty()) {
    std::vector<double> weight(gone.size(), 0);
    for (std::size_t v = 0; v < parts.of.size(); ++v)
      if (parts.of[v] != none) weight[static_cast<std::size_t>(parts.of[v])] += b.lumped[static_cast<Eigen::Index>(v)];
    gone[static_cast<std::size_t>(std::max_element(weight.begin(), weight.end()) - weight.begin())] = 0;
  } else {
    const std::vector<char> on = vertices_on(b, labels);
    for (std::size_t v = 0; v < on.size(); ++v)
      if (on[v] && parts.of[v] != none) gone[static_cast<std::size_t>(parts.of[v])] = 0;
    if (std::find(gone.begin(), gone.end(), 0) == gone.end()) return;
  }
  empty_parts(b, parts, gone, phi);
}

}  // namespace kerf
