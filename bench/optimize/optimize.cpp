// `kerf bench optimize`: designs with default settings beside those of other programs, by one judge (judge.cpp). For
// each scenario: kerf's run from the full body, runs of SIMP and of a level set by FreeFem++ where they are installed,
// a point per judged iterate, and for each own run its certificate. A scenario whose volume is minimized under a bound
// on the compliance is compared with densities at the volume at which they would have that compliance, by the slope of
// log volume against log compliance of two runs. Beside these, where asked for: the spread over starts, sizes and
// budgets, a problem with published values, the share of remeshing in an iteration, and meshes of random designs. What
// one run cannot do is a note and does not end the others. docs/history/benchmarks.md has the results.

#include "bench/optimize/optimize.hpp"

#include "bench/command/plots.hpp"
#include "bench/command/records.hpp"
#include "bench/measure/measure.hpp"
#include "bench/optimize/optimize_peers.hpp"
#include "kerf/optimize.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Sizes of the judge's meshes relative to that of the case, and triangles of the last one.
constexpr double fine_background = 1.0 / 6, background = 1.0 / 3, fine = 2.0 / 3, medium = 0.5;
constexpr Index fine_triangles = 100000;
constexpr std::size_t own_points = 60, peer_points = 16, quick_points = 8;  // of a curve that are judged
constexpr const char* spread_name = "spread";
constexpr double near = 0.01;        // of the last value
constexpr double at_volume = 0.005;  // relative: designs on their way to the volume are no part of a curve

/// All when there are few; otherwise evenly spaced, the last among them.
std::vector<std::size_t> chosen(std::size_t count, std::size_t most) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < count; ++i)
    if (count <= most || (i + 1) * most / count != i * most / count) all.push_back(i);
  return all;
}

DesignPoint first_near(const std::vector<DesignPoint>& curve, double last) {
  DesignPoint best{.seconds = nan, .value = nan};
  for (auto p = curve.rbegin(); p != curve.rend(); ++p) {
    if (!(std::abs(p->value - last) <= near * last)) break;
    best = *p;
  }
  return best;
}

/// Those named, or all where the spread is asked for and no scenario is named.
std::vector<std::string> wanted_scenarios(const std::vector<std::string>& cases) {
  std::vector<std::string> named;
  for (const std::string& name : scenario_names())
    if (is_wanted(cases, name)) named.push_back(name);
  const bool spread = std::ranges::find(cases, spread_name) != cases.end();
  return named.empty() && spread ? scenario_names() : named;
}

/// A shape on the way of kerf's own loop.
struct Passed {
  Iteration row;
  double seconds;
  Shape shape;
};

class OptimizeRunner {
 public:
  OptimizeRunner(const BenchOptions& options, OptimizeBench& bench)
      : options_(options), bench_(bench), cases_(options.folder / "cases") {
    make_folder(cases_);
    for (const std::string& name : wanted_scenarios(options.cases))
      bench_.problems.push_back(read_problem(name, cases_));
  }

  bool stopped() const {
    return stop_asked(options_);
  }

  void own_runs() {
    for (const OptimizeProblem& p : bench_.problems) {
      if (stopped()) return;
      attempt(p.name, [&] { own_run(p, ""); });
      if (!p.problem.scene.body || options_.quick || stopped()) continue;
      OptimizeProblem half = p;  // with weight, less must not be better
      *half.request.volume_at_most /= 2;
      const std::string variant = fmt::format("at most {}", *half.request.volume_at_most);
      attempt(fmt::format("{}, {}", p.name, variant), [&] { own_run(half, variant); });
    }
  }

  void peers() {
    if (stopped() || bench_.problems.empty()) return;
    DesignPeers all = run_design_peers(bench_.problems, peer_options());
    bench_.notes.insert(bench_.notes.end(), all.notes.begin(), all.notes.end());
    const auto program = [](const DesignPeer& peer) { return peer.name.substr(0, peer.name.find(',')); };
    std::ranges::stable_sort(all.runs, {}, program);
    for (const OptimizeProblem& p : bench_.problems) {
      std::optional<Mesh> coarse, finer;
      for (const DesignPeer& peer : all.runs) {
        if (peer.problem != p.name || stopped()) continue;
        attempt(fmt::format("judge {}: {}", p.name, peer.name), [&] {
          if (!coarse) {
            coarse = triangulate(p.problem.frame, {.size = judge_size(p, background)});
            finer = options_.quick ? coarse : triangulate(p.problem.frame, {.size = judge_size(p, fine_background)});
          }
          judge_peer(p, peer, *coarse, *finer);
        });
      }
    }
  }

  /// A density holds no bound on its compliance: the volume at which it has that one, from two volumes near by.
  void volume_peers() {
    for (const OptimizeProblem& p : bench_.problems) {
      const auto own = std::ranges::find(bench_.runs, p.name, &DesignRun::problem);
      if (!is_volume(p) || !is_judged(p) || p.request.bounds.size() != 1 || own == bench_.runs.end()) continue;
      const double bound = p.request.bounds.front().at_most, volume = own->value;
      for (const int cells : options_.quick ? std::vector{20} : std::vector{usual_cells, 2 * usual_cells}) {
        if (stopped()) return;
        attempt(fmt::format("{}: {}", p.name, simp_name(cells)), [&] { volume_peer(p, cells, volume, bound); });
      }
    }
  }

  void spreads() {
    if (std::ranges::find(options_.cases, spread_name) == options_.cases.end()) return;
    for (const OptimizeProblem& p : bench_.problems) {
      if (stopped()) return;
      attempt(fmt::format("spread of {}", p.name), [&] {
        bench_.spreads.push_back(measure_spread(
            p, options_.quick, [this](const OptimizeProblem& q, const OptimizeResult& r) { return spread_value(q, r); },
            [this](const std::string& phase) {
              if (options_.on_phase) options_.on_phase(phase);
              return !stopped();
            }));
        const auto& failures = bench_.spreads.back().failures;
        bench_.notes.insert(bench_.notes.end(), failures.begin(), failures.end());
      });
    }
  }

  void published() {
    if (!is_wanted(options_.cases, published_name)) return;
    const OptimizeProblem weak = read_problem(published_name, cases_);
    OptimizeProblem fitted = weak;
    fitted.request.level_set.ersatz = 0;
    fitted.request.level_set.move = LevelSetRequest::Move::ShapeGradient;
    const auto run = [&](const OptimizeProblem& problem, const std::string& method) {
      for (const char* start : {"full", "holes", "random 1"}) {
        if (stopped() || (options_.quick && start != std::string_view("full"))) return;
        attempt(fmt::format("published: {} from {}", method, start), [&] { published_run(problem, method, start); });
      }
    };
    run(weak, "fixed point, weak phase 1e-3");
    if (!options_.quick) run(fitted, "shape gradient, body-fitted");
  }

  void remeshing() {
    if (!is_wanted(options_.cases, "remesh") || stopped()) return;
    attempt("remeshing", [&] {
      const OptimizeProblem p = read_problem("cantilever", cases_);
      bench_.remeshing = options_.quick ? measure_remeshing(p, 0.03, 2) : measure_remeshing(p, 0.0105, 8);
    });
  }

  void random_designs() {
    if (!is_wanted(options_.cases, "random") || stopped()) return;
    attempt("random designs", [&] {
      bench_.random = try_random_designs(options_.quick ? 10 : 200, options_.stop_asked);
      for (const std::string& f : bench_.random->failures) bench_.notes.push_back(f);
    });
  }

 private:
  /// What one run cannot do does not end the others.
  void attempt(const std::string& name, const std::function<void()>& work) {
    if (options_.on_phase) options_.on_phase(name);
    try {
      work();
    } catch (const Stopped&) {  // the rest sees it, too
    } catch (const std::exception& e) {
      bench_.notes.push_back(fmt::format("{}: {}", name, e.what()));
    }
  }

  DesignPeerOptions peer_options() const {
    return {.scripts = options_.peers,
            .work = options_.folder / "peers",
            .seconds = options_.peer_seconds,
            .quick = options_.quick,
            .stop_asked = options_.stop_asked,
            .on_phase = options_.on_phase};
  }

  OptimizeRequest request(const OptimizeProblem& p, const std::string& start) const {
    OptimizeRequest r = request_from(p, start);
    if (options_.quick) r.max_iterations = 30;
    return r;
  }

  Problem sized(const OptimizeProblem& p) const {
    Problem sized = p.problem;
    if (options_.quick) sized.sizing.size *= 2;
    return sized;
  }

  double judge_size(const OptimizeProblem& p, double relative) const {
    return p.problem.sizing.size * relative * (options_.quick ? 2 : 1);
  }
  Judged judge_medium(const OptimizeProblem& p, const Shape& shape) const {
    return judge(p, shape, {judge_size(p, medium), 0});
  }
  Judged judge_last(const OptimizeProblem& p, const Shape& shape) const {
    return judge(p, shape, {judge_size(p, fine), options_.quick ? 5000 : fine_triangles});
  }

  std::pair<double, double> spread_value(const OptimizeProblem& p, const OptimizeResult& r) const {
    if (!is_judged(p)) return {r.finer.objective, r.volume_fraction};
    const Judged j = judge(p, r.shape, {judge_size(p, medium), options_.quick ? 2000 : fine_triangles / 5});
    return {is_volume(p) ? j.volume : j.compliance, j.volume};
  }

  void finish(const OptimizeProblem& p, DesignRun& run) {
    if (is_judged(p)) {
      run.last = judge_last(p, run.shape);
      run.value = is_volume(p) ? run.last.volume : run.last.compliance;
    } else {
      run.value = run.verdict.finer;
    }
    if (!run.curve.empty()) run.near = first_near(run.curve, run.curve.back().value);
    bench_.runs.push_back(std::move(run));
  }

  /// A compliance is judged at its volume; anything else is what the loop saw of designs that hold their bounds.
  std::vector<DesignPoint> curve_of(const OptimizeProblem& p, std::vector<Passed> seen) const {
    std::vector<DesignPoint> curve;
    std::erase_if(seen, [](const Passed& s) { return !(s.row.violation <= at_volume); });
    if (!is_judged(p) || is_volume(p)) {
      for (const Passed& s : seen)
        curve.push_back({s.row.number, s.row.state_solves, s.seconds,
                         is_volume(p) ? s.row.volume_fraction : s.row.objective, s.row.volume_fraction});
      return curve;
    }
    for (const std::size_t i : chosen(seen.size(), options_.quick ? quick_points : own_points)) {
      const Judged j = judge_medium(p, seen[i].shape);
      curve.push_back({seen[i].row.number, seen[i].row.state_solves, seen[i].seconds, j.compliance, j.volume});
    }
    return curve;
  }

  void own_run(const OptimizeProblem& p, const std::string& variant) {
    std::vector<Passed> seen;
    ProcessorWatch watch;
    double spent = 0;
    const OptimizeResult result = optimize_level_set(sized(p), request(p, "full"),
                                                     [&](const Iterate& at) {
                                                       spent += watch.lap();
                                                       seen.push_back({at.row, spent, at.shape});
                                                       watch.lap();
                                                       return !stopped();
                                                     },
                                                     {});
    spent += watch.lap();
    DesignRun run{.problem = p.name,
                  .tool = "kerf",
                  .variant = variant,
                  .iterations = result.iterations,
                  .state_solves = result.state_solves,
                  .seconds = spent,
                  .own_value = is_volume(p) ? result.volume_fraction : result.objective,
                  .stopped = result.stopped,
                  .shape = result.shape,
                  .verdict = {.ending = result.ending,
                              .residual = result.optimality,
                              .margin = result.holes.least,
                              .finer = result.finer.objective,
                              .change = result.finer.objective / result.objective - 1,
                              .feasible = result.feasible}};
    run.curve = curve_of(p, std::move(seen));
    finish(p, run);
  }

  void judge_peer(const OptimizeProblem& p, const DesignPeer& peer, const Mesh& coarse, const Mesh& finer) {
    const PeerSnapshot& last = peer.snapshots.back();
    DesignRun run{.problem = p.name,
                  .tool = peer.name,
                  .own = false,
                  .strong = peer.strong,
                  .iterations = last.iteration,
                  .state_solves = last.state_solves,
                  .seconds = last.seconds,
                  .own_value = last.objective,
                  .shape = shape_of(p, peer.volume, last.field, finer)};
    for (const std::size_t i : chosen(peer.snapshots.size(), options_.quick ? quick_points : peer_points)) {
      if (stopped()) break;
      const PeerSnapshot& s = peer.snapshots[i];
      try {
        const Judged j = judge_medium(p, shape_of(p, peer.volume, s.field, coarse));
        run.curve.push_back({s.iteration, s.state_solves, s.seconds, j.compliance, j.volume});
      } catch (const Error&) {  // no body yet
      }
    }
    finish(p, run);
  }

  void volume_peer(const OptimizeProblem& p, int cells, double volume, double bound) {
    const Mesh finer = triangulate(p.problem.frame, {.size = judge_size(p, fine_background)});
    const auto at = [&](double v) {
      const DesignPeers found = run_simp(p, v, cells, peer_options());
      if (found.runs.empty()) throw Error(Fault::Numerics, found.notes.empty() ? "no numpy" : found.notes.front());
      const PeerSnapshot& last = found.runs[0].snapshots.back();
      DesignRun run{.problem = p.name,
                    .tool = simp_name(cells),
                    .own = false,
                    .iterations = last.iteration,
                    .state_solves = last.state_solves,
                    .seconds = last.seconds,
                    .own_value = v,
                    .shape = shape_of(p, v, last.field, finer)};
      run.last = judge_last(p, run.shape);
      return run;
    };
    const DesignRun first = at(volume);
    DesignRun second = at(volume * first.last.compliance / bound);
    const double slope =
        std::log(second.last.volume / first.last.volume) / std::log(second.last.compliance / first.last.compliance);
    second.value = second.last.volume * std::pow(bound / second.last.compliance, slope);
    bench_.runs.push_back(std::move(second));
  }

  void published_run(const OptimizeProblem& p, const std::string& method, const std::string& start) {
    ProcessorWatch watch;
    double spent = 0;
    const OptimizeResult result = optimize_level_set(sized(p), request(p, start),
                                                     [&](const Iterate&) {
                                                       spent += watch.lap();
                                                       return !stopped();
                                                     },
                                                     {});
    spent += watch.lap();
    const double whole = frame_area(p);
    PublishedRun run{.method = method,
                     .start = start,
                     .iterations = result.iterations,
                     .state_solves = result.state_solves,
                     .seconds = spent,
                     .objective = result.objective + p.request.volume_penalty * result.volume_fraction * whole,
                     .compliance = result.objective,
                     .volume = result.volume_fraction,
                     .judged = nan,
                     .stopped = result.stopped};
    if (p.request.level_set.ersatz == 0) {
      const Judged j = judge_last(p, result.shape);
      run.judged = j.compliance + p.request.volume_penalty * j.volume * whole;
    }
    bench_.published.push_back(std::move(run));
  }

  const BenchOptions& options_;
  OptimizeBench& bench_;
  std::filesystem::path cases_;  // where the case files of the scenarios lie
};

}  // namespace

OptimizeBench run_optimize_bench(const BenchOptions& options) {
  if (!options.peers.empty()) require_design_scripts(options.peers);
  make_folder(options.folder);
  OptimizeBench bench;
  OptimizeRunner runner(options, bench);
  runner.own_runs();
  runner.peers();
  runner.volume_peers();
  runner.spreads();
  runner.published();
  runner.remeshing();
  runner.random_designs();
  bench.stopped = runner.stopped();
  write_optimize_csv(options.folder / "optimize.csv", bench);
  if (!bench.spreads.empty()) write_optimize_spread_csv(options.folder / "optimize_spread.csv", bench);
  write_optimize_curves_csv(options.folder / "optimize_curves.csv", bench);
  draw_optimize_plots(options.folder, bench);
  write_optimize_json(options.folder / "optimize.json", bench);
  return bench;
}

std::vector<std::string> optimize_case_names() {
  std::vector<std::string> names = scenario_names();
  for (const char* name : {published_name, "remesh", "random", spread_name}) names.emplace_back(name);
  return names;
}

}  // namespace kerf
