// Poisson's ratio to 1/2, bodies enclosed by their supports, regions of another stiffness. All have the linear stress
// field of fields.cpp, whatever the material: with a region of another modulus an eigenstrain in the softer material
// makes up for what it would strain beyond the stiffer one, e = (1 + nu)(1/E_stiff - 1/E_soft) times the strain's form,
// so that the field stays as it is. Enclosed bodies know their mean pressure as change of area over 1 - 2 nu, and at nu
// = 1/2 but for its mean. The limits are rounding units times the condition of what is factored.

#include "bench/hard/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
const std::vector<Vec2> inside{{0.15, 0.2}, {0.5, 0.45}, {0.8, 0.3}, {0.55, 0.55}, {0.3, 0.8}, {0.9, 0.9}};

Eigen::Vector3d exact_stress_in_bar(const Vec2& x) {
  return linear_stress({}, x);
}

std::string held_and_loaded(double poisson) {
  return boundary("held", "displacement = " + linear_displacement({}, 1, poisson)) +
         boundary("loaded", "traction = " + linear_traction({}));
}

HardCase poisson_case(double nu) {
  return {outline(square, {"held", "loaded", "loaded", "held"}) + material(1, nu) + linear_frame({}) +
          held_and_loaded(nu) + probe(inside) + mesh_and_output(0.15)};
}

// The knob is 1/2 - nu.
HardCase enclosed_case(double from_half) {
  const double nu = 0.5 - from_half;
  return {outline(square, {"held", "held", "held", "held"}) + material(1, nu) + linear_frame({}) +
          boundary("held", "displacement = " + linear_displacement({}, 1, nu)) + probe(inside) + mesh_and_output(0.15)};
}

// At nu = 1/2 the pressure is known but for its mean over the body.
double enclosed_error(const Compared& c) {
  if (c.knob > 0) return stress_error(c.seen, exact_stress_in_bar);
  const Eigen::Vector3d mean(1, 1, 0);  // of (s11 + s22)/2 over the square
  return stress_error(c.seen, [&](const Vec2& x) -> Eigen::Vector3d { return exact_stress_in_bar(x) - mean; });
}

// The linear field in a body with a region of modulus `ratio`. The stiffer material strains as it must; in the softer
// one an eigenstrain makes up for what it would strain beyond that, so that the field stays what it is. (In the stiffer
// one an eigenstrain would be known to rounding only, and the stiffness would multiply that.) All is turned by 1, so
// that a stiff region strains far less than it moves.
HardCase contrast_case(double ratio, double nu) {
  const double stiff = std::max(ratio, 1.0), soft = std::min(ratio, 1.0);
  const double factor = (1 + nu) * (1 / stiff - 1 / soft);
  const auto normal = [&](double slope, double value) {
    return fmt::format("\"{} * ({} * x + {})\"", decimal(factor), decimal(slope - 2 * nu), decimal(value - nu));
  };
  const std::string strain =
      fmt::format("eigenstrain = [{}, {}, \"{} * (-0.5*y)\"]\n", normal(0.5, 0.25), normal(1.5, 0.75), decimal(factor));
  return {outline(square, {"held", "loaded", "loaded", "held"}) + material(1, nu) + (ratio > 1 ? strain : "") +
          fmt::format("[[region]]\nname = \"r\"\npolygon = [[0.3, 0.25], [0.7, 0.3], [0.65, 0.7], [0.35, 0.6]]\n"
                      "young = {}\npoisson = {}\n",
                      decimal(ratio), decimal(nu)) +
          (ratio > 1 ? "" : strain) + linear_frame({}) +
          boundary("held", "displacement = " + linear_displacement({}, stiff, nu, 1)) +
          boundary("loaded", "traction = " + linear_traction({})) + probe(inside) + mesh_and_output(0.15)};
}

HardFamily contrast(std::string name, std::string title, double nu) {
  return {.name = std::move(name),
          .title = std::move(title),
          .knob = "modulus of the region over that of the body",
          .truth = "closed form: a linear stress field that an eigenstrain in the region keeps as it is",
          .limit =
              "4 digits above 1e-13: rounding unit times the condition of K without the contrast, about 1e3, and the "
              "penalty's 1e3 where there is one; a contrast scales blocks of K, which a factor does not mind",
          .values = {1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1, 1e2, 1e4, 1e6, 1e8, 1e10},
          .quick = {1e-10, 1e10},
          .benign = 1,
          .make = [nu](double ratio) { return contrast_case(ratio, nu); },
          .error = [](const Compared& c) { return stress_error(c.seen, exact_stress_in_bar); },
          .digits = [](double) { return 4.0; }};
}

// The saddle point that is not condensed, with digits that its rounding leaves.
HardFamily contrast_saddle() {
  HardFamily f = contrast("contrast-saddle", "Young's contrast, nu = 1/2, backend umfpack", 0.5);
  f.make = [](double ratio) {
    HardCase c = contrast_case(ratio, 0.5);
    c.text += "[solver]\nbackend = \"umfpack\"\n";
    return c;
  };
  f.values = {1e-10, 1e-6, 1e-3, 1, 1e3, 1e6, 1e10};
  f.quick = {1e-3, 1e6};
  f.limit =
      "4 digits above 1e-13, and beyond a contrast of 1e4 those of the contrast: all unknowns are scaled by one "
      "modulus, and nothing is refined";
  f.digits = [](double ratio) { return 4 + std::max(0.0, std::abs(std::log10(ratio)) - 4); };
  f.record = [](double ratio) { return ratio > 1e8 ? HardVerdict::Refused : HardVerdict::Held; };
  f.why =
      "the stress of a stiff region is known to rounding times the contrast, as a difference of displacements that are "
      "far larger; the default backend refines it";
  return f;
}

HardFamily contrast_half() {
  HardFamily f = contrast("contrast-half", "Young's contrast, nu = 1/2", 0.5);
  f.limit +=
      ". The level of pressure in a soft region that a stiff body encloses follows from its change of volume: the "
      "penalty (a mu = 1e-3) leaves it known to rounding times 1e-3/ratio";
  f.digits = [](double ratio) { return std::max(4.0, std::log10(1e-3 / ratio) - 1); };
  return f;
}

std::string poisson_label(double nu) {
  const double from_half = 0.5 - nu;
  return from_half > 0 && from_half < 1e-5 ? fmt::format("1/2-{:.0e}", from_half) : fmt::format("{:.6g}", nu);
}

}  // namespace

std::vector<HardFamily> material_families() {
  return {
      {.name = "poisson",
       .title = "Poisson's ratio to 1/2, and below 0",
       .knob = "Poisson's ratio",
       .truth = "closed form: a linear stress field, displacements on two sides, tractions on two",
       .limit = "4 digits above 1e-13: the penalty keeps the condition of K below 1e3 times that at 0.3, towards -1 "
                "the strain energy of a change of shape is larger than that of a change of size by 1/(1 + nu)",
       .values = {-0.99, -0.9, -0.3, 0, 0.3, 0.49, 0.4999, 0.5 - 1e-6, 0.5 - 1e-9, 0.5 - 1e-12, 0.5},
       .quick = {-0.9, 0.4999, 0.5 - 1e-9, 0.5},
       .benign = 0.3,
       .make = poisson_case,
       .error = [](const Compared& c) { return stress_error(c.seen, exact_stress_in_bar); },
       .digits = [](double) { return 4.0; },
       .label = poisson_label},
      {.name = "enclosed",
       .title = "Nearly incompressible and wholly enclosed",
       .knob = "1/2 - nu, displacements prescribed all around",
       .truth = "closed form: a linear stress field; at 1/2 but for the mean pressure, which is then 0",
       .limit = "the mean pressure is the change of area over 1 - 2 nu, and the change of area is known to rounding: "
                "ten rounding units over 1 - 2 nu, and 3 digits above 1e-13",
       .values = {0.2, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0},
       .quick = {1e-2, 1e-8, 0},
       .benign = 0.2,
       .make = enclosed_case,
       .error = enclosed_error,
       .digits = [](double from_half) { return from_half > 0 ? std::max(3.0, std::log10(5.5e-3 / from_half)) : 3; }},
      contrast("contrast", "Young's contrast, nu = 0.3", 0.3),
      contrast_half(),
      contrast_saddle()};
}

}  // namespace kerf
