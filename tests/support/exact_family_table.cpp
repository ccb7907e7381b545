// The exact fields of the tables by their names, with the parameters that the tables were made with.

#include "tests/support/exact_families.hpp"

#include <stdexcept>

namespace kerf::exact {

ExactField family_field(const std::string& id) {
  const Material m = plane_strain(1000, 0.3);
  const double degree = pi / 180;
  if (id.starts_with("c07")) return friction_table(id).field;
  if (id == "c06_two_cracks") return two_cracks(id, m, {});
  if (id == "c11_arc")
    return arc_crack(id, m, {.far_stress = Mat2::Identity(), .half_angle = 45 * degree, .middle = 90 * degree});
  if (id == "c11b_arc_shear")
    return arc_crack(
        id, m,
        {.far_stress = (Mat2() << 0.5, 0.1, 0.1, 1).finished(), .half_angle = 30 * degree, .middle = 90 * degree});
  const Mat2 pulled = (Mat2() << 1, 0.25, 0.25, -0.5).finished();
  if (id == "c08b_inglis")
    return inglis(id, m,
                  {.far_stress = (Mat2() << 0, 0, 0, 1).finished(), .semi_axes = {1, 0.25}, .angle = 30 * degree});
  if (id == "c09_lame") return annulus(id, m, {.stress = -Mat2::Identity(), .inner = 0.5, .outer = 1.5, .pressure = 2});
  if (id == "c09b_annulus_deviator") return annulus(id, m, {.stress = pulled, .inner = 0.5, .outer = 1.5});
  if (id == "c09c_inclusion")
    return inclusion(id, m, plane_strain(5000, 0.2), {.stress = pulled, .inner = 0.5, .outer = 1.5}).outside;
  if (id == "c09c_inclusion, inside")
    return inclusion(id, m, plane_strain(5000, 0.2), {.stress = pulled, .inner = 0.5, .outer = 1.5}).inside;
  if (id == "c13_L_modeI") return corner(id, m, {.opening = 270 * degree, .bisector = 45 * degree, .k1 = 1});
  if (id == "c13_L_modeII") return corner(id, m, {.opening = 270 * degree, .bisector = 45 * degree, .k2 = 1});
  if (id == "c13_slit") return corner(id, m, {.opening = 2 * pi, .k1 = 1, .k2 = 0.5, .t_stress = 0.3});
  throw std::invalid_argument("no exact field for table " + id);
}

}  // namespace kerf::exact
