#pragma once
// The stress of a state, recovered once for all that an inspection asks of it.

#include "kerf/edge_cracks.hpp"
#include "solver/recover_stress.hpp"

namespace kerf::inspect {

struct RecoveredState {
  RecoveredState(const Model& model, const State& state);
  /// (s11, s22, s12) at a point of a triangle.
  Eigen::Vector3d at(const PointIn& point) const;

  const Model& model;
  const State& state;
  Corners corners;
  RecoveredStress stress;
  Locator locator;
};

}  // namespace kerf::inspect
