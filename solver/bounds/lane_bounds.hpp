#pragma once
// The admissible fields of several duals and their products with those of a state, in one pass over the triangles
// [theory: B.30].

#include "solver/bounds/admissible.hpp"

#include <optional>

namespace kerf {

/// Memory of batches, one after the other.
struct LaneRoom {
  LaneStates states;
  LaneConforming conforming;
  LaneArray tractions, size;
};

/// As cross_energy of `u` with each dual, whose solutions are room.states (made by solve_together of the model that `u`
/// is of, under these loads). Without body force and eigenstrain on either side. Nothing where
/// rounding has eaten digits, which a solve by itself refines: of motions that are rigid but for their rounding, say.
std::vector<std::optional<CrossEnergy>> cross_energies(const AdmissiblePair& u, const Averaging& by,
                                                       std::span<const Model* const> duals, LaneRoom& room);

}  // namespace kerf
