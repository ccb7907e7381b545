#pragma once
// The pictures of `kerf bench`.

#include "bench/measure/map.hpp"
#include "bench/measure/state.hpp"
#include "bench/optimize/optimize.hpp"

namespace kerf {

/// error_time_<case>_nu<poisson>.png per problem; where there is contact, too, the stress error against the mesh step
/// and both errors against the number of unknowns; peers_<case>_nu<poisson>.png where other programs ran.
void draw_state_plots(const std::filesystem::path& folder, const StateBench& bench);
/// map_error_time_<case>_nu<poisson>.png per problem with an exact map, other programs dashed.
void draw_map_plots(const std::filesystem::path& folder, const MapBench& bench);
/// optimize_<case>.png: compliance against time; optimize_compliance.png: the last ones; optimize_designs.png.
void draw_optimize_plots(const std::filesystem::path& folder, const OptimizeBench& bench);

}  // namespace kerf
