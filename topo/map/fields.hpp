#pragma once
// The recovered stresses of everything that an expansion is made of.

#include "solver/recover_stress.hpp"
#include "topo/map/point.hpp"

namespace kerf {

struct MapFields {
  Corners corners;             // of split_for_stress
  std::vector<bool> singular;  // per corner
  RecoveredStress state;
  std::optional<RecoveredStress> dual, measured;
  std::vector<RecoveredStress> openings;
};

/// T at a point of triangle t; `closed` as in expand.
Oriented expand_at(const Analysis& a, const Functional& j, const Perturbation& p, const MapFields& f, const Needs& need,
                   Index t, const Vec2& x, std::vector<bool>& closed);

/// u* of recover.hpp, or the element's own.
Vec2 displacement_at(const Model& m, const Field& s, Index t, const Vec2& x, bool recovered);

}  // namespace kerf
