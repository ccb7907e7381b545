#pragma once
// What the page draws of a run, as arrays.

#include "app/run/map.hpp"
#include "io/arrays.hpp"
#include "plot/evolution.hpp"
#include "plot/picture.hpp"

namespace kerf {

/// The body: corners, triangles, outlines; displacement, stress, error indicator. The drawing has supports and loads.
void add_state(std::vector<NamedArray>& arrays, const Adapted& adapted, const PlotData& data, const Picture& drawing);

/// The map at the corners; nothing of a map at listed points.
void add_map(std::vector<NamedArray>& arrays, const MapTask& task, const Mapped& map, const Model& model,
             const PlotData& data);

/// What an inverse problem found: the lines of its picture.
void add_found(std::vector<NamedArray>& arrays, const Picture& found);

/// Outlines of a body that changes, "design" of an optimization or "growth" of cracks.
void add_shots(std::vector<NamedArray>& arrays, const std::string& of, const std::vector<Snapshot>& snapshots);

}  // namespace kerf
