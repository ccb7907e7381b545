#include "topo/map/fields.hpp"
#include "solver/system.hpp"
#include "topo/analysis.hpp"

#include "kerf/recover.hpp"

namespace kerf {

std::shared_ptr<const MapFields> recover_fields(const Analysis& a, Corners corners) {
  const Model& m = *a.model;
  auto f = std::make_shared<MapFields>();
  f->corners = corners.vertex.empty() ? split_for_stress(m.mesh) : std::move(corners);
  f->singular = singular_corners(m, *a.state, f->corners);
  const auto recover = [&](const Model& model, const Field& field, const VectorField& load) {
    f->recovered.push_back(recover_stress(model, field, f->corners, f->singular, load));
  };
  const auto absent = [&] { f->recovered.emplace_back(); };
  recover(m, *a.state, m.scene.body);
  a.adjoint ? recover(m, *a.adjoint, {}) : absent();
  a.measured ? recover(*a.measured_model, *a.measured, m.scene.body) : absent();
  if (a.biactive)
    for (const Field& y : a.biactive->response) recover(m, y, {});
  return f;
}

Vec2 displacement_at(const Model& m, const Field& s, Index t, const Vec2& x, bool recovered) {
  return recovered ? Vec2(recovered_displacement(m, s, t, x).col(0)) : Vec2(evaluate(m, s, t, x).displacement.col(0));
}

PointValues values_at(const Expansion& e, const MapFields& f, Index t, const Vec2& x) {
  PointValues v = point_values(
      e,
      [&](const FieldOf& of) {
        return recovered_at(of.model, of.field, f.corners, f.recovered[of.number], {t, x});
      },
      [&](const FieldOf& of, bool recovered) { return displacement_at(of.model, of.field, t, x, recovered); });
  v.x = x;
  v.material = material_of(e.a.model->mesh, e.a.model->scene, t);
  return v;
}

Oriented expand_at(const Expansion& e, const MapFields& f, Index t, const Vec2& x, std::vector<bool>& closed) {
  return expand(e, values_at(e, f, t, x), closed);
}

}  // namespace kerf
