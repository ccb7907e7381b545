#pragma once
// Tractions that no symmetric stress has at a corner.

#include "solver/system/skeleton.hpp"

namespace kerf {

struct CornerLoad {
  Vec2 at;
  double misfit = 0;  // stress: a.s b - b.s a of the given tractions s a, s b
};

/// For elements with traces that no triangle sees (has_unseen_traces): at a free vertex of the boundary whose edges lie
/// on two lines with normals a, b, any symmetric stress has a.s b = b.s a, and so must have the tractions. Where they
/// have not, `loads` (traction_loads) is changed as little as possible in the mean of squares of the tractions without
/// a change of force or moment on an edge, so that the element has a solution [theory: E.22]. Returns what was changed
/// by more than rounding.
std::vector<CornerLoad> fit_corner_loads(const Mesh& mesh, const Kernel& k, const Scene& scene, const Skeleton& s,
                                         Eigen::VectorXd& loads);

}  // namespace kerf
