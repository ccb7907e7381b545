#pragma once
// Balancing domain decomposition by constraints, for the system that several processes share [theory: E.35, E.36].

#include "solver/divided_body.hpp"

namespace kerf {

/// Of the sum of the parts that all processes have, who all call it with theirs. The inside of a part is eliminated
/// exactly, conjugate gradients run on what parts share. `precision`: in which the
/// factor of the inside is kept. Throws LostDefiniteness, and std::bad_alloc.
std::unique_ptr<SharedSolver> bddc(PartMatrix part, Communicator& comm, int threads,
                                   Precision precision = Precision::Double);

}  // namespace kerf
