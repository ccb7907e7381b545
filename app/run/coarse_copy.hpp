#pragma once
// A divided body as its pictures and its page show it: at the corners of the mesh before it was divided.

#include "app/run/map.hpp"

namespace kerf {

/// What a divided body has at a corner of a triangle of the mesh before.
struct CopiedCorner {
  Index triangle;
  int corner;
  std::array<double, 2> displacement;
  std::array<double, 4> stress;
  double von_mises;
  double derivative, margin;  // of a map, or NaN
  LeftOut left_out;
};
/// Of the first triangles of a part, as many as `own`; `origin`: MeshPart::origin; `map`: everywhere, or null.
std::vector<CopiedCorner> copied_corners(const Mesh& coarse, std::span<const Index> origin, Index own, const Mesh& mesh,
                                         const PlotData& data, const Mapped* map);

/// What a map has at the centroid of a triangle of the mesh before, which is that of the middle one of its parts.
struct CopiedCenter {
  Index triangle;
  double derivative, angle;  // NaN where a map has none
};
std::vector<CopiedCenter> copied_centers(std::span<const Index> origin, Index own, const Mapped& map);

struct CoarseCopy {
  Adapted adapted;  // the model before the division, without a factor and a state
  PlotData data;
  Mapped map;  // empty without one
};
CoarseCopy coarse_copy(Model model, std::span<const CopiedCorner> corners, std::span<const CopiedCenter> centers);

}  // namespace kerf
