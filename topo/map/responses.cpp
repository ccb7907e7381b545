// Derivatives of many readings on the boundary: T_k = form(sigma, zeta_k) - b.p_k, one adjoint per reading with the
// factor of the state, one recovery for all fields [theory: I.1].

#include "topo/responses.hpp"
#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/map/fields.hpp"

#include <algorithm>
#include <iterator>

namespace kerf {

// Readings are affine in u, so that their derivative is that of any state.
Responses responses(const Model& m, const Field& s, std::span<const Term> readings) {
  if (has_frictional_cracks(m.scene))
    throw Error(Fault::Usage, "responses of readings need cracks without friction; remove friction and tresca");
  for (const Term& term : readings)
    if (!term.on_boundary || term.density || term.on_crack || term.measured || term.energy || term.work)
      throw Error(Fault::Usage, "readings are integrals of the displacement over a part of the boundary");
  require_supports({"readings", {readings.begin(), readings.end()}}, m);
  Responses r{.model = &m, .state = &s, .locator = make_locator(m.mesh), .corners = split_for_stress(m.mesh)};
  const std::vector<bool> singular = singular_corners(m, s, r.corners);
  r.value = read(m, s, readings);
  const auto slope = [&](std::size_t k) -> Eigen::VectorXd { return derivative(readings[k], m, s).skeleton; };
  TangentSolver solver(m, tied(contact_status(m, s)));
  for (TangentField& dual : solver.solve_all(readings.size(), slope)) r.dual.push_back(std::move(dual));
  std::vector<FieldToRecover> fields{{m, s, m.scene.body}};
  for (const Field& dual : r.dual) fields.push_back({m, dual});
  std::vector<RecoveredStress> recovered = recover_stresses(fields, r.corners, singular);
  r.stress = std::move(recovered.front());
  r.dual_stress.assign(std::make_move_iterator(recovered.begin() + 1), std::make_move_iterator(recovered.end()));
  return r;
}

Eigen::VectorXd read(const Model& m, const Field& s, std::span<const Term> readings) {
  Eigen::VectorXd value(static_cast<Eigen::Index>(readings.size()));
  for (std::size_t k = 0; k < readings.size(); ++k) value[static_cast<Eigen::Index>(k)] = integral(readings[k], m, s);
  return value;
}

// Stresses of the state and of every adjoint, and under a body force b . p_k, which a hole removes.
std::optional<PointResponse> response_at(const Responses& r, const Vec2& x) {
  const Model& m = *r.model;
  const Index t = locate(m.mesh, r.locator, x);
  if (t == none) return std::nullopt;
  PointResponse at{.material = material_of(m.mesh, m.scene, t),
                   .stress = symmetric(recovered_at(m, *r.state, r.corners, r.stress, {t, x}))};
  if (m.scene.body) at.removed.resize(static_cast<Eigen::Index>(r.dual.size()));
  for (std::size_t k = 0; k < r.dual.size(); ++k) {
    at.dual.push_back(symmetric(recovered_at(m, r.dual[k], r.corners, r.dual_stress[k], {t, x})));
    if (m.scene.body)
      at.removed[static_cast<Eigen::Index>(k)] = m.scene.body(x).dot(displacement_at(m, r.dual[k], t, x, true));
  }
  return at;
}

Eigen::VectorXd derivatives(const PointResponse& r, const Perturbation& p, double angle) {
  Eigen::VectorXd T(static_cast<Eigen::Index>(r.dual.size()));
  for (std::size_t k = 0; k < r.dual.size(); ++k)
    T[static_cast<Eigen::Index>(k)] = form(p, r.material, angle, r.stress, r.dual[k]);
  if (r.removed.size() > 0 && removes_body(p)) T -= r.removed;
  return T;
}

}  // namespace kerf
