// dJ/dE of a region at fixed Poisson's ratio: A = A_1/E, so that dJ/dE = d_E j - 1/E (A s, z) and +1/(2E) (A s, s) per
// energy [theory: S.6].

#include "topo/young_gradient.hpp"
#include "solver/system.hpp"

#include "topo/analysis.hpp"
#include "topo/functional/integrate.hpp"

namespace kerf {

namespace {

/// (A sigma, zeta) over a region.
double work(const Model& m, const Field& s, const Field& z, Index region) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    if (region_of(m.mesh, t) != region) continue;
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(m.inner->kernel.rule, shape);
    const Fields a = evaluate(m, s, t, x), b = evaluate(m, z, t, x);
    for (Eigen::Index q = 0; q < x.cols(); ++q)
      sum +=
          area(shape) * m.inner->kernel.rule.w[q] *
          strain(material_of(m.mesh, m.scene, t), tensor(a.stress.col(q))).cwiseProduct(tensor(b.stress.col(q))).sum();
  }
  return sum;
}

}  // namespace

// Where the density itself depends on the material, by central differences of its integral at fixed fields.
double young_gradient(const Analysis& a, const Functional& j, Model& model, Index region, double young) {
  require_straight(model, "a derivative by Young's modulus");
  require_supports(j, model);
  std::vector<bool> use(model.mesh.triangles.size());
  for (std::size_t t = 0; t < use.size(); ++t) use[t] = region_of(model.mesh, static_cast<Index>(t)) == region;
  double sum = a.energy_share / (2 * young) * work(model, *a.state, *a.state, region);
  if (a.measured) sum += a.measured_share / (2 * young) * work(*a.measured_model, *a.measured, *a.measured, region);
  if (a.adjoint) sum -= work(model, *a.state, *a.adjoint, region) / young;
  const Material before = model.scene.regions[static_cast<std::size_t>(region)];
  constexpr double step = 1e-5;
  for (std::size_t i = 0; i < j.terms.size(); ++i) {
    const Term& term = j.terms[i];
    if (!term.density || !(term.uses_stress || term.uses_displacement || term.uses_rotation)) continue;
    double change = 0;
    for (const double sign : {1.0, -1.0}) {
      model.scene.regions[static_cast<std::size_t>(region)] = stiffened(before, 1 + sign * step);
      change += sign * integral_over(term, model, *a.state, use);
    }
    model.scene.regions[static_cast<std::size_t>(region)] = before;
    sum += a.slope[i] * change / (2 * step * young);
  }
  return sum;
}

}  // namespace kerf
