#pragma once
// The last part of a level-set run: its design as smooth curves, moved to an optimum of first order.

#include "optimize/curves.hpp"
#include "optimize/level_set/descent.hpp"

namespace kerf {

/// Evaluations of the curves in a checkpoint, bit for bit.
void write_curves(Checkpoint& c, const std::vector<CurvesRow>& rows);
std::vector<CurvesRow> read_curves(const Checkpoint& c);

/// Whether the design of a descent becomes curves: not with a weak phase, and not without iterations left.
bool can_finish(const Ground& g, const Descent& d);

/// A row of the history for an evaluation; `number` of the last row of the descent, `before` it.
Iteration iteration_of(const CurvesRow& row, int number, int solves_before, int cases);

/// Fits and optimizes. `see`: after every evaluation, with all of them so far; accepted ones with their design.
/// `known`: as finish_curves. Curves that fail come back without a shape, `why` says it.
FinishedCurves finish(const Ground& g, const Descent& d, const CurvesObserver& see,
                      const std::vector<CurvesRow>& known);

}  // namespace kerf
