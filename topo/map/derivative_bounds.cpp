// Intervals of the topological derivative at points, from intervals of stresses [theory: B.27]. For circles
//   form(s, t) = A tr s tr t + B (d_s d_t + q_s q_t),   d half the difference, q the shear,
// a sum of products of scalars m of the state and n of the adjoint, and T = form(sigma, zeta - w/2 sigma) + local, w
// the share of the energy, is a sum over the three scalars of factor (m n - w/2 m^2). Over the rectangle of the
// intervals of m and n that is linear in n and quadratic in m: its extremes lie at the ends of n and at the ends of m
// or the vertex. The adjoint is a state of its own, under the loads that J weighs (topo/functional/linear.cpp), and a
// misfit has a third body; each gets bounds of its stresses at the points. Displacements have no bounds at a point:
// what needs them (a body force that goes with a hole, a density of the displacement) is refused. Derived in
// docs/theory/bounds.md; what is assumed is in docs/theory/guarantees.md.

#include "kerf/derivative_bounds.hpp"

#include "kerf/adaptive.hpp"
#include "solver/system.hpp"
#include "topo/analysis.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/functional/linear.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

/// A body under other loads, and the bounds of its stresses.
struct Other {
  Model model;
  State state;
  Indicator indicator;
  QuantityBounds bounds;
  Other(Model of, bool with_indicators)
      : model(std::move(of)),
        state(solve(model)),
        indicator(with_indicators ? error_indicator(model, state) : Indicator{}),
        bounds(model, state, with_indicators) {}
};

// What (B.27) does not cover: strains and forces that go with the hole, other shapes, an adjoint on a tangent cone.
std::string refused(const Scene& scene, const Perturbation& p, bool has_adjoint) {
  if (has_eigenstrain(scene)) return "no bounds: there is an eigenstrain";
  if (scene.body && removes_body(p))
    return "no bounds: a body force goes with the hole, and the displacement is not bounded";
  using Kind = Perturbation::Kind;
  if (p.kind != Kind::Hole && p.kind != Kind::Inclusion)
    return "no bounds: the topological derivative is bounded for circular holes and inclusions alone";
  const bool touches = has_contact(scene);
  if (has_adjoint && touches)
    return "no bounds: the adjoint is tied where the faces of a crack are closed, which only the exact solution knows";
  return {};
}

/// a m^2 + b m n over the intervals of m and n: linear in n, so that its extremes lie at the ends of n.
Interval range(double a, double b, const Interval& m, const Interval& n) {
  Interval r{infinity, -infinity};
  const auto add = [&](double at, double with) {
    const double value = at * (a * at + b * with);
    r = {std::min(r.low, value), std::max(r.high, value)};
  };
  for (const double end : {n.low, n.high}) {
    add(m.low, end);
    add(m.high, end);
    const double vertex = a != 0 ? -0.5 * b * end / a : infinity;
    if (m.low < vertex && vertex < m.high) add(vertex, end);
  }
  return r;
}

/// Trace, half the difference, shear.
constexpr int parts = 3;
std::array<const Bounded*, parts> parts_of(const StressBounds& s) {
  return {&s.trace, &s.difference, &s.s12};
}

/// Of circles, form(s, t) = A trace trace + B (difference difference + shear shear).
/// form(I, I) = A tr I tr I = 4 A; form of diag(1, -1) with itself is B times the square of half the difference, which
/// is 1.
std::array<double, parts> factors_of(const Perturbation& p, const Material& m) {
  Mat2 apart = Mat2::Zero();
  apart.diagonal() << 1, -1;
  const double B = form(p, m, 0, apart, apart);
  return {form(p, m, 0, Mat2::Identity(), Mat2::Identity()) / 4, B, B};
}

Bounded lost(std::string why) {
  return {nan, nan, nan, false, std::move(why)};
}

}  // namespace

// J as shares of energies and works, the bodies that these need beside the state's, and why there are no bounds.
struct DerivativeBounds::Impl {
  Functional j;
  Perturbation p;
  const Model& m;
  bool with_indicators;
  LinearParts of;
  std::string why;
  std::unique_ptr<const Other> dual, measured;

  // An error of the other body leaves no bounds for J; it does not end the run.
  void prepare_others() {
    why = of.why.empty() ? refused(m.scene, p, of.loads.has_value()) : of.why;
    if (!why.empty()) return;
    try {
      if (of.loads) dual = std::make_unique<const Other>(with_loads(m, *of.loads), with_indicators);
      if (of.measured)
        measured = std::make_unique<const Other>(
            prepare(m.mesh, m.element, measured_scene(m.scene, *of.measured), m.threads), with_indicators);
    } catch (const Error& error) {
      why = std::string("no bounds: ") + error.what();
    }
  }

  /// Minus what J takes from the place of a hole. Empty: the displacement there, which is not bounded.
  std::optional<double> local(const Vec2& x) const {
    double sum = 0;
    if (!removes_body(p)) return sum;
    for (const Term& term : j.terms) {
      if (!term.density) continue;
      const Density d = term.density({.x = x});
      if (term.uses_displacement && !d.by_displacement.isZero(0)) return std::nullopt;
      sum -= term.factor * d.value;
    }
    return sum;
  }

  /// The stresses of another body; its indicators go to their `eta`.
  static std::vector<StressBounds> stresses(const Other& other, const std::vector<Vec2>& x,
                                            std::vector<StressBounds>& own) {
    std::vector<StressBounds> all = other.bounds.all({.points = x}).points;
    for (std::size_t i = 0; i < x.size(); ++i) {
      std::vector<Eigen::VectorXd>& eta = own[i].eta;
      if (other.indicator.eta.size() > 0) eta.push_back(other.indicator.eta);
      eta.insert(eta.end(), all[i].eta.begin(), all[i].eta.end());
    }
    return all;
  }

  Bounded at(const Vec2& x, Index where, const StressBounds& s, const StressBounds* adjoint,
             const StressBounds* other) const {
    if (where == none) return lost(s.s11.note);
    const std::optional<double> here = local(x);
    if (!here) return lost("no bounds: the functional weighs the displacement in the hole, which is not bounded");
    Bounded t = interval(material_of(m.mesh, m.scene, where), s, adjoint, other);
    if (!std::isfinite(t.upper - t.lower)) return lost(t.note);
    t.lower += *here;
    t.upper += *here;
    t.value = 0.5 * (t.lower + t.upper);
    return t;
  }

  // The interval is guaranteed where all that it is made of is; the first note of the parts is kept.
  Bounded interval(const Material& material, const StressBounds& state, const StressBounds* adjoint,
                   const StressBounds* other) const {
    const std::array<double, parts> factor = factors_of(p, material);
    Bounded t{.guaranteed = true};
    const auto rely_on = [&](const Bounded& b) {
      t.guaranteed = t.guaranteed && b.guaranteed;
      if (t.note.empty()) t.note = b.note;
    };
    const auto add = [&](double share, const Interval& i) {
      // A negative factor turns the interval round.
      t.lower += share * (share > 0 ? i.low : i.high);
      t.upper += share * (share > 0 ? i.high : i.low);
    };
    for (int i = 0; i < parts; ++i) {
      // factor (share_z m n - share/2 m^2), m of the state, n of the adjoint.
      const Bounded& s = *parts_of(state)[i];
      rely_on(s);
      Interval with{0, 0};
      if (adjoint) {
        const Bounded& z = *parts_of(*adjoint)[i];
        rely_on(z);
        with = {z.lower, z.upper};
      }
      add(factor[i], range(-0.5 * of.energy_share, of.dual_share, {s.lower, s.upper}, with));
      if (!other) continue;
      rely_on(*parts_of(*other)[i]);
      add(-0.5 * of.measured_share * factor[i], squared(*parts_of(*other)[i]));
    }
    return t;
  }
};

DerivativeBounds::DerivativeBounds(const Functional& j, const Perturbation& p, const Model& m, bool with_indicators)
    : impl_(std::make_unique<Impl>(Impl{j, p, m, with_indicators, linear_parts(j, m), {}, {}, {}})) {
  impl_->prepare_others();
}
DerivativeBounds::~DerivativeBounds() = default;

Bounded DerivativeBounds::at(const Vec2& x, StressBounds& s) const {
  std::vector<StressBounds> own{std::move(s)};
  Bounded t = at(std::vector{x}, own).front();
  s = std::move(own.front());
  return t;
}

// All points at once: every body is asked a single time.
std::vector<Bounded> DerivativeBounds::at(const std::vector<Vec2>& x, std::vector<StressBounds>& s) const {
  const Impl& of = *impl_;
  if (!of.why.empty()) return std::vector<Bounded>(x.size(), lost(of.why));
  std::vector<StressBounds> adjoint, other;
  if (of.dual) adjoint = Impl::stresses(*of.dual, x, s);
  if (of.measured) other = Impl::stresses(*of.measured, x, s);
  const std::vector<Index> where = locate(of.m.mesh, x);
  std::vector<Bounded> all;
  for (std::size_t i = 0; i < x.size(); ++i)
    all.push_back(of.at(x[i], where[i], s[i], of.dual ? &adjoint[i] : nullptr, of.measured ? &other[i] : nullptr));
  return all;
}

}  // namespace kerf
