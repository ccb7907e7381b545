// Slivers: flat triangles of a given mesh, and sharp corners of the drawing.

#include "bench/hard/fields.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

namespace {

Eigen::Vector3d exact_stress_in_shape(const Vec2& x) {
  return linear_stress({}, x);
}

// The unit square in columns and rows of triangles, one row of them so low that its angles are the given one. Physical
// curves: held (bottom, left), loaded.
std::string flat_mesh(double degrees) {
  constexpr int columns = 4;
  const double low = std::tan(degrees * pi / 180) / columns;
  const std::vector<double> y{0, 0.25, 0.5, 0.5 + low, 0.75, 1};
  const int rows = static_cast<int>(y.size()) - 1;
  const auto node = [](int i, int j) { return j * (columns + 1) + i + 1; };
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"held\"\n1 2 \"loaded\"\n2 3 "
      "\"body\"\n$EndPhysicalNames\n$Nodes\n";
  text += fmt::format("{}\n", (columns + 1) * (rows + 1));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      text += fmt::format("{} {:.17g} {:.17g} 0\n", node(i, j), static_cast<double>(i) / columns, y[j]);
  std::string elements;
  int count = 0;
  const auto line = [&](int physical, int a, int b) {
    elements += fmt::format("{} 1 2 {} {} {} {}\n", ++count, physical, physical, a, b);
  };
  for (int i = 0; i < columns; ++i) line(1, node(i, 0), node(i + 1, 0)), line(2, node(i, rows), node(i + 1, rows));
  for (int j = 0; j < rows; ++j) line(1, node(0, j), node(0, j + 1)), line(2, node(columns, j), node(columns, j + 1));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      elements += fmt::format("{} 2 2 3 3 {} {} {}\n", ++count, node(i, j), node(i + 1, j), node(i + 1, j + 1));
      elements += fmt::format("{} 2 2 3 3 {} {} {}\n", ++count, node(i, j), node(i + 1, j + 1), node(i, j + 1));
    }
  return text + fmt::format("$EndNodes\n$Elements\n{}\n{}$EndElements\n", count, elements);
}

HardCase slivers_case(double degrees) {
  const std::string file = fmt::format("slivers_{:.3g}.msh", degrees);
  return {fmt::format("[domain]\nfile = \"{}\"\n", file) + material(1, 0.3) + linear_frame({}) +
              boundary("held", "displacement = " + linear_displacement({}, 1, 0.3)) +
              boundary("loaded", "traction = " + linear_traction({})) +
              probe({{0.3, 0.2}, {0.6, 0.51}, {0.4, 0.7}, {0.9, 0.9}}) +
              "[output]\nvtk = false\npng = false\nhtml = false\n",
          {{file, flat_mesh(degrees)}}};
}

HardCase wedge_case(double degrees) {
  const double slope = std::tan(degrees * pi / 180);
  std::vector<Vec2> probes;
  for (const double x : {0.2, 0.5, 0.8}) probes.push_back({x, 0.4 * slope * x});
  return {outline({{0, 0}, {1, 0}, {1, slope}}, {"loaded", "held", "loaded"}) + material(1, 0.3) + linear_frame({}) +
          boundary("held", "displacement = " + linear_displacement({}, 1, 0.3)) +
          boundary("loaded", "traction = " + linear_traction({})) + probe(probes) + mesh_and_output(0.3)};
}

}  // namespace

std::vector<HardFamily> shape_families() {
  HardFamily slivers{.name = "slivers",
                     .title = "Flat triangles in a given mesh",
                     .knob = "least angle of the mesh, degrees",
                     .truth = "closed form: a linear stress field",
                     .limit =
                         "the condition of a triangle's own matrix grows like 1/angle^2: 2 log10(10/angle) digits, "
                         "and 2 above 1e-13",
                     .values = {10, 3, 1, 0.3, 0.1, 0.03, 0.01},
                     .quick = {10, 0.01},
                     .benign = 10,
                     .make = slivers_case,
                     .error = [](const Compared& c) { return stress_error(c.seen, exact_stress_in_shape); },
                     .digits = [](double degrees) { return 2 + 2 * std::log10(10 / degrees); }};
  HardFamily wedges = slivers;
  wedges.name = "wedges";
  wedges.title = "Sharp corner of the body";
  wedges.knob = "angle of the corner, degrees";
  wedges.limit =
      "the wedge is a slender body: its bending costs what its mesh has across, log10(10/angle) digits, and 3 "
      "above 1e-13";
  wedges.make = wedge_case;
  wedges.record = [](double degrees) { return degrees < 0.02 ? HardVerdict::Told : HardVerdict::Held; };
  wedges.why =
      "the matrix of a wedge 5700 times as long as wide has lost its definiteness to rounding: a note says how "
      "many digits are left";
  wedges.digits = [](double degrees) { return 3 + std::log10(10 / degrees); };
  return {slivers, wedges};
}

}  // namespace kerf
