// Friction that grows until the faces stick, and faces that touch without pressing.

#include "bench/hard/cracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double shear = 0.3;  // over the pressure

HardCase friction_case(double coefficient) {
  return {outline({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, {"outer", "outer", "outer", "outer"}) +
          crack("c", {{-1, 0}, {1, 0}}, fmt::format("friction = {}\n", decimal(coefficient))) + material(1, 0.3) +
          boundary("outer", fmt::format("traction = [\"{0} * ny\", \"{0} * nx - ny\"]", shear)) +
          probe({{0, 1}, {1.5, 0.2}, {-1, -0.7}}) + mesh_and_output(0.3)};
}

// By the symmetry of the plate sliding does not change the pressure on the crack, 1: the faces slide under what the
// shear has beyond friction. So K_II is linear in the coefficient, and 0 from where they stick.
double friction_error(const Compared& c) {
  const auto slides = [](double coefficient) { return std::max(0.0, shear - coefficient); };
  const auto &tips = c.seen.result.cracks[0].tips, &benign = c.benign.result.cracks[0].tips;
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < tips.size(); ++k) {
    if (!tips[k].K_II || !benign[k].K_II) return infinity;
    const double free = *benign[k].K_II / slides(0.1) * shear;  // without friction
    worst = std::max(worst, std::abs(*tips[k].K_II - free * slides(c.knob) / shear));
    largest = std::max(largest, std::abs(free));
  }
  return largest > 0 ? worst / largest : infinity;
}

HardFamily friction() {
  return {.name = "friction",
          .title = "Friction of a pressed crack",
          .knob = "Coulomb's coefficient; the faces stick from 0.3 on",
          .truth = "the benign run scaled: K_II is linear in the coefficient by symmetry, and 0 where the faces stick",
          .limit = "1 digit above 1e-3, the error of this mesh: the pressure beside the tips is that of a mesh",
          .values = {0, 1e-3, 0.01, 0.1, 0.2, 0.29, 0.3, 0.31, 1, 10, 100},
          .quick = {0, 0.29, 100},
          .benign = 0.1,
          .make = friction_case,
          .error = friction_error,
          .digits = [](double) { return 1.0; },
          .floor = 1e-3};
}

double biactive_error(const Compared& c) {
  const double stress = stress_error(c.seen, [](const Vec2& x) { return touching_stress({}, x); });
  const double length = c.seen.result.contact->biactive_length;
  return std::max(stress, std::abs(length - 4 * c.knob) / 4);
}

HardFamily biactive() {
  return {.name = "biactive",
          .title = "Faces that touch without pressing",
          .knob = "share of such faces",
          .truth = "closed form: the stress is linear and no crack disturbs it; the share itself",
          .limit = "3 digits above 1e-13: rounding unit times the condition of K",
          .values = {0, 0.25, 0.5, 0.75, 1},
          .quick = {0, 0.5, 1},
          .benign = 0,
          .make = [](double share) { return touching(share); },
          .error = biactive_error,
          .digits = [](double) { return 3.0; }};
}

}  // namespace

std::vector<HardFamily> contact_families() {
  return {friction(), biactive()};
}

}  // namespace kerf
