// J as energies plus the work of loads, for bounds [theory: B.27]: what J weighs a displacement or an opening with
// becomes the loads of a second scene, whose solution is the adjoint.

#include "topo/functional/linear.hpp"

#include "solver/at_rest.hpp"
#include "topo/analysis.hpp"

#include <fmt/core.h>

namespace kerf {

namespace {

BoundaryField times(double factor, const BoundaryField& f) {
  if (factor == 1) return f;  // with what is known of it
  return [factor, f](const Vec2& x, const Vec2& n) -> Vec2 { return factor * f(x, n); };
}

BoundaryField plus(const BoundaryField& a, const BoundaryField& b) {
  if (!a) return b;
  return [a, b](const Vec2& x, const Vec2& n) -> Vec2 { return a(x, n) + b(x, n); };
}

/// The loads of the scene itself.
void add_work(double factor, const Scene& of, Scene& loads) {
  loads.body = sum(loads.body, factor == 1 ? of.body : scaled(factor, of.body));
  for (const Traction& t : of.tractions) loads.tractions.push_back({t.label, times(factor, t.value)});
  for (std::size_t c = 0; c < of.laws.size(); ++c)
    if (has_pressure(of.laws[c]))
      loads.laws[c].pressure = plus(loads.laws[c].pressure, times(factor, of.laws[c].pressure));
}

/// What a term weighs the displacement, its trace or the opening of a crack with.
void add_weights(double factor, const Term& term, Scene& loads) {
  if (term.uses_displacement)
    loads.body = sum(loads.body, [factor, density = term.density](const Vec2& x) -> Vec2 {
      return factor * density({.x = x}).by_displacement;
    });
  if (term.on_boundary)
    loads.tractions.push_back({term.label, [factor, on = term.on_boundary](const Vec2& x, const Vec2& n) -> Vec2 {
                                 return factor * on(x, n, Vec2::Zero()).by_displacement;
                               }});
  if (!term.on_crack) return;
  CrackLaw& law = loads.laws[static_cast<std::size_t>(term.crack)];
  if (law.kind == CrackLaw::Kind::Bonded) return;
  law.pressure = plus(law.pressure, [factor, on = term.on_crack](const Vec2& x, const Vec2&) -> Vec2 {
    return {factor * on({.x = x}).by_jump_n, 0};
  });
}

// Energies, works and misfits are known; of the rest, first powers of what is linear in displacement and opening.
std::string unknown(const Term& term) {
  if (term.energy || term.work || term.measured) return {};
  if (term.power != 1) return fmt::format("no bounds: \"{}\" is the power of an integral", term.kind);
  if (!term.linear || term.uses_stress || term.uses_rotation || term.local)
    return fmt::format(
        "no bounds: the topological derivative is bounded for energies, the compliance, misfits and what is linear in "
        "the displacement, which \"{}\" is not",
        term.kind);
  return {};
}

}  // namespace

// `dual_share` is the factor of the first such term, so that its loads are taken as they are, with what is known of
// them for enclosures; the others are multiples of it.
LinearParts linear_parts(const Functional& j, const Model& m) {
  LinearParts parts;
  const bool self_adjoint = has_self_adjoint_work(m);
  for (const Term& term : j.terms) {
    parts.why = unknown(term);
    if (!parts.why.empty()) return parts;
    if (term.energy) {
      parts.energy_share += term.factor;
    } else if (term.work && self_adjoint) {
      parts.energy_share -= 2 * term.factor;
    } else if (term.measured) {
      parts.measured = term.measured;
      parts.measured_share += term.factor;
      parts.energy_share -= term.factor;
    } else if (term.work || term.uses_displacement || term.on_boundary || term.on_crack) {
      if (term.factor == 0) continue;
      if (!parts.loads) {
        parts.loads = at_rest(m);
        parts.dual_share = term.factor;
      }
      const double share = term.factor / parts.dual_share;
      if (term.work)
        add_work(share, m.scene, *parts.loads);
      else
        add_weights(share, term, *parts.loads);
    }
  }
  return parts;
}

}  // namespace kerf
