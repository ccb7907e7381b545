#pragma once
// Singular corners of a part of a body.

#include "solver/recover_stress.hpp"

namespace kerf {

/// As singular_corners (solver/recover_stress.hpp); `stress`: the mean stress (solver/recovery.hpp) of the whole body.
std::vector<bool> singular_corners(const Model& part, const Field& state, const Corners& corners, double stress);

}  // namespace kerf
