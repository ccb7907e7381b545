#pragma once
// The best values of a few numbers that draw holes, cracks and inclusions.

#include "optimize/history.hpp"
#include "optimize/problem.hpp"

namespace kerf {

/// Minimises J + penalty * area over the variables of request.design, under its constraints and conditions that keep
/// designs meshable, by request.method (minimise.hpp). In rounds, each on fresh meshes (trials.hpp), until a round
/// lowers J by less than the tolerance; request.max_iterations evaluations in all. The derivative is checked once at
/// the start: a note, and an Error(Numerics) when it is off by more than 1%. `place`: after every evaluation a
/// checkpoint is written; resumed, the run repeats from what was evaluated and ends with the same bits. Iterates of the
/// history that were there already are not shown to `see` again. Accepted iterates, shown to `see`: those better than
/// all before in their round (less violation, or feasible and lower), the first of every round, and at the end the best
/// one once more. Throws Error(Usage) for a design or a method that does not fit, Error(Geometry) or Error(Numerics)
/// when the start cannot be meshed or solved.
OptimizeResult optimise_parameters(const Problem& problem, const OptimizeRequest& request, const Observer& see,
                                   const CheckpointPlace& place);

}  // namespace kerf
