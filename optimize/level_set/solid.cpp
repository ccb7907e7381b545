// What of a design stays solid: frozen loops, other materials, strips along loads and measurements, rings of
// functionals.

#include "optimize/level_set/solid.hpp"

#include "optimize/loop/evaluate.hpp"

#include <fmt/core.h>

#include <algorithm>

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

}  // namespace kerf
