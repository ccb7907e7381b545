#pragma once
// g(x) over candidate points, from the stress itself.

#include "solver/recover.hpp"
#include "topo/expansion.hpp"

namespace kerf {

/// The energy's topological derivative of a free hole at points; NaN outside the body.
std::vector<double> energy_map(const Model& model, const State& state, std::span<const Vec2> points);

/// The same everywhere: at the centroid of every triangle and at every corner (from the averaged stress).
struct FullMap {
  Eigen::VectorXd at_centroids, at_corners;
};
FullMap energy_map(const Model& model, const State& state, const Corners& corners, const CornerValues& values);

}  // namespace kerf
