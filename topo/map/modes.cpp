// T as the sum of its parts at a point: mean stress, deviator, what both give together, eigenstrain, displacement,
// density. An error of a part is seen in proportion to its share (docs/theory/validation.md, section "The verdict").

#include "topo/map/modes.hpp"

namespace kerf {

namespace {

using Stress = Eigen::Vector3d;

// The same point with every stress mapped, and with displacements or without.
// The misfit of an inclusion is a part of its own and left out here.
template <class Map>
PointValues mapped(PointValues v, bool moved, const Map& map) {
  v.misfit = 0;
  for (Stress* s : {&v.stress, &v.dual, &v.measured}) *s = map(*s);
  for (Eigen::Index k = 0; k < v.openings.cols(); ++k) v.openings.col(k) = map(Stress(v.openings.col(k)));
  if (moved) return v;
  v.u = v.p = v.measured_u = Vec2::Zero();
  v.opening_u.setZero();
  return v;
}

Stress same(const Stress& s) {
  return s;
}
Stress mean(const Stress& s) {
  return {0.5 * (s[0] + s[1]), 0.5 * (s[0] + s[1]), 0};
}
Stress deviator(const Stress& s) {
  return s - mean(s);
}

}  // namespace

// The form is quadratic in the stresses of state and adjoint together: parts of the stress are expanded alone, what
// they give together is the rest. A direction is that of the whole.
std::vector<Mode> modes_of(const Expansion& e, const PointValues& v, const Oriented& whole) {
  if (!has_series(e.p)) return {};
  Perturbation fixed = e.p;
  if (is_directed(fixed)) fixed.angle = whole.angle;
  const Functional nothing;  // no change of a density
  const Expansion form(e.a, nothing, fixed);
  const auto value = [&](const PointValues& at) {
    std::vector<bool> closed = no_row_closed(e.a);
    return expand(form, at, closed).value;
  };
  const double stresses = value(mapped(v, false, same)), moved = value(mapped(v, true, same));
  std::vector<Mode> modes;
  if (e.a.energy_share == 0 && e.a.measured_share == 0 && !e.a.adjoint) {
    // J sees no stress but by its density.
  } else if (row(fixed).becomes == Becomes::Slit) {
    // Pressed together, a crack has its tangential part left, which no mean stress changes.
    // The stresses of states are pressed, not that of the adjoint: they decide whether the crack is open, at any angle.
    const double pressure = 1e3 * (v.stress.norm() + v.measured.norm());
    const auto press = [&](const Stress& s) { return Stress(s - pressure * Stress(1, 1, 0)); };
    PointValues pressed = mapped(v, false, same);
    pressed.stress = press(v.stress);
    pressed.measured = press(v.measured);
    const double tangential = value(pressed);
    modes = {{"normal", stresses - tangential}, {"tangential", tangential}};
  } else {
    const double trace = value(mapped(v, false, mean)), shear = value(mapped(v, false, deviator));
    modes = {{"trace", trace}, {"deviator", shear}};
    if (is_directed(fixed) || !isotropic(v.material)) modes.push_back({"mixed", stresses - trace - shear});
  }
  double own = 0;
  if (v.misfit != 0) {
    std::vector<bool> closed = no_row_closed(e.a);
    own = expand(form, v, closed).value - moved;
    modes.push_back({"eigenstrain", own});
  }
  if (removes_body(e.p) && e.a.model->scene.body) modes.push_back({"displacement", moved - stresses});
  for (const Term& term : e.j.terms)
    if (term.density && (term.local || removes_body(e.p))) {
      modes.push_back({"local", whole.value - moved - own});
      break;
    }
  return modes;
}

}  // namespace kerf
