#pragma once
// The files of a run, but for result.json and the page.

#include "app/bounds.hpp"
#include "app/map.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// What an earlier run left under the names of the interface: a stale map beside a new state would mislead. But for
/// what an optimization goes on from when it is resumed. Throws Error(Files).
void remove_earlier_results(const std::filesystem::path& folder, bool resume);

/// state.vtu, crack_<name>.csv and .vtp.
void write_state_files(const Journal& journal, const Adapted& adapted, const PlotData& data,
                       const std::vector<CrackResult>& cracks);

/// crack_<name>.csv and .vtp.
void write_crack_files(const Journal& journal, const std::vector<CrackResult>& cracks);

/// design.toml, design.svg and design.dxf: what an optimization of the case ended with.
void write_design_files(const Journal& journal, const Case& c, const OptimizeResult& r);

/// bounds.csv; bounds.vtp: the points with lower and upper of each quantity.
void write_bounds_files(const Journal& journal, const BoundsResult& bounds);

/// At the corners and at the centroids.
std::vector<NamedField> map_fields(const Mapped& map);

/// map.vtu; map.csv at the asked points, or at all corners.
void write_map_files(const Journal& journal, const MapTask& task, const Mapped& map, const Mesh& mesh,
                     const PlotData& data);

/// A probe_<name>.csv: the state at the points and, unless `analysis` is null, the map of the task. Where the probe
/// asks for bounds, those of the stresses, which are not there without a state that can be trusted.
void write_probe_file(const Journal& journal, const Probe& probe, const Adapted& adapted, const MapTask& task,
                      const Analysis* analysis, const std::vector<BoundedStress>& bounded);

}  // namespace kerf
