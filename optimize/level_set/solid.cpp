// What of a design stays solid: frozen loops, other materials, strips along loads and measurements, rings of
// functionals.

#include "optimize/level_set/solid.hpp"

#include "geometry/plane.hpp"
#include "optimize/loop/evaluate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

// Loads get strips that stay solid, supports none: `held` tells which they are.
Solid solid_parts(const Problem& p, const OptimizeRequest& r, double width, std::vector<std::string>& notes) {
  // Masks that end on the outline hold its vertices, too; what is of another material may not be touched.
  Solid solid{.width = width};
  // Frozen loops get two thirds of the strip, an edge of the canvas: linear functions there, smoothing and fits of
  // curves take less.
  for (const Loop& loop : r.level_set.frozen) solid.loops.emplace_back(loop, 2 * width / 3);
  for (const Loop& loop : p.frame.regions) solid.loops.emplace_back(loop, width);
  const auto stays = [&solid](Index label) {
    if (label != none && std::find(solid.labels.begin(), solid.labels.end(), label) == solid.labels.end())
      solid.labels.push_back(label);
  };
  for (const Scene& scene : scenes_of(p, r))
    for (const Traction& t : scene.tractions) stays(t.label);
  for (const Support& support : p.scene.supports) solid.held.push_back(support.label);
  std::vector<const Functional*> all{&p.objective};
  for (const FunctionalBound& b : r.bounds) all.push_back(&b.functional);
  for (const Functional* j : all)
    for (const Term& term : j->terms) {
      stays(term.label);
      if (term.edge_cracks) std::ranges::for_each(term.edge_cracks->labels, stays);
      if (term.measured) stays(term.measured->label);
      if (term.feature_radius > 0) {
        solid.discs.emplace_back(term.feature, term.feature_radius);
        notes.push_back(fmt::format("the ring of {} around ({:.4g}, {:.4g}) stays solid", term.kind, term.feature.x(),
                                    term.feature.y()));
      }
    }
  return solid;
}

// The outline runs counter-clockwise around the body, holes too: inside is -1 for them.
std::vector<Vec2> sharp_corners(const Shape& frame, std::span<const Index> loaded, std::span<const Index> held,
                                double chord) {
  std::vector<Vec2> corners;
  const auto free = [&](Index label) {
    return std::ranges::find(loaded, label) == loaded.end() && std::ranges::find(held, label) == held.end();
  };
  const auto look = [&](const Loop& loop, double inside) {
    const Polygon p = flatten(loop, chord, extent({.outline = loop}) / 20);
    const std::size_t n = p.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t before = (i + n - 1) % n;
      const Vec2 a = p.points[i] - p.points[before], b = p.points[(i + 1) % n] - p.points[i];
      if (inside * std::atan2(cross(a, b), a.dot(b)) < pi - reentrant_angle && free(p.label[before]) &&
          free(p.label[i]))
        corners.push_back(p.points[i]);
    }
  };
  look(frame.outline, 1);
  for (const Loop& hole : frame.holes) look(hole, -1);
  return corners;
}

}  // namespace kerf
