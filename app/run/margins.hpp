#pragma once
// Margins of the largest stress, the largest displacement and of what stands at the tips of cracks: how far the element
// of one degree more on the same mesh is from what is printed [theory: R.11].

#include "app/run/findings.hpp"
#include "app/run/journal.hpp"

namespace kerf {

/// Looks for the largest von Mises stress inside triangles and on their edges, by the recovered stress: the corners
/// alone would miss it where it lies between them. All processes call it together with the largest value of all.
/// `own`: of corners, whether they are those of own triangles.
void refine_peak(const SolvedPart& solved, const PlotData& data, bool plane_strain, const SingularZones& zones,
                 const std::vector<bool>& own, Peak& von_mises);

/// Whether a body of so many triangles gets margins, as far as the case says.
bool wants_margins(const Case& c, double triangles);

/// Solves once more, by the better element on the mesh of the state, and sets all margins of `state` and `cracks`.
/// Nothing where that is not asked for, there is no such element, the loads have a history, or the mesh is so large
/// that it takes long: output.margins.
void add_margins(const Case& c, const Adapted& adapted, const PlotData& data, StateResult& state,
                 std::vector<CrackResult>& cracks);

}  // namespace kerf
