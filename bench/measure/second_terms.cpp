// The second term of the expansion against series: a hole, a softer and a stiffer inclusion at three places of the unit
// disc under loads of degree 4. The series fit all conditions on both circles and know nothing of expansions
// (tests/topo/disc_series.hpp). A row has c2 against the limit of the series, relative to the sum of the sizes of its
// parts (they may cancel), and what T and T + c2 eps^2 leave of the exact change for eps a quarter of the way to the
// rim [theory: Q.1]. docs/theory/second_order.md, "A circle in any field".

#include "bench/measure/second_terms.hpp"

#include "kerf/mesher.hpp"
#include "kerf/second_order.hpp"
#include "kerf/stop.hpp"
#include "tests/topo/disc_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

using series::Complex;

// Every term of phi and psi up to the degree 4, nothing symmetric.
series::Polynomial loads() {
  return {{Complex(.4, 0), Complex(.3, -.2), Complex(-.15, .1), Complex(.08, .05)},
          {Complex(.5, -.3), Complex(-.2, .25), Complex(.1, .12), Complex(.05, -.04)}};
}

struct Filling {
  std::string name;
  std::optional<Material> material;  // none: a hole
};

double sum_of_parts(const SecondOrder& s) {
  return std::abs(s.mean_gradient) + std::abs(s.deviator_gradient) + std::abs(s.curvature) + std::abs(s.reply);
}

/// What T, and T + c2 eps^2, leave of the exact change at a quarter of the distance to the rim.
void measure_change(const Material& m, const Filling& filling, Complex x, const SecondOrder& found,
                    SecondTermRow& row) {
  row.radius = 0.25 * (1 - std::abs(x));
  const double change =
      series::Disc(m, filling.material, x, row.radius).energy_change(loads()) / (pi * row.radius * row.radius);
  row.left_by_first = std::abs(found.T / change - 1);
  row.left_by_second = std::abs((found.T + found.c2 * row.radius * row.radius) / change - 1);
}

std::vector<SecondTermRow> on_mesh(double size, int degree) {
  const Material m = plane_strain(1, 0.3);
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = circle("rim", {0, 0}, 1, 0);
  Scene scene{.material = m};
  scene.tractions.push_back({0, [l = loads()](const Vec2& x, const Vec2& n) -> Vec2 {
                               return series::stress(l, Complex(x.x(), x.y())) * n;
                             }});
  const Model model = prepare(triangulate(shape, {.size = size}), bdms(degree), scene, 1);
  const State state = solve(model);
  const Functional j{"energy", {energy()}};
  const Analysis a = analyze(j, model, state);
  std::vector<SecondTermRow> rows;
  for (const Filling& filling : {Filling{"hole", std::nullopt}, Filling{"soft inclusion", stiffened(m, 0.2)},
                                 Filling{"stiff inclusion", stiffened(m, 5)}}) {
    const Perturbation p =
        filling.material ? Perturbation{Perturbation::Kind::Inclusion, *filling.material} : Perturbation{};
    for (const Complex x : {Complex(0, 0), Complex(.3, .1), Complex(-.2, .6)}) {
      SecondTermRow row{.change = filling.name,
                        .degree = degree,
                        .triangles = static_cast<Index>(model.mesh.triangles.size()),
                        .at = {x.real(), x.imag()}};
      const series::Limits exact = series::limits(m, filling.material, x, loads(), 0.2 * (1 - std::abs(x)));
      const SecondOrder found = second_order(a, j, p, row.at);
      row.T_exact = exact.T, row.c2_exact = exact.c2;
      if (found.available) {
        row.T = found.T, row.c2 = found.c2;
        row.error = std::abs(found.c2 - exact.c2) / sum_of_parts(found);
        measure_change(m, filling, x, found, row);
      }
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace

std::vector<SecondTermRow> measure_second_terms(const BenchOptions& options) {
  struct OnMesh {
    double size;
    int degree;
  };
  const std::vector<OnMesh> all = options.quick
                                      ? std::vector<OnMesh>{{0.1, 2}}
                                      : std::vector<OnMesh>{{0.1, 1}, {0.05, 1}, {0.025, 1}, {0.1, 2}, {0.05, 2}};
  std::vector<SecondTermRow> rows;
  for (const OnMesh& mesh : all) {
    if (options.on_phase) options.on_phase(fmt::format("disc, degree {}, size {}", mesh.degree, mesh.size));
    if (stop_asked(options)) break;
    for (SecondTermRow& row : on_mesh(mesh.size, mesh.degree)) rows.push_back(std::move(row));
  }
  return rows;
}

std::string second_term_table(const std::vector<SecondTermRow>& rows) {
  std::string out =
      "| change | degree | triangles | c2 off by | radius | T leaves of the change | T + c2 eps^2 leaves |\n"
      "|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < rows.size();) {
    const SecondTermRow& first = rows[i];
    SecondTermRow worst = first;
    for (; i < rows.size() && rows[i].change == first.change && rows[i].triangles == first.triangles; ++i) {
      worst.error = std::max(worst.error, rows[i].error);
      worst.left_by_first = std::max(worst.left_by_first, rows[i].left_by_first);
      worst.left_by_second = std::max(worst.left_by_second, rows[i].left_by_second);
      worst.radius = std::min(worst.radius, rows[i].radius);
    }
    out += fmt::format("| {} | {} | {} | {:.1e} | {:.2f} to {:.2f} | {:.1f} % | {:.2f} % |\n", worst.change,
                       worst.degree, worst.triangles, worst.error, worst.radius, 0.25, 100 * worst.left_by_first,
                       100 * worst.left_by_second);
  }
  return out;
}

}  // namespace kerf
