#include "topo/map/fields.hpp"
#include "solver/system.hpp"

#include "kerf/recover.hpp"

namespace kerf {

std::shared_ptr<const MapFields> recover_fields(const Analysis& a, Corners corners) {
  const Model& m = *a.model;
  auto f = std::make_shared<MapFields>();
  f->corners = corners.vertex.empty() ? split_for_stress(m.mesh) : std::move(corners);
  f->singular = singular_corners(m, *a.state, f->corners);
  f->state = recover_stress(m, *a.state, f->corners, f->singular, m.scene.body);
  if (a.adjoint) f->dual = recover_stress(m, *a.adjoint, f->corners, f->singular);
  if (a.measured) f->measured = recover_stress(*a.measured_model, *a.measured, f->corners, f->singular, m.scene.body);
  if (a.biactive)
    for (const Field& y : a.biactive->response) f->openings.push_back(recover_stress(m, y, f->corners, f->singular));
  return f;
}

Vec2 displacement_at(const Model& m, const Field& s, Index t, const Vec2& x, bool recovered) {
  return recovered ? Vec2(recovered_displacement(m, s, t, x).col(0)) : Vec2(evaluate(m, s, t, x).displacement.col(0));
}

Oriented expand_at(const Analysis& a, const Functional& j, const Perturbation& p, const MapFields& f, const Needs& need,
                   Index t, const Vec2& x, std::vector<bool>& closed) {
  const Model& m = *a.model;
  PointValues v{.x = x,
                .material = material_of(m.mesh, m.scene, t),
                .stress = recovered_at(m, *a.state, f.corners, f.state, {t, x})};
  if (need.displacement) v.u = displacement_at(m, *a.state, t, x, true);
  if (a.adjoint) v.dual = recovered_at(m, *a.adjoint, f.corners, *f.dual, {t, x});
  if (need.dual_displacement) v.p = displacement_at(m, *a.adjoint, t, x, need.recover_dual);
  if (a.measured) {
    v.measured = recovered_at(*a.measured_model, *a.measured, f.corners, *f.measured, {t, x});
    if (need.displacement) v.measured_u = displacement_at(*a.measured_model, *a.measured, t, x, true);
  }
  if (a.biactive) {
    const Eigen::Index n = static_cast<Eigen::Index>(f.openings.size());
    v.openings.resize(3, n);
    v.opening_u = Points::Zero(2, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Field& y = a.biactive->response[static_cast<std::size_t>(k)];
      v.openings.col(k) = recovered_at(m, y, f.corners, f.openings[static_cast<std::size_t>(k)], {t, x});
      if (need.displacement) v.opening_u.col(k) = displacement_at(m, y, t, x, true);
    }
  }
  return expand(a, j, p, v, closed);
}

}  // namespace kerf
