#pragma once
// The admissible fields of several duals and their products with those of a state, in one pass over the triangles
// [theory: B.30].

#include "solver/bounds/admissible.hpp"
#include "solver/bounds/modes.hpp"

#include <optional>

namespace kerf {

/// What batches need of a state, once: its admissible fields in modes.
struct LaneOwn {
  /// `cut_off`: for duals that are. The pair must outlive it.
  LaneOwn(const AdmissiblePair& u, bool cut_off);

  const AdmissiblePair& u;
  Averaging averages;
  References references;        // for a body force of degree trace + 1
  Modes low;                    // of triangles where the dual has no loads
  std::optional<Modes> ring;    // where it has
  Eigen::MatrixXd change;       // from low to ring
  Eigen::MatrixXd nodal_force;  // from modes to nodal values of a body force
  // Per triangle, modes of stress and strain, 4 columns each; in those of the ring, too, where the state has a body
  // force, with which its fields are not in the span of the others.
  Eigen::MatrixXd fields, ring_fields;
  Eigen::MatrixXd force, displacement;  // polynomials of degree trace + 1, x then y; force: may have no columns
};

/// Memory of batches, one after the other.
struct LaneRoom {
  LaneStates states;
  LaneConforming conforming;
  LaneArray tractions, size;
};

/// As cross_energy of `u` with each dual, whose solutions are room.states (made by solve_together of the model that `u`
/// is of, under these loads). No eigenstrain in `u`. Nothing where rounding has eaten digits, which a solve by itself
/// refines: of motions that are rigid but for their rounding, say.
std::vector<std::optional<CrossEnergy>> cross_energies(const LaneOwn& own, std::span<const LaneDual> duals,
                                                       const LaneRings& rings, LaneRoom& room);

}  // namespace kerf
