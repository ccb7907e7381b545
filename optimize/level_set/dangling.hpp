#pragma once
// What of a level set's material only weighs.

#include "optimize/level_set/background.hpp"

namespace kerf {

/// Material that hangs on the rest by one thin neck and bears nothing (no label of `labels`, nothing that stays solid)
/// turned into void: it only weighs. Thin: no disc of radius `half_width` fits. phi about the signed distance.
void drop_dangling(const BackgroundMesh& b, std::span<const Index> labels, double half_width, Eigen::VectorXd& phi);

}  // namespace kerf
