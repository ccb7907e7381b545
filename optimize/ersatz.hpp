#pragma once
// A weak phase in place of the void, on the canvas itself: what other programs do, for comparison. Internal to this
// room.

#include "optimize/evaluate.hpp"
#include "optimize/front.hpp"

namespace kerf {

/// `share` times as stiff, the same Poisson's ratio.
Material weak_material(const Material& solid, double share);

/// Triangles with phi >= 0 at their centroid are region 0, the weak phase. The shape is the frame, the area that of the
/// strong phase. Throws Error(Usage) for frames with regions of their own.
Evaluated evaluate_ersatz(const Problem& p, const OptimizeRequest& r, const Canvas& canvas, const Eigen::VectorXd& phi);

}  // namespace kerf
