#pragma once
// The stress at the points of a mesh where a largest one is looked for.

#include "kerf/max_stress.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// A stress and where it is.
struct StressAt {
  double value = 0;
  Vec2 at = Vec2::Zero();
};

/// Outside of the zones, triangle by triangle, at the points of the quadrature of densities; then in the middles of the
/// boundary's edges, on their arcs. The element's own stress. Of own triangles (solver/system.hpp).
std::vector<StressAt> stresses_outside(const LargestStress& what, const Model& model, const Field& state);

/// In the middles of the boundary's edges outside of the zones, on their arcs.
struct EdgeStress : StressAt {
  Index edge = none;
};
std::vector<EdgeStress> boundary_stresses(const LargestStress& what, const Model& model, const Field& state);

/// The largest of them; 0 where there are none.
StressAt largest_stress(const LargestStress& what, const Model& model, const Field& state);

/// The norm of the stress over a box alone, low <= x < high, as a term of its own.
Term norm_in_box(const LargestStress& what, const Vec2& low, const Vec2& high);

}  // namespace kerf
