// Narrow ligaments, near cracks, kinks, crossings, many cracks. A row of collinear cracks of half length a in a period
// 2 has
//   K_I = sqrt(2 tan(pi a / 2)) for a unit stress
// in closed form; one cell of it between rollers is the whole row, high enough (4) that what the cracks disturb, like
// exp(-pi y), has gone. Mouths at the sides of the cell leave a ligament in its middle. Where nothing is known in
// closed form another element of degree 3 on a finer mesh is the truth. Cells of a periodic body must all have the K of
// a single one. Cracks that lie along the principal directions of a linear stress without normal stress on them do not
// disturb it: touching() has such cracks, some of which have neither gap nor pressure.

#include "bench/hard/cracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

std::string crack(const std::string& name, const std::vector<Vec2>& path, const std::string& more) {
  return fmt::format("[[crack]]\nname = \"{}\"\npath = {}\n{}", name, decimals(path), more);
}

HardCase collinear_cell(const Cell& cell) {
  const Placed placed{.angle = cell.angle};
  const auto at = [&](double x, double y) { return placed.at({x, y}); };
  constexpr double high = 4;  // what the cracks disturb falls like exp(-pi y)
  const double rest = 1 - cell.half;
  const std::string cracks = cell.mouths ? crack("l", {at(-1, 0), at(-rest, 0)}) + crack("r", {at(rest, 0), at(1, 0)})
                                         : crack("c", {at(-cell.half, 0), at(cell.half, 0)});
  return {outline({at(-1, -high), at(1, -high), at(1, high), at(-1, high)}, {"end", "side", "end", "side"}) + cracks +
          material(1, 0.3) + boundary("side", "displacement_normal = 0") + boundary("end", "pressure = -1") +
          mesh_and_output(cell.size, cell.mesh)};
}

double collinear_error(const Compared& c, double half) {
  const double truth = std::sqrt(2 * std::tan(pi * half / 2));
  double worst = 0;
  int tips = 0;
  for (const CrackResult& crack : c.seen.result.cracks)
    for (const TipResult& tip : crack.tips) {
      if (std::abs(std::abs(tip.at.norm()) - half) > 1e-9 && std::abs(tip.at.norm() - (1 - half)) > 1e-9) continue;
      worst = tip.K_I ? std::max(worst, std::abs(*tip.K_I / truth - 1)) : infinity;
      ++tips;
    }
  return tips == 2 ? worst : infinity;
}

HardCase touching(double share, const Placed& placed) {
  constexpr int all = 4;
  const int vertical = static_cast<int>(std::lround(share * all));
  const auto at = [&](double x, double y) { return placed.at({x, y}); };
  std::string cracks;
  for (int i = 0; i < all; ++i) {
    const double across = -1.6 + 0.9 * i, along = 0.4 + 0.4 * i;
    cracks += i < vertical ? crack(fmt::format("c{}", i), {at(along, -0.5), at(along, 0.5)})
                           : crack(fmt::format("c{}", i), {at(-1.5, across), at(-0.5, across)});
  }
  const std::string pull = fmt::format("{} * p * (c * ny - s * nx)", decimal(placed.load));
  return {outline({at(-2, -2), at(2.5, -2), at(2.5, 2), at(-2, 2)}, {"outer", "outer", "outer", "outer"}) + cracks +
          material(1, 0.3) + local_frame(placed) +
          boundary("outer", fmt::format("traction = [\"-s * ({0})\", \"c * ({0})\"]", pull)) +
          probe({at(-1, 0.1), at(0.6, 0.2), at(1.8, -1), at(-1.7, -1.8)}) + mesh_and_output(0.4 * placed.length)};
}

Eigen::Vector3d touching_stress(const Placed& placed, const Vec2& x) {
  const double c = std::cos(placed.angle), s = std::sin(placed.angle), pull = placed.load * placed.local(x).x();
  return pull * Eigen::Vector3d(s * s, c * c, -s * c);
}

double tip_error(const Compared& c) {
  double worst = 0, largest = 0;
  const auto &cracks = c.seen.result.cracks, &truth = c.reference->result.cracks;
  for (std::size_t i = 0; i < cracks.size(); ++i)
    for (std::size_t k = 0; k < cracks[i].tips.size(); ++k) {
      const TipResult &tip = cracks[i].tips[k], &exact = truth[i].tips[k];
      if (tip.K_I.has_value() != exact.K_I.has_value()) return infinity;
      if (!tip.K_I) continue;
      worst = std::max({worst, std::abs(*tip.K_I - *exact.K_I), std::abs(*tip.K_II - *exact.K_II)});
      largest = std::max({largest, std::abs(*exact.K_I), std::abs(*exact.K_II)});
    }
  return largest > 0 ? worst / largest : infinity;
}

HardCase plate(const std::string& cracks, const Tensions& tensions, double size, const std::string& solver) {
  return {outline({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {"y", "x", "y", "x"}) + cracks + material(1, 0.3) +
          boundary("x", fmt::format("pressure = {}", decimal(-tensions.x))) +
          boundary("y", fmt::format("pressure = {}", decimal(-tensions.y))) + mesh_and_output(size) + solver};
}

namespace {

constexpr double coarse = 0.2, fine = 0.12;

HardFamily ligaments() {
  return {.name = "ligaments",
          .title = "Ligament between two tips",
          .knob = "width of the ligament over the spacing of the cracks",
          .truth = "closed form: K of a row of collinear cracks",
          .limit = "measured 6e-3 at most, and half a digit: the mesh follows the ligament, edges of a twentieth of it",
          .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6},
          .quick = {1e-1, 1e-6},
          .benign = 1e-1,
          .make = [](double width) { return collinear_cell({.half = 1 - width, .mouths = true}); },
          .error = [](const Compared& c) { return collinear_error(c, 1 - c.knob); },
          .digits = [](double) { return 1.0; },
          .floor = 2e-3,
          .record = [](double width) { return width < 2e-6 ? HardVerdict::Refused : HardVerdict::Held; },
          .why = "tips within 1e-6 of the size of the body are taken for one, and the cracks then cut it in two"};
}

/// K against the same body with another element of degree 3 on a finer mesh.
HardFamily against_finer(std::string name, std::string title, std::string knob) {
  return {.name = std::move(name),
          .title = std::move(title),
          .knob = std::move(knob),
          .truth = "another element (afw) of degree 3 on a finer mesh: K_I and K_II of all tips, over the largest",
          .limit = "1 digit: the mesh follows the drawing, so that the error stays that of a mesh",
          .error = tip_error,
          .digits = [](double) { return 1.0; },
          .floor = 1e-3};
}

HardFamily made_by(HardFamily f, std::function<std::string(double)> cracks, Tensions tensions) {
  f.make = [=](double knob) { return plate(cracks(knob), tensions, coarse); };
  f.reference = [=](double knob) { return plate(cracks(knob), tensions, fine, other_element); };
  return f;
}

HardFamily apart() {
  HardFamily f = against_finer("apart", "Tip near another crack", "distance of the tip from the crack");
  f.values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
  f.quick = {1e-1, 1e-5};
  f.benign = 1e-1;
  return made_by(f,
                 [](double d) {
                   return crack("a", {{-0.4, 0}, {0.4, 0}}) + crack("b", {{0.1, d}, {0.1, 0.5}});
                 },
                 {.x = 1, .y = 1});
}

HardFamily parallel() {
  HardFamily f = against_finer("parallel", "Cracks side by side", "distance of cracks that overlap by 0.004");
  f.values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
  f.quick = {1e-1, 1e-3};
  f.benign = 1e-1;
  return made_by(f,
                 [](double d) {
                   return crack("a", {{-0.5, 0}, {0.002, 0}}) + crack("b", {{-0.002, d}, {0.5, d}});
                 },
                 {.x = 0, .y = 1});
}

HardFamily kinks() {
  HardFamily f = against_finer("kinks", "Crack with a kink", "angle of the kink, degrees");
  f.values = {1, 10, 30, 60, 90, 120, 150, 170, 175, 179};
  f.quick = {1, 90, 175};
  f.benign = 30;
  f.limit =
      "1 digit above 1e-3, the error of a mesh; measured 1.6e-2 where the faces lie 1 degree apart, and a digit "
      "more the nearer to it";
  f.digits = [](double degrees) { return 1 + std::max(0.0, std::log10(10 / (180 - degrees))); };
  return made_by(f,
                 [](double degrees) {
                   const double angle = degrees * pi / 180;
                   return crack("c", {{-0.4, 0}, {0, 0}, {0.4 * std::cos(angle), 0.4 * std::sin(angle)}});
                 },
                 {.x = 0.3, .y = 1});
}

HardFamily crossings() {
  HardFamily f = against_finer("crossings", "Two cracks that cross", "angle of the crossing, degrees");
  f.values = {90, 60, 30, 10, 5, 2, 1};
  f.quick = {90, 5};
  f.benign = 90;
  f.limit =
      "1 digit above 1e-3, the error of a mesh; measured 1.9e-2 where the cracks meet at 1 degree, and a digit more "
      "the nearer to it";
  f.digits = [](double degrees) { return 1 + std::max(0.0, std::log10(10 / degrees)); };
  return made_by(f,
                 [](double degrees) {
                   const double angle = degrees * pi / 180;
                   const Vec2 end(0.4 * std::cos(angle), 0.4 * std::sin(angle));
                   return crack("a", {{-0.4, 0}, {0.4, 0}}) + crack("b", {-end, end});
                 },
                 {.x = 1, .y = 1});
}

// Equal cells with a crack in the middle of each, pulled by displacements of the ends: the cell and its mirror images.
HardCase cells(double count, const std::string& contact) {
  const int n = static_cast<int>(std::lround(count));
  int columns = static_cast<int>(std::sqrt(n));
  while (n % columns != 0) --columns;
  const int rows = n / columns;
  const double width = columns, height = rows;
  std::string cracks;
  for (int i = 0; i < n; ++i) {
    const double x = i % columns + 0.5, y = i / columns + 0.5;
    cracks += crack(fmt::format("c{}", i), {{x - 0.3, y}, {x + 0.3, y}}, contact);
  }
  return {outline({{0, 0}, {width, 0}, {width, height}, {0, height}}, {"side", "side", "top", "side"}) + cracks +
          material(1, 0.3) + boundary("side", "displacement_normal = 0") +
          boundary("top", fmt::format("displacement_normal = {}", decimal(height))) +
          mesh_and_output(0.3, "crack_tip_size = 0.08\n")};
}

// K_I of every tip against that of the single cell, computed finer.
double cells_error(const Compared& c) {
  const double truth = *c.reference->result.cracks[0].tips[0].K_I;
  double worst = 0;
  for (const CrackResult& crack : c.seen.result.cracks)
    for (const TipResult& tip : crack.tips)
      worst = tip.K_I ? std::max(worst, std::abs(*tip.K_I / truth - 1)) : infinity;
  return worst;
}

HardFamily many(const std::string& name, const std::string& title, const std::string& contact) {
  return {.name = name,
          .title = title,
          .knob = "number of cracks",
          .truth = "one cell by symmetry, with afw of degree 3 on a finer mesh: K_I of every tip",
          .limit = "half a digit: the worst of many meshes of the same cell",
          .values = {1, 10, 30, 100, 300, 1000},
          .quick = {1, 10},
          .benign = 1,
          .make = [contact](double count) { return cells(count, contact); },
          .reference =
              [contact](double) {
                HardCase c = cells(1, contact);
                c.text += other_element;
                return c;
              },
          .error = cells_error,
          .digits = [](double) { return 0.5; },
          .floor = 1e-2};
}

}  // namespace

std::vector<HardFamily> crack_families() {
  HardFamily in_contact = many("many", "Many cracks that may close", "");
  in_contact.values = {1, 10, 30, 100, 1000};
  return {ligaments(),
          apart(),
          parallel(),
          kinks(),
          crossings(),
          in_contact,
          many("many-open", "Many cracks without contact", "contact = \"open\"\n")};
}

}  // namespace kerf
