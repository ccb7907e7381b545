// Recovered stresses of all fields of an expansion in one pass, and T at a point from them [theory: R.2, R.3, T.4].

#include "topo/map/fields.hpp"
#include "solver/system.hpp"
#include "topo/analysis.hpp"

#include "kerf/recover.hpp"

namespace kerf {

// State and measured body are recovered in equilibrium with the body force; adjoints and openings without one.
std::shared_ptr<const MapFields> recover_fields(const Analysis& a, Corners corners, const std::vector<bool>& wanted) {
  const Model& m = *a.model;
  auto f = std::make_shared<MapFields>();
  f->corners = corners.vertex.empty() ? split_for_stress(m.mesh) : std::move(corners);
  f->singular = singular_corners(m, *a.state, f->corners);
  std::vector<FieldToRecover> fields{{m, *a.state, m.scene.body}};
  if (a.adjoint) fields.push_back({m, *a.adjoint});
  if (a.measured) fields.push_back({*a.measured_model, *a.measured, m.scene.body});
  if (a.biactive)
    for (const Field& y : a.biactive->response) fields.push_back({m, y});
  std::vector<RecoveredStress> found = recover_stresses(fields, f->corners, f->singular, wanted);
  // `recovered` is indexed by FieldOf::number: an absent adjoint or misfit keeps its place, the openings follow.
  auto next = found.begin();
  const auto place = [&](bool there) {
    if (there)
      f->recovered.push_back(std::move(*next++));
    else
      f->recovered.emplace_back();
  };
  place(true);
  place(a.adjoint.has_value());
  place(a.measured != nullptr);
  while (next != found.end()) place(true);
  return f;
}

Vec2 displacement_at(const Model& m, const Field& s, Index t, const Vec2& x, bool recovered) {
  return recovered ? Vec2(recovered_displacement(m, s, t, x).col(0)) : Vec2(evaluate(m, s, t, x).displacement.col(0));
}

// Only what the expansion asks for is evaluated.
PointValues values_at(const Expansion& e, const MapFields& f, Index t, const Vec2& x) {
  PointValues v = point_values(
      e,
      [&](const FieldOf& of) {
        return recovered_at(of.model, of.field, f.corners, f.recovered[of.number], {t, x});
      },
      [&](const FieldOf& of, bool recovered) { return displacement_at(of.model, of.field, t, x, recovered); });
  set_place(e, t, x, v);
  return v;
}

Oriented expand_at(const Expansion& e, const MapFields& f, Index t, const Vec2& x, std::vector<bool>& closed) {
  return expand(e, values_at(e, f, t, x), closed);
}

}  // namespace kerf
