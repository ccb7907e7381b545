// The arcs of a shape, and a mesh with chords in place of its curved edges.

#include "geometry/curved.hpp"

#include "kerf/folded.hpp"

#include <fmt/core.h>

namespace kerf {

std::vector<Arc> arcs_of(const Shape& shape) {
  std::vector<Arc> arcs;
  const auto add = [&](const Loop& loop) {
    for (const Side& side : loop.sides)
      if (side.arc) arcs.push_back(*side.arc);
  };
  add(shape.outline);
  for (const Loop& hole : shape.holes) add(hole);
  for (const Loop& region : shape.regions) add(region);
  for (const Crack& crack : shape.cracks)
    if (crack.arc) arcs.push_back(*crack.arc);
  return arcs;
}

FoldedTriangle::FoldedTriangle(const Vec2& at)
    : Error(Fault::Numerics,
            fmt::format("the curved side at ({:.6g}, {:.6g}) folds the triangle beside it; make mesh.size smaller, or "
                        "use mesh.curved = false",
                        at.x(), at.y())) {}

Mesh with_chords(const Mesh& mesh) {
  Mesh straight = mesh;
  straight.arc.clear();
  straight.arcs.clear();
  return straight;
}

}  // namespace kerf
