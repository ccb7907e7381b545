#include "kerf/derivative_bounds.hpp"

#include "solver/system.hpp"
#include "topo/formulas/kind.hpp"

#include <cmath>

namespace kerf {

namespace {

std::string unavailable(const Analysis& a, const Perturbation& p) {
  if (has_eigenstrain(a.model->scene)) return "no bounds: there is an eigenstrain";
  if (a.model->scene.body && removes_body(p))
    return "no bounds: a body force goes with the hole, and the displacement is not bounded";
  using Kind = Perturbation::Kind;
  if (p.kind != Kind::Hole && p.kind != Kind::Inclusion)
    return "no bounds: the topological derivative is bounded for circular holes and inclusions alone";
  if (a.adjoint || a.measured || a.work_share != 0 || a.energy_share == 0)
    return "no bounds: the topological derivative is bounded for the energy and the compliance alone";
  return {};
}

}  // namespace

Bounded derivative_bounds(const Analysis& a, const Perturbation& p, const Vec2& x, const StressBounds& s) {
  if (std::string why = unavailable(a, p); !why.empty()) return {nan, nan, nan, false, std::move(why)};
  const Index where = locate(a.model->mesh, {&x, 1}).front();
  if (where == none) return {nan, nan, nan, false, s.s11.note};
  const Material& m = material_of(a.model->mesh, a.model->scene, where);
  // Of circles, form(s, s) = A mean^2 + B (difference^2 + shear^2).
  Mat2 apart = Mat2::Zero();
  apart.diagonal() << 1, -1;
  const std::array factor{form(p, m, 0, Mat2::Identity(), Mat2::Identity()) / 4, form(p, m, 0, apart, apart),
                          form(p, m, 0, apart, apart)};
  const std::array<const Bounded*, 3> parts{&s.trace, &s.difference, &s.s12};
  Bounded t{.guaranteed = true};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Bounded& b = *parts[i];
    const Interval square = squared(b);
    const double share = -0.5 * a.energy_share * factor[i];
    t.lower += share * (share > 0 ? square.low : square.high);
    t.upper += share * (share > 0 ? square.high : square.low);
    t.guaranteed = t.guaranteed && b.guaranteed;
    if (t.note.empty()) t.note = b.note;
  }
  t.value = 0.5 * (t.lower + t.upper);
  return t;
}

}  // namespace kerf
