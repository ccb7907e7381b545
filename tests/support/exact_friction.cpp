// A closed crack that carries shear up to a limit: the shear above it acts as on a crack in mode II, the rest goes
// through the faces as a uniform stress.

#include "tests/support/exact_families.hpp"

#include <cmath>
#include <stdexcept>

namespace kerf::exact {

FrictionField friction_crack(std::string name, const Material& m, const FrictionCrack& crack) {
  // What the faces do not carry opens a mode II crack; the rest goes through them as if there were none.
  LineCrack line = under(crack.far_stress, crack.angle, crack.half);
  if (line.p0 >= 0) throw std::invalid_argument("friction_crack: the far stress opens the crack");
  const double slipping = std::copysign(std::max(std::abs(line.s_tn) - crack.limit, 0.0), line.s_tn);
  const double shear = line.s_tn - slipping;
  line.s_tn = slipping;
  ExactField field = line_crack(std::move(name), m, line);
  const Vec2 t(std::cos(crack.angle), std::sin(crack.angle)), n(-t.y(), t.x());
  const Mat2 carried = shear * (t * n.transpose() + n * t.transpose()), stretch = strain(m, carried);
  field.displacement = [u = field.displacement, stretch](const Vec2& x, int side) -> Vec2 {
    return u(x, side) + stretch * x;
  };
  field.stress = [s = field.stress, carried](const Vec2& x, int side) -> Mat2 { return s(x, side) + carried; };
  return {std::move(field), shear};
}

FrictionField friction_table(const std::string& id) {
  const Material m = plane_strain(1000, 0.3);
  const double degree = pi / 180;
  const Mat2 pushed = (Mat2() << 0, 0, 0, -1).finished();
  const auto pressure = [&](double angle) { return -under(pushed, angle, 1).p0; };
  if (id == "c07_coulomb")
    return friction_crack(id, m, {.far_stress = pushed, .angle = 45 * degree, .limit = 0.3 * pressure(45 * degree)});
  if (id == "c07_tresca") return friction_crack(id, m, {.far_stress = pushed, .angle = 45 * degree, .limit = 0.2});
  if (id == "c07_stick")
    return friction_crack(id, m, {.far_stress = pushed, .angle = 15 * degree, .limit = 0.4 * pressure(15 * degree)});
  throw std::invalid_argument("no friction table " + id);
}

}  // namespace kerf::exact
