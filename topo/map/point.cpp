// The expansion at one point [theory: T.4, T.6, T.7, T.16, H.8], for every functional and every change with a series:
//   T = sum over products f form(s, t) - b.(p - (w - w_work) u - w_m u_m) + local + misfit + biactive rows,
// with the products -w/2 (sigma, sigma) of energies, (sigma, zeta) of the adjoint, -w_m/2 (sigma_m, sigma_m) of a
// misfit's measured body, w the shares of kerf/analysis.hpp, b the body force where the change removes it. A direction
// is chosen once, for the sum: in closed form where the densities of J do not see it, else by search [theory: T.14].
// Rows with neither gap nor pressure answer one-sidedly by forces lambda >= 0 that solve a small complementarity
// problem [theory: A.13], with the openings g of the change itself.

#include "topo/map/point.hpp"
#include "solver/system.hpp"
#include "topo/formulas/axes.hpp"
#include "topo/mutation.hpp"
#include "topo/orthotropic.hpp"
#include "topo/own_strain.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// What the change does to the density of J itself: (T.19) and (T.34) of the term, or minus the density in a hole.
double local(const Term& term, const Perturbation& p, const PointValues& v, const Mat2& s) {
  if (!term.density) return 0;
  const FieldPoint at{.x = v.x, .stress = s, .displacement = v.u, .material = v.material};
  if (term.local) return term.local(p, at);
  return removes_body(p) ? -mutant(FormulaPart::LocalDensity) * term.density(at).value : 0;
}

// The part of T that may depend on a direction.
Oriented forms_and_locals(const Expansion& e, const Perturbation& p, const PointValues& v,
                          std::span<const Product> products) {
  Oriented t = oriented(p, v.material, products);
  const Mat2 s = symmetric(v.stress);
  for (std::size_t i = 0; i < e.j.terms.size(); ++i) t.value += e.a.slope[i] * local(e.j.terms[i], p, v, s);
  return t;
}

// The least T over the directions of an ellipse, the largest in magnitude over those of a crack: in closed form where
// the densities of J do not see them.
Oriented best_direction(const Expansion& e, const PointValues& v, std::span<const Product> products) {
  const auto sees = [](const Term& term) { return static_cast<bool>(term.local); };
  if (!is_directed(e.p) || e.p.angle || std::ranges::none_of(e.j.terms, sees))
    return forms_and_locals(e, e.p, v, products);
  const bool crack = row(e.p).becomes == Becomes::Slit;
  Perturbation p = e.p;
  // A hole goes where T is least, a crack where it does most.
  const auto rank = [&](double angle) {
    p.angle = angle;
    const double T = forms_and_locals(e, p, v, products).value;
    return crack ? std::abs(T) : -T;
  };
  constexpr int samples = 36;
  p.angle = largest_over_angles(rank, samples);
  return forms_and_locals(e, p, v, products);
}

}  // namespace

Mat2 symmetric(const Eigen::Vector3d& s) {
  return (Mat2() << s[0], s[2], s[2], s[1]).finished();
}

Eigen::Vector3d components(const Eigen::Vector4d& s) {
  return {s[0], s[3], 0.5 * (s[1] + s[2])};
}

// Where J depends on the stress, zeta is not the stress of p [theory: A.5], so that no displacement is recovered from
// it.
Needs needs(const Analysis& a, const Functional& j, const Perturbation& p) {
  require_expansion(a.model->scene, j, p);
  Needs n;
  const bool loaded = removes_body(p) && a.model->scene.body;
  n.displacement = loaded;
  n.dual_displacement = loaded && a.adjoint;
  for (const Term& term : j.terms) {
    if (term.uses_displacement) n.displacement = true;
    if (term.uses_stress) n.recover_dual = false;
  }
  return n;
}

std::vector<bool> no_row_closed(const Analysis& a) {
  return std::vector<bool>(a.biactive ? a.biactive->response.size() : 0, false);
}

// For verdicts: T may be small by cancellation only.
double size_of(const Expansion& e, const PointValues& v) {
  const Analysis& a = e.a;
  if (!has_series(e.p)) return 0;
  // The largest value of the form on unit stresses, times the norms.
  double unit = 0;
  const Mat2 pressure = Mat2::Identity() / std::sqrt(2.0), shear = (Mat2() << 0, 1, 1, 0).finished() / std::sqrt(2.0);
  for (const Mat2& s : {pressure, shear})
    unit =
        std::max(unit, std::abs(row(e.p).becomes == Becomes::Material ? inclusion_form(v.material, e.p.inclusion, s, s)
                                                                      : hole_form(v.material, s, s)));
  const double own = v.misfit == 0 ? 0 : std::abs(v.misfit) * inside(e.p, v.material).hydrostatic * std::sqrt(2.0);
  const double stress = symmetric(v.stress).norm(), measured = a.measured ? symmetric(v.measured).norm() : 0;
  return unit * (0.5 * std::abs(a.energy_share) * stress * stress +
                 0.5 * std::abs(a.measured_share) * measured * measured +
                 (a.adjoint ? stress * symmetric(v.dual).norm() : 0)) +
         own * (std::abs(a.energy_share) * stress + std::abs(a.measured_share) * measured +
                (a.adjoint ? symmetric(v.dual).norm() : 0));
}

void set_place(const Expansion& e, Index t, const Vec2& x, PointValues& v) {
  const Model& m = *e.a.model;
  v.x = x;
  v.material = material_of(m.mesh, m.scene, t);
  v.misfit = row(e.p).becomes == Becomes::Material ? strain_beyond(m.mesh, m.scene, e.p.inclusion, t, x) : 0;
}

namespace {

// What the strain `misfit` I of an inclusion does by itself to J, [theory: H.8]: its work on the stress inside.
double of_misfit(const Expansion& e, const PointValues& v) {
  if (v.misfit == 0) return 0;
  const Analysis& a = e.a;
  const double work = a.energy_share * symmetric(v.stress).trace() - (a.adjoint ? symmetric(v.dual).trace() : 0) +
                      a.measured_share * symmetric(v.measured).trace(),
               stored = 2 * v.material.mu / (1 + 4 * v.material.mu * e.p.inclusion.c);
  return mutant(FormulaPart::InclusionMisfit) * v.misfit *
         (stored * (a.energy_share + a.measured_share) * v.misfit - inside(e.p, v.material).hydrostatic * work);
}

}  // namespace

Oriented expand(const Expansion& e, const PointValues& v, std::vector<bool>& closed) {
  const Analysis& a = e.a;
  const Perturbation& p = e.p;
  const Mat2 s = symmetric(v.stress);
  std::array<Product, 3> products;
  std::size_t count = 0;
  if (a.energy_share != 0 || !a.adjoint)
    products[count++] = {-0.5 * mutant(FormulaPart::Energy) * a.energy_share, s, s};
  if (a.adjoint) products[count++] = {mutant(FormulaPart::Dual), s, symmetric(v.dual)};
  if (a.measured)
    products[count++] = {-0.5 * mutant(FormulaPart::Measured) * a.measured_share, symmetric(v.measured),
                         symmetric(v.measured)};
  Oriented t = best_direction(e, v, std::span(products.data(), count));
  t.value += of_misfit(e, v);
  const bool loaded = removes_body(p) && a.model->scene.body;
  Vec2 body = Vec2::Zero();
  if (loaded) {
    body = mutant(FormulaPart::BodyForce) * a.model->scene.body(v.x);
    t.value += body.dot((a.energy_share - a.work_share) * v.u - v.p + a.measured_share * v.measured_u);
  }
  if (a.biactive) {
    const Eigen::Index n = v.openings.cols();
    // g of (T.16): the opening of biactive row i by the change, with sigma(Y_i) and Y_i as its adjoint.
    Eigen::VectorXd g(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      g[i] = form(p, v.material, t.angle, s, symmetric(v.openings.col(i)));
      if (loaded) g[i] -= body.dot(v.opening_u.col(i));
      if (v.misfit != 0) g[i] += v.misfit * inside(p, v.material).hydrostatic * symmetric(v.openings.col(i)).trace();
    }
    // lambda >= 0, g + S lambda >= 0, lambda (g + S lambda) = 0.
    const Unilateral push = solve_unilateral(a.biactive->opening, -g, closed);
    closed = push.closed;
    t.value += push.jump.dot(a.biactive->slope);
  }
  return t;
}

}  // namespace kerf
