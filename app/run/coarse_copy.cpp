// The fields of a divided body at the corners of the mesh before it was divided, for pictures and the page.

#include "app/run/coarse_copy.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

std::vector<CopiedCorner> copied_corners(const Mesh& coarse, std::span<const Index> origin, Index own, const Mesh& mesh,
                                         const PlotData& data, const Mapped* map) {
  std::vector<CopiedCorner> copied;
  for (Index t = 0; t < own; ++t) {
    const Index from = origin[static_cast<std::size_t>(t)];
    const auto& before = coarse.triangles[static_cast<std::size_t>(from)];
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& x = mesh.points[static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(t)][i])];
      const auto corner =
          std::ranges::find_if(before, [&](Index v) { return coarse.points[static_cast<std::size_t>(v)] == x; });
      if (corner == before.end()) continue;
      const Index at = data.corners.of[static_cast<std::size_t>(t)][i];
      const Vec2 u = data.values.displacement.col(at);
      const Eigen::Vector4d s = data.values.stress.col(at);
      copied.push_back({.triangle = from,
                        .corner = static_cast<int>(corner - before.begin()),
                        .displacement = {u[0], u[1]},
                        .stress = {s[0], s[1], s[2], s[3]},
                        .von_mises = data.von_mises[at],
                        .derivative = map ? map->full.at_corners[at] : nan,
                        .margin = map ? map->full.margin[at] : nan,
                        .left_out = map ? map->left_out_corner[static_cast<std::size_t>(at)] : LeftOut::No});
    }
  }
  return copied;
}

std::vector<CopiedCenter> copied_centers(std::span<const Index> origin, Index own, const Mapped& map) {
  std::vector<CopiedCenter> copied;
  const bool oriented = map.full.angle.size() > 0;
  // Those of one triangle follow each other, in its middle the last one.
  for (Index t = 0; t < own; ++t) {
    const Index from = origin[static_cast<std::size_t>(t)];
    if (t + 1 < static_cast<Index>(origin.size()) && origin[static_cast<std::size_t>(t) + 1] == from) continue;
    copied.push_back({from, map.full.at_centroids[t], oriented ? map.full.angle[t] : nan});
  }
  return copied;
}

CoarseCopy coarse_copy(Model model, std::span<const CopiedCorner> corners, std::span<const CopiedCenter> centers) {
  CoarseCopy copy{.adapted = {.model = std::move(model)}, .data = {}, .map = {}};
  copy.data = plot_corners(copy.adapted.model);
  const auto n = static_cast<Eigen::Index>(copy.data.points.size());
  CornerValues& values = copy.data.values;
  values.displacement.setZero(2, n);
  values.stress.setZero(4, n);
  copy.data.von_mises.setZero(n);
  copy.map.full.at_corners.setConstant(n, nan);
  copy.map.full.margin.setConstant(n, nan);
  copy.map.left_out_corner.assign(static_cast<std::size_t>(n), LeftOut::No);
  copy.map.full.masked_corner.assign(static_cast<std::size_t>(n), false);
  for (const CopiedCorner& c : corners) {
    const Index at = copy.data.corners.of[static_cast<std::size_t>(c.triangle)][static_cast<std::size_t>(c.corner)];
    values.displacement.col(at) << c.displacement[0], c.displacement[1];
    values.stress.col(at) << c.stress[0], c.stress[1], c.stress[2], c.stress[3];
    copy.data.von_mises[at] = c.von_mises;
    copy.map.full.at_corners[at] = c.derivative;
    copy.map.full.margin[at] = c.margin;
    copy.map.left_out_corner[static_cast<std::size_t>(at)] = c.left_out;
    copy.map.full.masked_corner[static_cast<std::size_t>(at)] = c.left_out != LeftOut::No;
  }
  const auto triangles = static_cast<Eigen::Index>(copy.data.corners.of.size());
  copy.map.full.at_centroids.setConstant(triangles, nan);
  if (std::ranges::any_of(centers, [](const CopiedCenter& c) { return !std::isnan(c.angle); }))
    copy.map.full.angle.setConstant(triangles, nan);
  for (const CopiedCenter& c : centers) {
    copy.map.full.at_centroids[c.triangle] = c.derivative;
    if (copy.map.full.angle.size() > 0) copy.map.full.angle[c.triangle] = c.angle;
  }
  return copy;
}

}  // namespace kerf
