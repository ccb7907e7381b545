// Slender bodies, supports that barely hold, ends of loads and cracks beside nodes of the mesh. Closed forms: a
// cantilever under a shear force at its end, with the exact displacement where it is held; a wedge of rollers under
// pressure, u in proportion to the distance from the apex at 1/tan(angle); a bent ligament 2a between two half-plane
// cracks,
//   stress C x / sqrt(a^2 - x^2), K = +-2 M / (sqrt(pi) a^1.5).
// Short supports have their forces by statics. Loads and cracks that end beside a node are compared with those that end
// at it: the result must not depend on a distance of rounding by more than that distance. Each limit says why so many
// digits may be lost.

#include "bench/hard/cracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double young = 1, nu = 0.3;
const double plane_young = young / (1 - nu * nu), plane_nu = nu / (1 - nu);

// A cantilever of height 1 under a shear force 1 at its end, with the exact displacement where
// it is held: the stress is quadratic, which degree 2 has exactly.
HardCase cantilever(double length) {
  const std::string l = decimal(length), k = decimal(2 / plane_young), n = decimal(plane_nu);
  const std::string u = fmt::format("{} * y * ((6*{} - 3*x)*x + (2 + {})*(y*y - 0.25))", k, l, n),
                    v = fmt::format("-{} * (3*{}*y*y*({} - x) + (4 + 5*{})*x/4 + (3*{} - x)*x*x)", k, n, l, n, l);
  return {outline({{0, -0.5}, {length, -0.5}, {length, 0.5}, {0, 0.5}}, {"free", "end", "free", "held"}) +
          material(young, nu) + boundary("held", fmt::format("displacement = [\"{}\", \"{}\"]", u, v)) +
          boundary("end", "traction = [0, \"-6*(0.25 - y*y)\"]") +
          probe({{length, 0}, {0.3, 0.4}, {0.5 * length, -0.4}}) + mesh_and_output(1) + "[solver]\ndegree = 2\n"};
}

double cantilever_error(const Compared& c) {
  const double length = c.knob, k = 2 / plane_young;
  const double stress = stress_error(c.seen, [&](const Vec2& x) {
    return Eigen::Vector3d(12 * (length - x.x()) * x.y(), 0, -6 * (0.25 - x.y() * x.y()));
  });
  const double deflection = -k * ((4 + 5 * plane_nu) * length / 4 + 2 * length * length * length);
  return std::max(stress, std::abs(c.seen.probe[0].displacement.y() / deflection - 1));
}

HardFamily slenderness() {
  return {.name = "slenderness",
          .title = "Slender cantilever",
          .knob = "length over height",
          .truth = "closed form: stress and deflection of a cantilever under a force at its end",
          .limit =
              "the force of 1 makes stresses of 6 length/height, and refinement with exact products leaves "
              "log10(length) digits "
              "of the condition (length/h)^4, and 3 above 1e-13",
          .values = {10, 30, 100, 300, 1000, 2000, 5000},
          .quick = {10, 300},
          .benign = 10,
          .make = cantilever,
          .error = cantilever_error,
          .digits = [](double length) { return 3 + std::log10(length / 10); }};
}

// Rollers below and, turned by a small angle, above: under pressure on its ends the body is pushed out of the wedge,
// and all that holds it is the pressure on the rollers. Exact: the same pressure everywhere, and a displacement in
// proportion to the distance from the apex.
HardCase between_rollers(double angle) {
  return {outline({{0, 0}, {1, 0}, {1, 1 + std::tan(angle)}, {0, 1}}, {"roller", "end", "roller", "end"}) +
          material(young, nu) + boundary("roller", "displacement_normal = 0") + boundary("end", "pressure = 1") +
          probe({{0.2, 0.3}, {0.5, 0.6}, {0.9, 0.1}}) + mesh_and_output(0.25)};
}

double roller_error(const Compared& c) {
  double worst = stress_error(c.seen, [](const Vec2&) { return Eigen::Vector3d(-1, -1, 0); });
  const double strain = -(1 + nu) * (1 - 2 * nu) / young, apex = -1 / std::tan(c.knob);
  for (const ProbeRow& row : c.seen.probe) {
    const Vec2 exact = strain * Vec2(row.at.x() - apex, row.at.y());
    worst = std::max(worst, (row.displacement - exact).norm() / exact.norm());
  }
  return worst;
}

HardFamily mechanisms() {
  return {.name = "mechanisms",
          .title = "Nearly a mechanism: rollers that are nearly parallel",
          .knob = "angle between the rollers",
          .truth = "closed form: the same pressure everywhere, displacements like the distance from the apex",
          .limit =
              "an imbalance of rounding is held by rollers that press 1/angle as much: log10(0.1/angle) digits, and "
              "3 above 1e-13",
          .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8},
          .quick = {1e-1, 1e-6},
          .benign = 1e-1,
          .make = between_rollers,
          .error = roller_error,
          .digits = [](double angle) { return 3 + std::log10(0.1 / angle); },
          .record = [](double angle) { return angle < 3e-6 ? HardVerdict::Told : HardVerdict::Held; },
          .why = "rollers within 3e-6 of parallel are taken for parallel: a note says that the body is free to slide"};
}

// Two cracks leave a ligament, which is bent. For a ligament 2a in an infinite body the
// stress on it is C x/sqrt(a^2 - x^2), K = +-2 M/(sqrt(pi) a^1.5).
HardCase hinge(double half) {
  return {outline({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {"end", "side", "end", "side"}) +
          crack("l", {{-1, 0}, {-half, 0}}, "contact = \"open\"\n") +
          crack("r", {{half, 0}, {1, 0}}, "contact = \"open\"\n") + material(young, nu) +
          boundary("end", "traction = [0, \"1.5 * x * ny\"]") + mesh_and_output(0.25)};
}

double hinge_error(const Compared& c) {
  const double truth = 2 / (std::sqrt(pi) * std::pow(c.knob, 1.5));
  double worst = 0;
  int tips = 0;
  for (const CrackResult& crack : c.seen.result.cracks)
    for (const TipResult& tip : crack.tips) {
      if (std::abs(tip.at.norm() - c.knob) > 1e-9) continue;
      worst = tip.K_I ? std::max(worst, std::abs(std::abs(*tip.K_I) / truth - 1)) : infinity;
      ++tips;
    }
  return tips == 2 ? worst : infinity;
}

HardFamily hinges() {
  return {.name = "hinges",
          .title = "Nearly a mechanism: a bent ligament",
          .knob = "half width of the ligament over that of the body",
          .truth =
              "closed form of a ligament in an infinite body: K_I of both tips; the body is finite, which is a share "
              "of the order of the ligament squared",
          .limit = "no digit: both errors fall or stay; measured at 0.1, and 1 digit above it allowed",
          .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5},
          .quick = {1e-1, 1e-4},
          .benign = 1e-1,
          .make = hinge,
          .error = hinge_error,
          .digits = [](double) { return 1.0; },
          .floor = 1e-3};
}

// A beam on two short supports. The forces there are known by statics.
HardCase on_two_supports(double width, const std::string& solver, double size) {
  return {outline({{0, 0}, {0.5, 0}, {0.5 + width, 0}, {3.5 - width, 0}, {3.5, 0}, {4, 0}, {4, 1}, {0, 1}},
                  {"free", "left", "free", "right", "free", "free", "top", "free"}) +
          material(young, nu) + boundary("left", "displacement = [0, 0]") + boundary("right", "displacement_y = 0") +
          boundary("top", "traction = [0, -1]") + probe({{2, 0.2}, {2, 0.8}, {1.4, 0.5}, {3, 0.7}}) +
          mesh_and_output(size) + solver};
}

double support_error(const Compared& c) {
  double worst = 0;
  for (const ResultantResult& r : c.seen.result.state->reactions)
    worst = std::max(worst, std::abs(r.force.y() - 2) / 2);
  double largest = 0, off = 0;
  for (std::size_t i = 0; i < c.seen.probe.size(); ++i) {
    off = std::max(off, (c.seen.probe[i].stress - c.reference->probe[i].stress).cwiseAbs().maxCoeff());
    largest = std::max(largest, c.reference->probe[i].stress.cwiseAbs().maxCoeff());
  }
  return std::max(worst, off / largest);
}

HardFamily tiny_supports() {
  return {
      .name = "tiny-supports",
      .title = "Short supports",
      .knob = "length of each support over the height of the beam",
      .truth = "statics: the forces there; another element (afw) of degree 3 on a finer mesh: stresses at four points",
      .limit = "1 digit: the mesh follows the supports, so that the error stays that of a mesh",
      .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6},
      .quick = {1e-1, 1e-6},
      .benign = 1e-1,
      .make = [](double width) { return on_two_supports(width, "", 0.25); },
      .reference = [](double width) { return on_two_supports(width, other_element, 0.2); },
      .error = support_error,
      .digits = [](double) { return 1.0; },
      .floor = 1e-3};
}

// Energy and stresses of the run against those of the benign one.
double against_benign(const Compared& c) {
  double worst = std::abs(c.seen.result.state->energy / c.benign.result.state->energy - 1), largest = 0, off = 0;
  for (std::size_t i = 0; i < c.seen.probe.size(); ++i) {
    off = std::max(off, (c.seen.probe[i].stress - c.benign.probe[i].stress).cwiseAbs().maxCoeff());
    largest = std::max(largest, c.benign.probe[i].stress.cwiseAbs().maxCoeff());
  }
  return std::max(worst, off / largest);
}

HardFamily beside_nodes(std::string name, std::string title, std::string knob) {
  return {.name = std::move(name),
          .title = std::move(title),
          .knob = std::move(knob),
          .truth = "the run at the node itself: energy, stresses at three points",
          .limit = "10 times the distance, and 3 digits above 1e-13",
          .values = {0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-7, -1e-7},
          .quick = {1e-12, -1e-12, 1e-7},
          .benign = 0,
          .error = against_benign,
          .digits = [](double d) { return std::max(3.0, d != 0 ? std::log10(10 * std::abs(d) / 1e-13) : 0); }};
}

// A load that ends at a corner of the outline, which is a node, or beside it.
HardFamily load_ends() {
  HardFamily f = beside_nodes("load-ends", "End of a load beside a node", "distance of the end from the node");
  f.make = [](double d) {
    return HardCase{outline({{0, 0}, {1, 0}, {1, 1}, {0.5, 1}, {0, 1}}, {"foot", "free", "top", "top", "free"}) +
                    material(young, nu) + boundary("foot", "displacement = [0, 0]") +
                    boundary("top", fmt::format("traction = [0, \"x < 0.5 + ({}) ? -1 : 0\"]", decimal(d))) +
                    probe({{0.3, 0.3}, {0.6, 0.7}, {0.8, 0.2}}) + mesh_and_output(0.2)};
  };
  return f;
}

// A crack that ends at a corner of the outline, or beside it, inside and outside.
HardFamily crack_ends() {
  HardFamily f = beside_nodes("crack-ends", "End of a crack beside a node", "distance of the mouth from the corner");
  f.make = [](double d) {
    return HardCase{outline({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0.5}}, {"foot", "free", "top", "free", "free"}) +
                    crack("c", {{d, 0.5}, {0.5, 0.5}}) + material(young, nu) +
                    boundary("foot", "displacement = [0, 0]") + boundary("top", "traction = [0, 1]") +
                    probe({{0.3, 0.3}, {0.6, 0.7}, {0.8, 0.2}}) + mesh_and_output(0.2)};
  };
  return f;
}

}  // namespace

std::vector<HardFamily> support_families() {
  return {slenderness(), mechanisms(), hinges(), tiny_supports(), load_ends(), crack_ends()};
}

std::vector<HardFamily> mesh_families() {
  return {{.name = "grading",
           .title = "Grading towards crack tips",
           .knob = "edges at the tips over those of the rest",
           .truth = "closed form: K of a row of collinear cracks",
           .limit = "half a digit: finer tips cannot make it worse until rounding does",
           .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8},
           .quick = {1e-1, 1e-8},
           .benign = 1e-1,
           .make =
               [](double ratio) {
                 return collinear_cell({.mesh = fmt::format("crack_tip_size = {}\n", decimal(0.25 * ratio))});
               },
           .error = [](const Compared& c) { return collinear_error(c, 0.5); },
           .digits = [](double) { return 0.5; },
           .floor = 1e-4}};
}

}  // namespace kerf
