#pragma once
// The recovered stresses of everything that an expansion is made of.

#include "solver/recover_stress.hpp"
#include "topo/map/point.hpp"

namespace kerf {

struct GreenOfBody;  // topo/map/green_of_body.hpp

struct MapFields {
  Corners corners;                                // of split_for_stress
  std::vector<bool> singular;                     // per corner
  std::vector<RecoveredStress> recovered;         // per FieldOf::number; empty where there is no such field
  std::shared_ptr<const GreenOfBody> green = {};  // of a part of a body: for clamped holes
};

/// Of all fields at a point x of triangle t.
PointValues values_at(const Expansion& e, const MapFields& f, Index t, const Vec2& x);

/// T there; `closed` as in expand.
Oriented expand_at(const Expansion& e, const MapFields& f, Index t, const Vec2& x, std::vector<bool>& closed);

/// u* of recover.hpp, or the element's own.
Vec2 displacement_at(const Model& m, const Field& s, Index t, const Vec2& x, bool recovered);

}  // namespace kerf
