#pragma once
// Sides along the curves of a geometry: circles stay arcs, other curves become chains of arcs.

#include "io/mesh/outlines.hpp"
#include "io/mesh/raw.hpp"

namespace kerf {

/// How far chains may lie from their curves, of the extent of the body.
inline constexpr double curve_tolerance = 2e-5;

/// What edges belong to, and what that is. A curve that is not there is followed by chords.
struct OnCurves {
  const std::map<std::int32_t, RawCurve>& curves;
  const std::vector<std::int32_t>& entity;  // per edge
  double extent;
  const std::vector<Index>& bent;  // per edge with an arc in the mesh, its curve; empty when all edges are straight
};

/// The sides of a loop; `label` per edge.
std::vector<Side> drawn_sides(const Mesh& mesh, const RimLoop& loop, const std::vector<Index>& label,
                              const OnCurves& on);

/// A path along curves: an arc if it is one, else a polyline.
Crack drawn_crack(const Mesh& mesh, const std::vector<CrackEdge>& path, const OnCurves& on);

}  // namespace kerf
