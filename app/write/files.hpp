#pragma once
// The files of a run, but for result.json and the page.

#include "app/run/bounds.hpp"
#include "app/run/map.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// state.vtu, crack_<name>.csv and .vtp.
void write_state_files(const Journal& journal, const Adapted& adapted, const PlotData& data,
                       const std::vector<CrackResult>& cracks);

/// design.toml, design.svg and design.dxf: what an optimization of the case ended with.
void write_design_files(const Journal& journal, const Case& c, const OptimizeResult& r);

/// A grid with fields at its corners, curved edges as quadratic cells.
void write_fields(const Journal& journal, const std::string& name, const Mesh& mesh, const PlotData& data,
                  std::vector<NamedField> fields);

/// A text as a file of the run.
void write_text(const Journal& journal, const std::string& name, std::string text);

/// bounds.csv; bounds.vtp: the points with lower and upper of each quantity.
void write_bounds_files(const Journal& journal, const BoundsResult& bounds);

/// At the corners and at the centroids.
std::vector<NamedField> map_fields(const Mapped& map);

/// map.vtu; map.csv at the asked points, or at all corners.
void write_map_files(const Journal& journal, const MapTask& task, const Mapped& map, const Mesh& mesh,
                     const PlotData& data);

/// x, y and the state at a point, the place of a derivative behind them; NaN for what is not known: all of it outside
/// the body.
std::array<double, 8> probe_row(const Model& model, const State& state, Index triangle, const Vec2& x);
/// A probe_<name>.csv of these rows. Where the probe asks for bounds: those of the stresses, in the order of its
/// points.
void write_probe_file(const Journal& journal, const Probe& probe, std::vector<std::vector<double>> rows,
                      const std::vector<BoundedStress>& bounded);

}  // namespace kerf
