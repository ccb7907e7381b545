#pragma once
// How far the loads are from what the material bears.

#include "app/run/findings.hpp"

namespace kerf {

/// Against yield per material that has one, against fracture per tip with K in a material that has a toughness; the
/// least factor first. `found` has the largest stress, and the cracks with their tips.
std::vector<ReserveResult> reserves_of(const Case& c, const SolvedPart& solved, const PlotData& data,
                                       const SingularZones& zones, const Findings& found);

}  // namespace kerf
