#pragma once
// How far the loads are from what the material bears.

#include "app/run/peaks.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// Against yield per material that has one, against fracture per tip with K in a material that has a toughness; the
/// least factor first. `state` has its largest stress, `cracks` their tips.
std::vector<ReserveResult> reserves_of(const Case& c, const Model& model, const PlotData& data,
                                       const SingularZones& zones, const StateResult& state,
                                       const std::vector<CrackResult>& cracks);

}  // namespace kerf
