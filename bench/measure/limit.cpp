// `kerf bench limit`: how near a run comes to what the machine can do. One body (the partly closed crack, bdms of
// degree 1) at 10,000 to 1.4 million triangles, on one thread and two: wall and processor seconds of each phase, peak
// of memory, and
//   limit = flops of the numeric factor / rate of dgemm,
// the rate measured just before on matrices of 1000 x 1000, as the best of three. The growth is the exponent of a least
// squares fit, log time = a + p log n. Phases that overlap in the code (factor within preparation, contact within the
// solution) are taken out of the phase around them by their own wall clocks, and get their share of its processor time.
// A row is the median of three runs by wall time, of one beyond 200,000 triangles. docs/benchmarks.md has the results.

#include "bench/measure/limit.hpp"

#include "base/stopwatch.hpp"
#include "bench/command/records.hpp"
#include "bench/measure/map_measure.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/recover.hpp"
#include "plot/chart.hpp"
#include "solver/factor.hpp"
#include "solver/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

extern "C" void dgemm_(const char* a_transposed, const char* b_transposed, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

namespace kerf {

namespace {

constexpr const char* limit_problem = "closing-crack";

/// Flops per second of a product of square matrices that fit into no cache near the processor; the best of three.
double dgemm_rate() {
  constexpr int n = 1000;
  constexpr double one = 1, zero = 0, flops = 2.0 * n * n * n;
  const Eigen::MatrixXd a = Eigen::MatrixXd::Constant(n, n, 0.5), b = Eigen::MatrixXd::Constant(n, n, 0.25);
  Eigen::MatrixXd c(n, n);
  double best = 0;
  for (int i = 0; i < 4; ++i) {  // the first one wakes the library
    ProcessorWatch watch;
    dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
    const double seconds = watch.lap();
    if (i > 0) best = std::max(best, flops / seconds);
  }
  return best;
}

class Phases {
 public:
  explicit Phases(LimitRow& row) : row_(row) {}

  /// `hidden`: wall seconds of it that are another phase's.
  void end(const char* name, double hidden = 0) {
    const double wall = wall_.lap(), processor = processor_.lap();
    row_.phases.push_back({name, wall - hidden, wall > 0 ? processor * (wall - hidden) / wall : 0});
    if (hidden > 0) processor_of_rest_ = processor * hidden / wall;
  }
  /// What `end` has hidden.
  void rest(const char* name, double wall) {
    row_.phases.push_back({name, wall, processor_of_rest_});
  }

 private:
  LimitRow& row_;
  Stopwatch wall_;
  ProcessorWatch processor_;
  double processor_of_rest_ = 0;
};

LimitRow run_limit(const BenchProblem& problem, const MeshPlan& plan, int threads) {
  LimitRow row{.threads = threads, .phases = {}, .dgemm_rate = dgemm_rate()};
  forget_peak_memory();
  row.before_mb = peak_memory_mb();
  Phases phases(row);
  Mesh mesh = triangulate(plan.shape, plan.sizing);
  phases.end("mesh");
  const Model model = prepare(std::move(mesh), bdms(1), problem.scene, threads);
  phases.end("assemble", model.seconds.factor);
  phases.rest("factor", model.seconds.factor);
  row.triangles = static_cast<Index>(model.mesh.triangles.size());
  if (model.inner->factor) row.factor_flops = model.inner->factor->flops();
  const State state = solve(model);
  phases.end("solve", state.seconds.contact);
  phases.rest("contact", state.seconds.contact);
  row.certified = certified(state);
  error_indicator(model, state);
  phases.end("estimate");
  energy_bounds(model, state);
  phases.end("bounds");
  crack_tips(model, state);
  phases.end("tips");
  const Corners corners = split_at_cracks(model.mesh);
  corner_values(model, state, corners);
  phases.end("corners");
  const Functional j{"energy", {energy()}};
  map_everywhere(analyze(j, model, state), j, {}, corners);
  phases.end("map");
  row.memory_mb = peak_memory_mb();
  return row;
}

void draw_limit(const std::filesystem::path& path, const LimitBench& bench) {
  Chart chart{.title = "kerf bench limit",
              .subtitle = "partly closed crack, bdms 1, one thread (dashed: two)",
              .x_label = "triangles",
              .y_label = "seconds of wall clock",
              .series = {},
              .slopes = {{1, "n"}, {1.5, "n^1.5"}}};
  const auto add = [&](const std::string& name, int threads, std::size_t style, const auto& value) {
    Series series{.name = name, .points = {}, .dashed = threads > 1, .style = style};
    for (const LimitRow& row : bench.rows)
      if (row.threads == threads) series.points.emplace_back(static_cast<double>(row.triangles), value(row));
    if (!series.points.empty()) chart.series.push_back(std::move(series));
  };
  add("whole run", 1, 0, [](const LimitRow& row) { return row.wall(); });
  add("whole run, two threads", 2, 0, [](const LimitRow& row) { return row.wall(); });
  for (const char* name : {"assemble", "factor", "solve", "bounds"})
    add(name, 1, chart.series.size(), [name](const LimitRow& row) {
      for (const LimitPhase& phase : row.phases)
        if (std::string_view(phase.name) == name) return phase.wall_s;
      return nan;
    });
  add("limit: the factor's flops at dgemm's speed", 1, chart.series.size(),
      [](const LimitRow& row) { return row.limit(); });
  if (!chart.series.empty()) draw(path, chart);
}

}  // namespace

double LimitRow::wall() const {
  double sum = 0;
  for (const LimitPhase& phase : phases) sum += phase.wall_s;
  return sum;
}

double LimitRow::wall_of_map() const {
  double sum = wall();
  for (const LimitPhase& phase : phases)
    for (const std::string_view left_out : {"estimate", "bounds", "tips", "corners"})
      if (phase.name == left_out) sum -= phase.wall_s;
  return sum;
}

double LimitRow::processor() const {
  double sum = 0;
  for (const LimitPhase& phase : phases) sum += phase.processor_s;
  return sum;
}

double growth_exponent(const LimitBench& bench, int threads, const std::function<double(const LimitRow&)>& of) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const LimitRow& row : bench.rows) {
    if (row.threads != threads || !(of(row) > 0)) continue;
    const double u = std::log(static_cast<double>(row.triangles)), v = std::log(of(row));
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return n < 2 ? nan : (n * xy - x * y) / (n * xx - x * x);
}

LimitBench run_limit_bench(const BenchOptions& options, bool large) {
  make_folder(options.folder);
  LimitBench bench;
  std::vector<Index> counts{10000, 100000, 355000};
  if (options.quick) counts = {1000, 2000};
  if (large) counts.push_back(1400000);
  const BenchProblem problem = map_problem(limit_problem, 0.3);
  for (const Index count : counts) {
    const MeshPlan plan = bench_plan(problem, Grading::Graded, 1, level_of(problem, Grading::Graded, 1, count));
    for (const int threads : {1, 2}) {
      if (stop_asked(options)) break;
      if (options.on_phase) options.on_phase(fmt::format("{} triangles, {} threads", count, threads));
      std::vector<LimitRow> runs;
      const int repeat = options.quick || count > 200000 ? 1 : 3;
      for (int i = 0; i < repeat; ++i) runs.push_back(run_limit(problem, plan, threads));
      std::ranges::sort(runs, {}, &LimitRow::wall);
      bench.rows.push_back(runs[runs.size() / 2]);
    }
  }
  bench.stopped = stop_asked(options);
  write_limit_csv(options.folder / "limit.csv", bench);
  write_limit_json(options.folder / "limit.json", bench);
  draw_limit(options.folder / "limit.png", bench);
  return bench;
}

std::string summary(const LimitBench& bench) {
  if (bench.rows.empty()) return "nothing was run\n";
  std::string out =
      "Seconds of wall clock; map: without estimate, bounds, tips and corners, which [output] can leave out; limit: "
      "the "
      "flops of the factor at dgemm's speed on one thread:\n";
  out += fmt::format("{:>9}{:>4}", "triangles", "th");
  for (const LimitPhase& phase : bench.rows[0].phases) out += fmt::format("{:>9}", phase.name);
  out += fmt::format("{:>8}{:>8}{:>7}{:>8}{:>8}{:>8}{:>7}\n", "whole", "map", "limit", "/limit", "map/lim", "GFlop/s",
                     "kB/tri");
  for (const LimitRow& row : bench.rows) {
    out += fmt::format("{:>9}{:>4}", row.triangles, row.threads);
    double factor = nan;
    for (const LimitPhase& phase : row.phases) {
      out += fmt::format("{:>9.2g}", phase.wall_s);
      if (std::string_view(phase.name) == "factor") factor = phase.wall_s;
    }
    out += fmt::format("{:>8.3g}{:>8.3g}{:>7.2g}{:>8.3g}{:>8.3g}{:>8}{:>7.2f}\n", row.wall(), row.wall_of_map(),
                       row.limit(), row.wall() / row.limit(), row.wall_of_map() / row.limit(),
                       fmt::format("{:.0f}/{:.0f}", 1e-9 * row.factor_flops / factor, 1e-9 * row.dgemm_rate),
                       row.bytes_per_triangle() / 1000);
  }
  for (std::size_t i = 0; i + 1 < bench.rows.size(); ++i)
    if (bench.rows[i].threads == 1 && bench.rows[i + 1].threads == 2)
      out += fmt::format("{} triangles: two threads take {:.2f} of the time of one\n", bench.rows[i].triangles,
                         bench.rows[i + 1].wall() / bench.rows[i].wall());
  out += fmt::format("growth: time ~ n^{:.2f} (two threads {:.2f}), memory ~ n^{:.2f}\n",
                     growth_exponent(bench, 1, &LimitRow::wall), growth_exponent(bench, 2, &LimitRow::wall),
                     growth_exponent(bench, 1, [](const LimitRow& row) { return row.memory_mb - row.before_mb; }));
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

std::vector<std::string> limit_case_names() {
  return {limit_problem};
}

}  // namespace kerf
