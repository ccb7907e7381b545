#include "geometry/curved.hpp"

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

Mesh with_chords(const Mesh& mesh) {
  Mesh straight = mesh;
  straight.arc.clear();
  straight.arcs.clear();
  return straight;
}

}  // namespace kerf
