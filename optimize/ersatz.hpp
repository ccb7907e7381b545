#pragma once
// A weak phase in place of the void, on the background mesh itself: what other programs do, for comparison.

#include "optimize/level_set/background.hpp"
#include "optimize/loop/evaluate.hpp"

namespace kerf {

/// `share` times as stiff, the same Poisson's ratio.
Material weak_material(const Material& solid, double share);

/// Triangles in the void are region 0, the weak phase; those that the zero line cuts are of mixtures, their Young's
/// modulus by the share of their area, in mixed_phases steps: regions 1, 2, ... [Blauth, Sturm 2023]. The shape
/// is the frame, the area that where phi < 0. Throws Error(Usage) for frames with regions of their own.
inline constexpr Index mixed_phases = 16;
/// Share of the strong phase in a region of such a mesh.
double strong_share(Index region);
Evaluated evaluate_ersatz(const Problem& p, const OptimizeRequest& r, const BackgroundMesh& background,
                          const Eigen::VectorXd& phi);

}  // namespace kerf
