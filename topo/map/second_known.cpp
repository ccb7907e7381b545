// Where the second term c2 is known, why it is not, and what is known of the logarithm in the series. c2 is derived for
// a circle in one isotropic material without body force and eigenstrain, for energies and for J linear in the state
// [theory: Q.5, Q.8, Q.12]. With J linear, contact that ends on a crack moves J by the square of the change at its
// ends, as large as c2: refused. The logarithm eps^2 ln eps is absent, or known with coefficient c3 (a hole that
// removes a body force (Q.9), a density quadratic in the displacement (Q.10)), or unknown, in which case a series of
// radii fits it. Derived in docs/theory/second_order.md, sections "Other functionals, contact" and "Logarithms".

#include "topo/map/second_known.hpp"

#include "kerf/recover.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"
#include "topo/orthotropic.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

namespace {

// Some faces of a crack touch and others do not: their border moves with the load, and J that is no energy sees the
// square of that.
bool has_contact_end(const Model& m, const Field& s) {
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c) {
    if (!is_unilateral(m.scene.laws[c])) continue;
    const std::vector<CrackPoint> profile = crack_profile(m, s, static_cast<Index>(c));
    const auto closed = [](const CrackPoint& p) { return p.status == CrackPoint::Status::Closed; };
    if (std::ranges::any_of(profile, closed) && !std::ranges::all_of(profile, closed)) return true;
  }
  return false;
}

// A hundredth of the length of the cracks may be biactive: the ends of contact change nothing.
bool has_biactive(const Analysis& a) {
  double length = 0;
  for (std::size_t c = 0; c < a.model->mesh.cracks.size(); ++c)
    if (is_unilateral(a.model->scene.laws[c]))
      for (const CrackPoint& p : crack_profile(*a.model, *a.state, static_cast<Index>(c))) length += p.length;
  constexpr double few = 0.01;
  return a.biactive_length > few * length;
}

std::string unknown_in(const Model& m) {
  if (std::string why = cannot_reply(m); !why.empty()) return why;
  if (m.scene.body) return "the second term is not known under a body force";
  if (has_eigenstrain(m.scene)) return "the second term is not known with an eigenstrain";
  if (has_frictional_cracks(m.scene)) return "the second term is not known with friction";
  return {};
}

// Of one term in a body without body force and eigenstrain.
std::pair<Logarithm, double> logarithm_of(const Term& term, double slope, const Expansion& e, const PointValues& v,
                                          const TaylorField& s) {
  using enum Logarithm;
  if (!term.density) return {Absent, 0};
  if (term.uses_stress || term.uses_rotation) {
    const bool here = !term.somewhere || term.somewhere(v.x, 0);
    return here ? std::pair(Unknown, nan) : std::pair(Absent, 0.0);
  }
  if (!has_circle(e.p) || !isotropic(v.material)) return {Unknown, nan};
  // The second derivative by u, of densities that are quadratic in it.
  FieldPoint at{.x = v.x, .displacement = v.u, .material = v.material};
  // by_displacement is affine in u for such densities, so that differences give its matrix exactly. (Q.10) is for a
  // multiple k I of the identity; a weight that depends on the direction is not.
  const Vec2 before = term.density(at).by_displacement;
  const double step = v.u.norm() > 0 ? v.u.norm() : 1;
  Mat2 second;
  for (int i = 0; i < 2; ++i) {
    at.displacement = v.u + step * Vec2::Unit(i);
    second.col(i) = (term.density(at).by_displacement - before) / step;
  }
  const double mean = 0.5 * second.trace();
  constexpr double rounding = 1e-9;
  if ((second - mean * Mat2::Identity()).norm() > rounding * std::abs(mean)) return {Unknown, nan};
  return {mean == 0 ? Absent : Known, slope * mean * tracking_logarithm(e.p, v.material, s)};
}

}  // namespace

std::string_view word(Logarithm logarithm) {
  return logarithm == Logarithm::Absent ? "absent" : logarithm == Logarithm::Known ? "known" : "fitted";
}

std::string cannot_reply(const Model& m) {
  if (!can_clamp_holes(m.element)) return "the second term needs an element with an adjoint";
  if (has_orthotropic(m.scene)) return "the second term is not known in orthotropic bodies";
  if (std::ranges::any_of(m.mesh.region, [](Index r) { return r != none; }))
    return "the second term is not known in bodies of several materials";
  return {};
}

bool has_circle(const Perturbation& p) {
  return row(p).inside != nullptr;
}

// The shape first, then the body, contact and the functional: the first reason is told.
std::string unknown_second_term(const Analysis& a, const Functional& j, const Perturbation& p) {
  if (!has_circle(p)) return "the second term is known for circular free holes and inclusions only";
  if (std::string why = unknown_in(*a.model); !why.empty()) return why;
  if (has_biactive(a)) return "cracks with neither gap nor pressure respond one-sidedly";
  bool adjoint = false;
  for (const Term& term : j.terms) {
    if (is_energy(*a.model, term) || term.volume) continue;
    if (!term.linear || term.power != 1 || term.density)
      return fmt::format("the second term is known for energies and functionals linear in the state, not for \"{}\"",
                         term.kind);
    adjoint = true;
  }
  if (adjoint && has_contact_end(*a.model, *a.state))
    return "contact ends where a crack opens, and a functional other than an energy sees its ends move";
  return {};
}

// A term whose logarithm is unknown makes that of the sum unknown.
std::pair<Logarithm, double> logarithm(const Expansion& e, const PointValues& v, const TaylorField& s) {
  using enum Logarithm;
  const Analysis& a = e.a;
  if (!has_series(e.p) || has_eigenstrain(a.model->scene)) return {Unknown, nan};
  const auto plain = [&](const Term& term) { return is_energy(*a.model, term) || term.volume; };
  if (a.model->scene.body) {
    if (!removes_body(e.p) || !has_circle(e.p) || has_orthotropic(a.model->scene) ||
        !std::ranges::all_of(e.j.terms, plain))
      return {Unknown, nan};
    const double c3 = (a.energy_share + a.measured_share) * body_logarithm(v.material, a.model->scene.body(v.x));
    return {c3 == 0 ? Absent : Known, c3};
  }
  std::pair<Logarithm, double> sum{Absent, 0};
  for (std::size_t i = 0; i < e.j.terms.size(); ++i) {
    if (plain(e.j.terms[i])) continue;
    const auto [kind, c3] = logarithm_of(e.j.terms[i], a.slope[i], e, v, s);
    if (kind == Unknown) return {Unknown, nan};
    if (kind == Known) sum.first = Known;
    sum.second += c3;
  }
  return sum;
}

}  // namespace kerf
