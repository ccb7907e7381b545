// The pictures of the benches: error against time, step and unknowns, beside other programs, maps, and designs. One
// color per element and degree in all pictures of a bench; uniform meshes dashed, adaptive ones dotted. Beside other
// programs kerf is shown by its default family alone, unless that was not run. Designs more than 1.25 times the best
// are left out of their curves.

#include "bench/command/plots.hpp"

#include "plot/bars.hpp"
#include "plot/chart.hpp"
#include "plot/gallery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace kerf {

namespace {

using Coordinates = std::function<Vec2(const StateMeasurement&)>;

/// One style per element and degree, dashed on uniform meshes, dotted on adaptive ones.
std::vector<Series> series_of_sequences(const StateBench& bench, const std::string& problem, double poisson,
                                        const Coordinates& at) {
  std::vector<std::string> elements;
  std::vector<Series> all;
  for (const StateMeasurement& m : bench.runs) {
    const std::string element = fmt::format("{} {}", m.element, m.degree);
    const auto place = std::find(elements.begin(), elements.end(), element);
    const std::size_t style = static_cast<std::size_t>(place - elements.begin());
    if (place == elements.end()) elements.push_back(element);
    if (m.problem != problem || m.poisson != poisson) continue;
    const std::string name = sequence_name(m);
    auto series = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == name; });
    if (series == all.end())
      series = all.insert(all.end(), {name, {}, m.mesh == "uniform", m.mesh == "adaptive", style});
    series->points.push_back(at(m));
  }
  return all;
}

Vec2 time_and_error(const StateMeasurement& m) {
  return {m.seconds.work(), m.error.stress};
}

constexpr const char* work_label = "processor seconds: mesh, assembly, factorization, solution";
constexpr const char* stress_label = "relative L2 error of the stress";

Chart chart_of(const std::string& problem, double poisson) {
  Chart chart;
  for (const ProblemKind& kind : problem_kinds())
    if (kind.name == problem) chart.title = kind.title;
  chart.subtitle = fmt::format("Poisson's ratio {:.6g}; one thread", poisson);
  return chart;
}

void draw_contact(const std::filesystem::path& folder, const StateBench& bench, const std::string& problem,
                  double poisson) {
  const std::string tag = problem_tag(problem, poisson);
  const auto one = [&](const std::string& name, const std::string& x, const std::string& y, std::vector<Slope> slopes,
                       const Coordinates& at) {
    Chart chart = chart_of(problem, poisson);
    chart.x_label = x;
    chart.y_label = y;
    chart.slopes = std::move(slopes);
    chart.series = series_of_sequences(bench, problem, poisson, at);
    draw(folder / fmt::format("{}_{}.png", name, tag), chart);
  };
  const auto unknowns = [](const StateMeasurement& m) { return static_cast<double>(m.unknowns); };
  const std::vector<Slope> by_step{{0.5, "slope 1/2"}, {1, "slope 1"}, {2, "slope 2"}};
  const std::vector<Slope> by_count{{-0.5, "slope −1/2"}, {-1, "slope −1"}, {-2, "slope −2"}};
  one("stress_step", "mesh step h (longest edge)", stress_label, by_step,
      [](const StateMeasurement& m) { return Vec2(m.h, m.error.stress); });
  one("displacement_unknowns", "number of unknowns N", "relative L2 error of the displacement u*", by_count,
      [&](const StateMeasurement& m) { return Vec2(unknowns(m), m.error.displacement); });
  one("stress_unknowns", "number of unknowns N", stress_label, by_count,
      [&](const StateMeasurement& m) { return Vec2(unknowns(m), m.error.stress); });
}

void draw_peers(const std::filesystem::path& folder, const StateBench& bench, const std::string& problem,
                double poisson) {
  std::vector<Series> peers;
  for (const PeerRun& p : bench.peers) {
    if (p.problem != problem || p.poisson != poisson) continue;
    auto series = std::find_if(peers.begin(), peers.end(), [&](const Series& s) { return s.name == p.name; });
    if (series == peers.end()) series = peers.insert(peers.end(), {p.name, {}, true, 0});
    series->points.push_back({p.work, p.error});
  }
  if (peers.empty()) return;
  Chart chart = chart_of(problem, poisson);
  chart.x_label = "processor seconds: mesh, assembly, solution, stress";
  chart.y_label = stress_label;
  chart.series = series_of_sequences(bench, problem, poisson, time_and_error);
  // kerf's uniform sequences are in a picture of their own, unless there are no others.
  if (std::any_of(chart.series.begin(), chart.series.end(), [](const Series& s) { return !s.dashed; }))
    std::erase_if(chart.series, [](const Series& s) { return s.dashed; });
  // Beside other programs the default family stands for kerf.
  const auto of_bdms = [](const Series& s) { return s.name.starts_with("bdms "); };
  if (std::any_of(chart.series.begin(), chart.series.end(), of_bdms))
    std::erase_if(chart.series, [&](const Series& s) { return !of_bdms(s); });
  std::size_t style = 0;
  for (Series& s : chart.series) {
    s.name = "kerf " + s.name;
    s.dashed = false;
    style = std::max(style, s.style + 1);
  }
  for (Series& p : peers) {
    p.style = style++;
    std::stable_sort(p.points.begin(), p.points.end(), [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
    chart.series.push_back(std::move(p));
  }
  draw(folder / fmt::format("peers_{}.png", problem_tag(problem, poisson)), chart);
}

}  // namespace

void draw_state_plots(const std::filesystem::path& folder, const StateBench& bench) {
  std::set<std::pair<std::string, double>> drawn;
  for (const StateMeasurement& m : bench.runs) {
    if (!drawn.insert({m.problem, m.poisson}).second) continue;
    Chart chart = chart_of(m.problem, m.poisson);
    chart.x_label = work_label;
    chart.y_label = stress_label;
    chart.slopes = {{-0.5, "slope −1/2"}, {-1, "slope −1"}, {-2, "slope −2"}};
    chart.series = series_of_sequences(bench, m.problem, m.poisson, time_and_error);
    draw(folder / fmt::format("error_time_{}.png", problem_tag(m.problem, m.poisson)), chart);
    if (m.problem == "closing-crack") draw_contact(folder, bench, m.problem, m.poisson);
    draw_peers(folder, bench, m.problem, m.poisson);
  }
}

void draw_map_plots(const std::filesystem::path& folder, const MapBench& bench) {
  for (const ProblemKind& kind : map_problem_kinds())
    for (const double poisson : kind.poisson) {
      Chart chart{.title = "Map, " + kind.title,
                  .subtitle = fmt::format("Poisson's ratio {:.6g}; one thread", poisson),
                  .x_label = "processor seconds: state and evaluation of the map",
                  .y_label = "relative L1 error of the map",
                  .slopes = {{-1, "slope −1"}, {-2, "slope −2"}}};
      const auto add = [&](const std::string& name, bool other, const Vec2& at) {
        auto series =
            std::find_if(chart.series.begin(), chart.series.end(), [&](const Series& s) { return s.name == name; });
        if (series == chart.series.end())
          series = chart.series.insert(chart.series.end(), {name, {}, other, false, chart.series.size()});
        series->points.push_back(at);
      };
      for (const MapMeasurement& m : bench.sequences)
        if (m.problem == kind.name && m.poisson == poisson) add("kerf " + sequence_name(m), false, {m.work(), m.error});
      if (chart.series.empty()) continue;
      for (const PeerRun& p : bench.peers)
        if (p.problem == kind.name && p.poisson == poisson && p.error > 0) add(p.name, true, {p.work, p.error});
      for (Series& s : chart.series)
        std::stable_sort(s.points.begin(), s.points.end(), [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
      draw(folder / fmt::format("map_error_time_{}.png", problem_tag(kind.name, poisson)), chart);
    }
}

namespace {

constexpr double shown = 1.25;  // of the best: what lies above is left out of the picture

Polyline corners(const Loop& loop) {
  return flatten(loop, 1e-3, 1).points;
}

double width(const Loop& outline) {
  double low = infinity, high = -infinity;
  for (const Side& side : outline.sides) {
    low = std::min(low, side.start.x());
    high = std::max(high, side.start.x());
  }
  return high - low;
}

/// Sides of the frame with one of these labels.
std::vector<Polyline> sides_with(const Loop& outline, const std::vector<Index>& labels) {
  std::vector<Polyline> all;
  for (std::size_t i = 0; i < outline.sides.size(); ++i)
    if (std::find(labels.begin(), labels.end(), outline.sides[i].label) != labels.end())
      all.push_back({outline.sides[i].start, outline.sides[(i + 1) % outline.sides.size()].start});
  return all;
}

GalleryPanel panel_of(const OptimizeProblem& p, const DesignRun& run) {
  GalleryPanel panel{.title = run_name(run),
                     .caption = fmt::format("{:.5g}; {} solves, {:.1f} s", run.value, run.state_solves, run.seconds),
                     .body = {corners(run.shape.outline)},
                     .frame = {corners(p.problem.frame.outline)},
                     .accent = run.own};
  for (const Loop& hole : run.shape.holes) panel.body.push_back(corners(hole));
  std::vector<Index> held;
  for (const Support& s : p.problem.scene.supports) held.push_back(s.label);
  panel.supports = sides_with(p.problem.frame.outline, held);
  panel.loads = sides_with(p.problem.frame.outline, loaded_labels(p));
  return panel;
}

}  // namespace

void draw_optimize_plots(const std::filesystem::path& folder, const OptimizeBench& bench) {
  Gallery gallery{.title = "Designs of each scenario",
                  .subtitle = "J on a fine body-fitted mesh, the same way for every program; processor seconds"};
  BarChart bars{.title = "J above the best design of each scenario",
                .subtitle = "all designs at the same volume, on fine body-fitted meshes",
                .x_label = "per cent above the best"};
  for (const OptimizeProblem& p : bench.problems) {
    double best = 0;
    for (const DesignRun& run : bench.runs)
      if (run.problem == p.name && (best == 0 || run.value < best)) best = run.value;
    if (!(best > 0)) continue;
    Chart chart{.title = p.title,
                .subtitle = "designs judged on body-fitted meshes; one thread",
                .x_label = "processor seconds",
                .y_label = is_volume(p) ? "volume fraction" : "compliance",
                .linear_y = true};
    GalleryRow row{.title = p.title, .scale = 2 / width(p.problem.frame.outline)};
    BarGroup group{.title = p.title};
    std::size_t style = 0;
    for (const DesignRun& run : bench.runs) {
      if (run.problem != p.name) continue;
      Series series{.name = run_name(run), .dashed = !run.own, .style = style++, .marked_at_end = true};
      for (const DesignPoint& at : run.curve)
        if (at.value <= shown * best) series.points.emplace_back(at.seconds, at.value);
      chart.series.push_back(std::move(series));
      row.panels.push_back(panel_of(p, run));
      const double above = 100 * (run.value / best - 1);
      group.bars.push_back({.name = run_name(run),
                            .value = above,
                            .text = fmt::format("{:.5g} (+{:.2f} %)", run.value, above),
                            .style = run.own ? 0u : 2u});
    }
    draw(folder / fmt::format("optimize_{}.png", p.name), chart);
    gallery.rows.push_back(std::move(row));
    bars.groups.push_back(std::move(group));
  }
  if (gallery.rows.empty()) return;
  draw(folder / "optimize_designs.png", gallery);
  draw(folder / "optimize_compliance.png", bars);
}

}  // namespace kerf
