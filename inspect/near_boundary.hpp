#pragma once
// The stress of a state near places of its boundary, and K there for any length.

#include "inspect/boundary.hpp"
#include "inspect/expansion.hpp"
#include "kerf/edge_cracks.hpp"
#include "solver/recover_stress.hpp"

namespace kerf::inspect {

class NearBoundary {
 public:
  /// `model` and `state` must outlive it.
  NearBoundary(const Model& model, const State& state, double friction, bool pressurized);
  const std::vector<BoundaryPlace>& places() const {
    return places_;
  }
  const BoundaryPlace& nearest(const Vec2& x) const;
  /// At a given angle, or the worst one for that length.
  EdgeCrack at(const BoundaryPlace& place, double length, std::optional<double> angle) const;
  /// Of the loads on the boundary, 0 for a pull.
  double pressure_on(const BoundaryPlace& place) const;

 private:
  const Model& model_;
  const State& state_;
  Mouths mouths_;
  bool pressurized_;
  Corners corners_;
  RecoveredStress recovered_;
  Locator locator_;
  std::vector<BoundaryPlace> places_;
  Vec2 load_on(const BoundaryPlace& place) const;  // traction
  std::optional<LocalStress> stress_near(const BoundaryPlace& place, double length) const;
};

}  // namespace kerf::inspect
