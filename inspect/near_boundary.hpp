#pragma once
// The stress of a state near places of its boundary, and K there for any length.

#include "inspect/boundary.hpp"
#include "inspect/corner.hpp"
#include "inspect/expansion.hpp"
#include "inspect/recovered.hpp"

namespace kerf::inspect {

class NearBoundary {
 public:
  /// `state` must outlive it.
  NearBoundary(const RecoveredState& state, double friction, bool pressurized);
  const std::vector<BoundaryPlace>& places() const {
    return places_;
  }
  const BoundaryPlace& nearest(const Vec2& x) const;
  /// At a given angle, or the worst one for that length.
  EdgeCrack at(const BoundaryPlace& place, double length, std::optional<double> angle) const;
  /// Of the loads on the boundary, 0 for a pull.
  double pressure_on(const BoundaryPlace& place) const;

 private:
  const RecoveredState& state_;
  const Model& model_;
  Mouths mouths_;
  bool pressurized_;
  std::vector<BoundaryPlace> places_;
  std::vector<ReentrantCorner> corners_;
  EdgeCrack at_corner(const ReentrantCorner& corner, double length) const;
  Vec2 load_on(const BoundaryPlace& place) const;  // traction
  std::optional<LocalStress> stress_near(const BoundaryPlace& place, double length) const;
};

}  // namespace kerf::inspect
