#pragma once
// What small changes really do to J, for loops that want to know what came of a prediction.

#include "kerf/map.hpp"
#include "kerf/perturbation.hpp"
#include "kerf/scene.hpp"

#include <span>

namespace kerf {

/// Where a change is made, and how large.
struct SmallChange {
  Vec2 at;
  double radius;
};

/// One body under several scenes that differ in loads alone.
struct ChangingBody {
  const Meshing& meshing;
  const Element& element;
  std::span<const Scene> scenes;
  const Functional& j;
  int threads = 1;
};

struct ChangesMade {
  Eigen::MatrixXd difference;  // J changed - J, changes x scenes; NaN where no ball fits around a change
  int meshes = 0;              // each solved once per scene: one for six changes that keep apart
};

/// Every change made alone, contact free to move, by condensation onto a ball around it [theory: V.2]: one factor for
/// six changes that keep apart by about four radii. Throws Error(Usage) for what cannot be validated (an element with
/// unknowns at vertices, a small crack), Error(Geometry | Numerics) where the body cannot be meshed or
/// solved.
ChangesMade changes_at(const ChangingBody& body, const Perturbation& p, std::span<const SmallChange> changes);

}  // namespace kerf
