#pragma once
// The worst crack on the boundary, in a run: the map, its files and its picture, and cracks that are drawn.

#include "app/run/solve.hpp"

namespace kerf {

EdgeCrackResult inspect_edges(const Case& c, const inspect::RecoveredState& state, Journal& journal);

/// The lengths of [validate] at its points, else at the three worst places; adds to the result.
void draw_edge_cracks(const Case& c, const inspect::RecoveredState& state, const Sizing& sizing, const Adaptation& how,
                      Journal& journal, EdgeCrackResult& result);

}  // namespace kerf
