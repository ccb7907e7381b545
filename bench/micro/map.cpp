// Speed against error of the whole line on the exact partly closed crack: mesh, state with contact, map. Three mesh
// sizes, one thread; time split as in result.json, relative L2 error of the stress, relative L1 error of the map (0.1
// and more from the tips), largest resident memory so far.

#include "kerf/map.hpp"
#include "base/stopwatch.hpp"
#include "kerf/mesher.hpp"
#include "tests/support/integral.hpp"

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>

namespace {

using namespace kerf;

Shape cracked_square() {
  Shape shape;
  shape.labels = {"outer"};
  shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  shape.cracks = {{"c", {Vec2(-1, 0), Vec2(1, 0)}}};
  return shape;
}

double map_error(const exact::ExactField& f, const Model& m, const FullMap& map) {
  double difference = 0, sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Vec2 x = centroid(m.mesh, t);
    if ((x - f.tips[0].at).norm() < 0.1 || (x - f.tips[1].at).norm() < 0.1) continue;
    const double value = exact::hole_derivative(f.material, f.stress(x, exact::side_of(f, x)));
    difference += area(m.mesh, t) * std::abs(map.at_centroids[t] - value);
    sum += area(m.mesh, t) * std::abs(value);
  }
  return difference / sum;
}

// Arguments: mesh size and the poisson ratio's distance to 1/2, both in millionths.
void partly_closed_crack(benchmark::State& bench) {
  const double size = 1e-6 * static_cast<double>(bench.range(0)), nu = 0.5 - 1e-6 * static_cast<double>(bench.range(1));
  // For the smooth part the error is h^2, at the tip the root of its edge length: balanced by h^4, within reason.
  const Sizing sizing{.size = size, .crack_tip_size = std::max(1e-9, 0.3 * std::pow(size, 4))};
  const exact::ExactField f =
      exact::line_crack("partly closed", plane_strain(1000, nu), {.p1 = 1, .westergaard = true});
  const Shape shape = cracked_square();
  Scene scene;
  scene.material = f.material;
  scene.laws.resize(1);
  scene.supports.push_back(
      {0, false, true, true, [&f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
  for (auto _ : bench) {
    Stopwatch watch;
    Mesh mesh = triangulate(shape, sizing);
    const double meshing = watch.lap();
    const Model model = prepare(std::move(mesh), element("bdms"), scene, 1);
    watch.lap();
    const State state = solve(model);
    const double solving = watch.lap();
    const Corners corners = split_at_cracks(model.mesh);
    const Functional j{"energy", {energy()}};
    const FullMap map = map_everywhere(analyze(j, model, state), j, {}, corners);
    const double mapping = watch.lap();
    bench.SetIterationTime(meshing + model.seconds.assemble + model.seconds.factor + solving + mapping);
    bench.counters["triangles"] = static_cast<double>(model.mesh.triangles.size());
    bench.counters["mesh_s"] = meshing;
    bench.counters["assemble_s"] = model.seconds.assemble;
    bench.counters["factor_s"] = model.seconds.factor;
    bench.counters["solve_s"] = solving;
    bench.counters["contact_s"] = state.seconds.contact;
    bench.counters["map_s"] = mapping;
    bench.counters["kkt"] = state.certificate.kkt;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    bench.counters["peak_mb"] = static_cast<double>(usage.ru_maxrss) / 1024;
    const double error = exact::stress_error(model, state, f);
    const double norm = exact::stress_error(model.mesh, f, [](Index, const Vec2&) { return Mat2(Mat2::Zero()); });
    bench.counters["stress_error"] = error / norm;
    bench.counters["map_error"] = map_error(f, model, map);
  }
}

BENCHMARK(partly_closed_crack)
    ->ArgNames({"size", "half_minus_nu"})
    ->Args({77000, 200000})
    ->Args({22800, 200000})
    ->Args({11450, 200000})
    ->Args({77000, 1})
    ->Args({22800, 1})
    ->Args({11450, 1})
    ->Iterations(1)
    ->Repetitions(3)
    ->ReportAggregatesOnly(true)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
