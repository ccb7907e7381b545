#pragma once
// The files of a run, but for result.json and the page.

#include "app/collect.hpp"

namespace kerf {

/// What an earlier run left under the names of the interface: a stale map beside a new state would mislead. But for
/// what an optimization goes on from when it is resumed. Throws Error(Files).
void remove_earlier_results(const std::filesystem::path& folder, bool resume);

/// state.vtu, crack_<name>.csv and .vtp.
void write_state_files(const std::filesystem::path& folder, const Case& c, const Model& model, const State& state,
                       const Indicator& indicator, const PlotData& data, const std::vector<CrackResult>& cracks);

/// map.vtu; map.csv at the asked points, or at all corners.
void write_map_files(const std::filesystem::path& folder, const Case& c, const MapResult& result, const Mesh& mesh,
                     const PlotData& data, const FullMap& map);

/// probe_<name>.csv; without `analysis` the column of the map is empty.
void write_probe_files(const std::filesystem::path& folder, const Case& c, const Model& model, const State& state,
                       const Analysis* analysis);

}  // namespace kerf
