#pragma once
// Several designs to begin with: cheap looks at all, longer ones at the better ones, one to go on with.

#include "optimize/task_pool.hpp"

namespace kerf {

/// The given design and others, evenly over the boxes, moved to where they can be drawn, those of four times as many
/// that the map of the objective promises most of: request.starts of them, fewer where the boxes have no room for more.
/// On meshes of 1.5 times the size each is minimized from for a few evaluations, the best third of them for some more;
/// the best of these is `in_full`: what it reached is where to go on from. A design counts before another when it
/// violates less (beyond 1e-3), then by its merit. problem.threads look at starts at the same time, or the processes of
/// the pool; the numbers do not depend on it. Throws Error(Geometry) when none can be evaluated.
std::vector<StartTried> try_starts(const Problem& problem, const OptimizeRequest& request, const Eigen::VectorXd& given,
                                   const TaskPool& pool);

/// "3 distinct ends of 24 starts, on the coarse mesh: 48.1 from 12, ...": none where no start has come to an end.
std::vector<std::string> ends_in_words(const std::vector<StartTried>& all);

}  // namespace kerf
