// c2 at a point [theory: Q.1, Q.5, Q.8, Q.12]: J(eps) - J = pi eps^2 (T + c2 eps^2 + O(eps^4)).
//   c2 = sum over products f Q(s, t), the same products as for T, Q the form of topo/formulas/second_term.cpp.
// State and adjoint are fitted by Kolosov's potentials on a disc of 0.7 times the distance to the next feature
// (topo/map/taylor.cpp). The circle sends out the dipoles of the state; the body's reply is solved for with the factor
// of the state and fitted on the same disc, where its a1, b1 are alpha, beta of (Q.4). `answer_radius` says from where
// on the series begins: where the reply to a part of the stress is as large as that part [theory: V.11]. Derived in
// docs/theory/second_order.md.

#include "kerf/second_order.hpp"

#include "solver/system.hpp"
#include "topo/analysis.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/mask.hpp"
#include "topo/map/reply.hpp"
#include "topo/map/second_known.hpp"
#include "topo/map/taylor.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

// share = |c2| r^2/|T| solved for r: up to there the second term is at most that share of the first.
double SecondOrder::valid_radius(double share) const {
  if (!available || T == 0) return available ? 0 : nan;
  return c2 == 0 ? infinity : std::sqrt(share * std::abs(T / c2));
}

// What points share: the expansion, the locator, and a solver per body.
struct SecondOrders::Impl {
  Impl(const Analysis& analysis, const Functional& functional, const Perturbation& change)
      : a(analysis),
        j(functional),
        p(change),
        e(a, j, p),
        unknown(unknown_second_term(a, j, p)),
        locator(make_locator(a.model->mesh)) {}

  // Solvers cost something where there is contact: made when first asked for.
  BodyReply& reply() {
    if (!own) own.emplace(*a.model, tangent_cone(*a.model, *a.state));
    return *own;
  }
  BodyReply& measured_reply() {
    if (!other) other.emplace(*a.measured_model, tangent_cone(*a.measured_model, *a.measured));
    return *other;
  }

  const std::string& why_unknown() const {
    return unknown;
  }

  SecondOrder at(const Vec2& x) {
    SecondOrder result{.at = x, .note = unknown};
    const Place place(*this, x, result.note);
    if (place.fit) expand_here(*place.fit, x, place.t, result);
    return result;
  }

  double size() const {
    Vec2 low = a.model->mesh.points[0], high = low;
    for (const Vec2& v : a.model->mesh.points) low = low.cwiseMin(v), high = high.cwiseMax(v);
    return (high - low).norm();
  }

  // Of 300 vertices the one farthest from all features.
  Vec2 roomiest() const {
    const Model& m = *a.model;
    constexpr std::size_t enough = 300;
    const std::size_t stride = std::max<std::size_t>(1, m.mesh.points.size() / enough);
    std::vector<Vec2> some;
    for (std::size_t i = 0; i < m.mesh.points.size(); i += stride) some.push_back(m.mesh.points[i]);
    const std::vector<double> clear = margins(m, j, some, {0, 0, size()});
    return some[static_cast<std::size_t>(std::ranges::max_element(clear) - clear.begin())];
  }

  double answer_radius(const Vec2& x) {
    if (!cannot_reply(*a.model).empty()) return nan;
    try {
      return answered(x);
    } catch (const Error&) {  // no reply: nothing is known
      return nan;
    }
  }

 private:
  // What can be fitted around a point, or why nothing.
  struct Place {
    Place(const Impl& of, const Vec2& x, std::string& note) : t(locate(of.a.model->mesh, of.locator, x)) {
      if (t == none) {
        note = "the point lies outside the body";
        return;
      }
      const Model& m = *of.a.model;
      const double size = of.size(), clear = margins(m, of.j, std::span(&x, 1), {0, 0, size}).front();
      // Of the disc around the point that no feature enters; of the body.
      constexpr double part = 0.7, rounding = 1e-12;
      if (!(clear > rounding * size)) {
        note = "the point lies on a boundary, a crack or in the ring of the functional";
        return;
      }
      fit.emplace(m, x, t, part * clear);
      if (!fit->coarse()) return;
      note = fmt::format("the mesh is too coarse for its distance {:.3g} to the nearest feature", clear);
      fit.reset();
    }
    Index t;
    std::optional<TaylorFit> fit;
  };

  // The reply grows with the square of the radius: it is as large as its part of the stress at sqrt(|s| / |w|).
  double answered(const Vec2& x) {
    const Model& m = *a.model;
    std::string note;
    const Place place(*this, x, note);
    if (!place.fit) return nan;
    const TaylorField s = place.fit->of(*a.state);
    // Mean stress and deviator, each by its own answer: in an incompressible body that of the first alone is large.
    constexpr double counts = 0.05;
    double least = infinity;
    for (const TaylorField& part : {TaylorField{.a1 = s.a1}, TaylorField{.b1 = s.b1}}) {
      const double size = part.stress().norm();
      if (!(size > counts * s.stress().norm())) continue;
      const TaylorField w = replied(reply(), has_circle(p) ? p : Perturbation{}, *place.fit, part,
                                    material_of(m.mesh, m.scene, place.t), x);
      least = std::min(least, std::sqrt(size / w.stress().norm()));
    }
    return least;
  }

  // Stresses from the fit as well, so that T and c2 are of one field.
  void expand_here(const TaylorFit& fit, const Vec2& x, Index t, SecondOrder& result) {
    const Material& material = material_of(a.model->mesh, a.model->scene, t);
    PointValues v = point_values(
        e,
        [&](const FieldOf& of) -> Eigen::Vector3d {
          const Mat2 s = fit.of(of.field).stress();
          return {s(0, 0), s(1, 1), s(0, 1)};
        },
        [&](const FieldOf& of, bool recovered) { return displacement_at(of.model, of.field, t, x, recovered); });
    set_place(e, t, x, v);
    const TaylorField s = has_circle(p) ? fit.of(*a.state) : TaylorField{};
    std::tie(result.logarithm, result.c3) = logarithm(e, v, s);
    if (!unknown.empty()) return;
    std::vector<bool> closed = no_row_closed(a);
    result.T = expand(e, v, closed).value;
    SecondForm sum;
    if (a.energy_share != 0 || a.adjoint) {
      const TaylorField w = replied(reply(), p, fit, s, material, x);
      if (a.energy_share != 0) sum = sum + (-0.5 * a.energy_share) * second_form(p, material, s, s, w);
      if (a.adjoint) sum = sum + second_form(p, material, s, fit.of(*a.adjoint), w);
    }
    if (a.measured) {
      const TaylorField other_s = fit.of(*a.measured), w = replied(measured_reply(), p, fit, other_s, material, x);
      sum = sum + (-0.5 * a.measured_share) * second_form(p, material, other_s, other_s, w);
    }
    result.mean_gradient = sum.mean_gradient;
    result.deviator_gradient = sum.deviator_gradient;
    result.curvature = sum.curvature;
    result.reply = sum.reply;
    result.c2 = sum.value();
    result.available = true;
  }

  // One sent field, and its reply on the triangles of the fit only.
  static TaylorField replied(BodyReply& body, const Perturbation& change, const TaylorFit& fit, const TaylorField& s,
                             const Material& material, const Vec2& x) {
    const Nucleus sent = dipole_field(material, x, dipoles(change, material, s));
    const TangentField w = body.to(x, std::span(&sent, 1), fit.triangles()).front();
    constexpr double solved = 1e-6;
    if (!(w.residual < solved))
      throw Error(Fault::Numerics, "the second term: the reply of the body could not be solved for");
    return fit.of(w);
  }

  const Analysis& a;
  const Functional& j;
  const Perturbation p;
  const Expansion e;
  const std::string unknown;
  const Locator locator;
  std::optional<BodyReply> own, other;
};

SecondOrders::SecondOrders(const Analysis& a, const Functional& j, const Perturbation& p)
    : impl_(std::make_unique<Impl>(a, j, p)) {}
SecondOrders::~SecondOrders() = default;

SecondOrder SecondOrders::at(const Vec2& x) {
  return impl_->at(x);
}

double SecondOrders::answer_radius(const Vec2& x) {
  return impl_->answer_radius(x);
}

Vec2 SecondOrders::roomiest() const {
  return impl_->roomiest();
}

const std::string& SecondOrders::unknown() const {
  return impl_->why_unknown();
}

SecondOrder second_order(const Analysis& a, const Functional& j, const Perturbation& p, const Vec2& x) {
  return SecondOrders(a, j, p).at(x);
}

}  // namespace kerf
