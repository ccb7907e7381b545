// Time of triangulate on a cracked plate, graded to the tips, and the quality of what it gives.

#include "kerf/mesher.hpp"

#include <benchmark/benchmark.h>

#include <cmath>

namespace {

void triangulate_cracked_plate(benchmark::State& state) {
  kerf::Shape shape{kerf::polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, {}, {"side"}};
  shape.cracks = {{"c", {{-1, 0}, {1, 0}}}};
  // Equilateral triangles of this size fill the plate; the tips add a few hundred.
  const double size = std::sqrt(16 / (std::sqrt(3.0) / 4 * double(state.range(0))));
  kerf::Mesh mesh;
  for (auto _ : state) {
    mesh = kerf::triangulate(shape, {.size = size});
    benchmark::DoNotOptimize(mesh.edges.data());
  }
  const kerf::Quality quality = kerf::quality(mesh);
  state.counters["triangles"] = double(mesh.triangles.size());
  state.counters["mean_quality"] = quality.mean_quality;
  state.counters["min_angle_deg"] = quality.min_angle_deg;
}
BENCHMARK(triangulate_cracked_plate)->Arg(10000)->Arg(100000)->Arg(400000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
