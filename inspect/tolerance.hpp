#pragma once
// Critical lengths and lives of cracks at places of the boundary.

#include "inspect/near_boundary.hpp"

namespace kerf::inspect {

/// Throws Error(Usage).
void check(const ToleranceRequest& request);

/// `crack`: that of `length` at the place, whose line it keeps.
Tolerance tolerate(const NearBoundary& near, const BoundaryPlace& place, const EdgeCrack& crack, double length,
                   const ToleranceRequest& request);

void set_safe_length(const std::vector<BoundaryPlace>& places, EdgeCrackMap& map);

}  // namespace kerf::inspect
