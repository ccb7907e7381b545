// The density g of the shape derivative on free edges, dJ(theta) = int g theta.n [theory: S.4, S.5]:
//   g = j - s_tt j_s,tt - s_tt z_tt/E' + f.p,   energies s_tt^2/(2E') - f.u,   tt tangential, s state, z adjoint,
// at two Gauss points per edge from recovered stresses. It is an approximation (the discrete J has the distributed form
// of shape_gradient.cpp), better the smoother the stress; corners of less than pi and ends of supports have no
// integrable g. Level sets take their speed from it. Derived in docs/theory/shape_gradient.md, section "Boundary form".

#include "base/parallel.hpp"
#include "kerf/shape_gradient.hpp"
#include "solver/system.hpp"
#include "topo/analysis.hpp"
#include "topo/map/fields.hpp"
#include "topo/orthotropic.hpp"

#include <algorithm>

namespace kerf {

namespace {

// Nothing acts on the edge and nothing is measured there.
bool is_free(const Analysis& a, const Functional& j, Index e, const EdgeRule& rule) {
  const Model& m = *a.model;
  const Index label = m.mesh.label[e];
  if (label == none) return true;
  for (const Support& support : m.scene.supports)
    if (label == support.label) return false;
  for (const Term& term : j.terms)
    if ((term.on_boundary && label == term.label) || (term.measured && label == term.measured->label) ||
        (term.edge_cracks && std::ranges::find(term.edge_cracks->labels, label) != term.edge_cracks->labels.end()))
      return false;
  const Vec2& from = m.mesh.points[m.mesh.edges[e][0]];
  const Vec2 side = m.mesh.points[m.mesh.edges[e][1]] - from, n = outward_normal(m.mesh, e);
  // A traction that vanishes at the points is none.
  for (const Traction& traction : m.scene.tractions)
    for (Eigen::Index q = 0; label == traction.label && q < rule.s.size(); ++q)
      if (!traction.value(from + rule.s[q] * side, n).isZero(0)) return false;
  return true;
}

// What the analysis holds at a point of a free edge with tangent t.
class DensityOnEdge {
 public:
  /// `wanted`: the triangles that will be asked for.
  DensityOnEdge(const Analysis& a, const Functional& j, const std::vector<bool>& wanted)
      : a_(a), j_(j), fields_(a.fields ? a.fields : recover_fields(a, {}, wanted)) {
    need_dual_recovered_ = needs(a, j, {}).recover_dual;
    for (const Term& term : j.terms) uses_rotation_ = uses_rotation_ || term.uses_rotation;
  }

  // A free edge has the tangential stress alone: what recovery leaves of the others is error.
  double density(Index t, const Vec2& x, const Vec2& tangent) const {
    const Model& m = *a_.model;
    const Material& material = material_of(m.mesh, m.scene, t);
    const double modulus = plane_modulus(material);
    const auto along = [&](const Mat2& s) { return tangent.dot(s * tangent); };
    const auto recovered = [&](const Model& model, const Field& s, const RecoveredStress& r) {
      return along(symmetric(recovered_at(model, s, fields_->corners, r, {t, x})));
    };
    const Vec2 force = m.scene.body ? m.scene.body(x) : Vec2::Zero();
    const bool loaded = !force.isZero(0);
    const double s = recovered(m, *a_.state, fields_->recovered[FieldOf::Primal]);
    const Vec2 u = loaded ? displacement_at(m, *a_.state, t, x, true) : Vec2::Zero();
    // Energy density less work of the body force, by the shares that J has of energy and work.
    double sum = a_.energy_share * (0.5 * s * s / modulus - force.dot(u)) + a_.work_share * force.dot(u);
    if (a_.measured) {
      const double other = recovered(*a_.measured_model, *a_.measured, fields_->recovered[FieldOf::Measured]);
      const Vec2 moved = loaded ? displacement_at(*a_.measured_model, *a_.measured, t, x, true) : Vec2::Zero();
      sum += a_.measured_share * (0.5 * other * other / modulus - force.dot(moved));
    }
    if (a_.adjoint) {
      sum -= s * recovered(m, *a_.adjoint, fields_->recovered[FieldOf::Adjoint]) / modulus;
      if (loaded) sum += force.dot(displacement_at(m, *a_.adjoint, t, x, need_dual_recovered_));
    }
    FieldPoint at{.x = x, .stress = s * tangent * tangent.transpose(), .material = material};
    if (uses_rotation_) at.rotation = evaluate(m, *a_.state, t, x).rotation[0];
    for (std::size_t i = 0; i < j_.terms.size(); ++i) {
      const Term& term = j_.terms[i];
      if (!term.density) continue;
      if (term.uses_displacement) at.displacement = displacement_at(m, *a_.state, t, x, true);
      // eps(p) = A zeta + j_sigma: the adjoint's stress solves for a prestrain where J depends on the stress.
      const Density d = term.density(at);
      sum += a_.slope[i] * (d.value - s * along(d.by_stress));
    }
    return sum;
  }

 private:
  const Analysis& a_;
  const Functional& j_;
  std::shared_ptr<const MapFields> fields_;
  bool need_dual_recovered_ = true, uses_rotation_ = false;
};

}  // namespace

// Points first, so that recovery is done only in triangles beside free edges.
BoundaryGradient boundary_gradient(const Analysis& a, const Functional& j) {
  require_isotropic(a.model->scene, "shape derivatives");
  require_no_eigenstrain(a.model->scene);
  const Model& m = *a.model;
  require_supports(j, m);
  const EdgeRule rule = gauss(2);
  BoundaryGradient g;
  std::vector<Index> beside;  // per point its triangle
  std::vector<bool> wanted(m.mesh.triangles.size(), false);
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const auto& sides = m.mesh.sides[e];
    if ((sides[0] != none && sides[1] != none) || !is_free(a, j, e, rule)) continue;
    const Vec2& from = m.mesh.points[m.mesh.edges[e][0]];
    const Vec2 side = m.mesh.points[m.mesh.edges[e][1]] - from, n = outward_normal(m.mesh, e);
    const Index t = sides[0] == none ? sides[1] : sides[0];
    wanted[t] = true;
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      g.points.push_back({e, from + rule.s[q] * side, n, rule.w[q] * side.norm(), 0});
      beside.push_back(t);
    }
  }
  if (g.points.empty()) return g;
  const DensityOnEdge on_boundary(a, j, wanted);
  parallel_for(static_cast<Index>(g.points.size()), m.threads, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      BoundaryGradient::Point& p = g.points[static_cast<std::size_t>(i)];
      p.density = on_boundary.density(beside[static_cast<std::size_t>(i)], p.at, {-p.normal.y(), p.normal.x()});
    }
  });
  return g;
}

}  // namespace kerf
