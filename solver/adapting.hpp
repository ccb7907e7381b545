#pragma once
// The rounds of an adaptive solution (kerf/adaptive.hpp), for those who solve them in parts.

#include "base/sums.hpp"
#include "kerf/adaptive.hpp"

namespace kerf {

/// Adds to the indicator what the stress of the polygon lacks near the chords of curved sides [theory: R.10], over own
/// triangles. `divisions`: how often the mesh was divided (Adaptation): its edges are parts of chords then.
void add_chords(const Shape& shape, int divisions, const Model& model, const State& state, Indicator& indicator,
                const Sums& sums = {});

/// What the data have that no estimate on this mesh can have seen, the first of it in words; empty for nothing.
std::string unseen_by_estimate(const Model& model);

/// Why the last of these rounds is the last one, as Adapted::stopped has it; empty: it is not. `unseen`: as above, or
/// why the goal is not to be relied on yet.
std::string reason_to_end(const std::vector<Round>& rounds, const std::string& unseen, const Adaptation& wanted);

/// Leaves out the matrix and the factor, most of the memory of a model: its states can still be written down, drawn and
/// read at points, and nothing can be solved with it any more.
void drop_factor(Model& m);

/// The mesh of the next round. `indicator`: of the goal, on `mesh`, which is not divided yet; `order`: of the element.
Mesh next_mesh(const Shape& shape, const Sizing& sizing, const Adaptation& wanted, const Mesh& mesh, double order,
               const Indicator& indicator);

}  // namespace kerf
