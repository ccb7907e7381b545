#include "tests/exact_more.hpp"

#include <cmath>
#include <numbers>
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
  const double degree = std::numbers::pi / 180;
  const Mat2 pushed = (Mat2() << 0, 0, 0, -1).finished();
  const auto pressure = [&](double angle) { return -under(pushed, angle, 1).p0; };
  if (id == "c07_coulomb")
    return friction_crack(id, m, {.far_stress = pushed, .angle = 45 * degree, .limit = 0.3 * pressure(45 * degree)});
  if (id == "c07_tresca") return friction_crack(id, m, {.far_stress = pushed, .angle = 45 * degree, .limit = 0.2});
  if (id == "c07_stick")
    return friction_crack(id, m, {.far_stress = pushed, .angle = 15 * degree, .limit = 0.4 * pressure(15 * degree)});
  throw std::invalid_argument("no friction table " + id);
}

ExactField more_table_field(const std::string& id) {
  const Material m = plane_strain(1000, 0.3);
  const double degree = std::numbers::pi / 180;
  if (id.starts_with("c07")) return friction_table(id).field;
  if (id == "c06_two_cracks") return two_cracks(id, m, {});
  if (id == "c11_arc")
    return arc_crack(id, m, {.far_stress = Mat2::Identity(), .half_angle = 45 * degree, .middle = 90 * degree});
  if (id == "c11b_arc_shear")
    return arc_crack(
        id, m,
        {.far_stress = (Mat2() << 0.5, 0.1, 0.1, 1).finished(), .half_angle = 30 * degree, .middle = 90 * degree});
  if (id == "c13_L_modeI") return corner(id, m, {.opening = 270 * degree, .bisector = 45 * degree, .k1 = 1});
  if (id == "c13_L_modeII") return corner(id, m, {.opening = 270 * degree, .bisector = 45 * degree, .k2 = 1});
  if (id == "c13_slit") return corner(id, m, {.opening = 2 * std::numbers::pi, .k1 = 1, .k2 = 0.5, .t_stress = 0.3});
  throw std::invalid_argument("no exact field for table " + id);
}

}  // namespace kerf::exact
