#include "bench/optimize.hpp"

#include "bench/measure.hpp"
#include "bench/optimize_peers.hpp"
#include "bench/plots.hpp"
#include "bench/records.hpp"
#include "kerf/optimize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Lengths of the judge's meshes, and triangles of the last one.
constexpr double fine_background = 0.005, background = 0.01, fine = 0.02, medium = 0.015;
constexpr Index fine_triangles = 100000;
constexpr std::size_t most_points = 60;  // of a curve that are judged
constexpr double near = 0.01;            // of the last compliance
constexpr double at_volume = 0.005;      // relative: designs on their way to the volume are no part of a curve

/// All when there are few; otherwise evenly spaced, the first few and the last among them.
std::vector<std::size_t> chosen(std::size_t count) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < count; ++i)
    if (count <= most_points || i < 10 || i + 1 == count ||
        i * (most_points - 10) / count != (i - 1) * (most_points - 10) / count)
      all.push_back(i);
  return all;
}

DesignPoint first_near(const std::vector<DesignPoint>& curve, double last) {
  DesignPoint best{.seconds = nan, .compliance = nan};
  for (auto p = curve.rbegin(); p != curve.rend(); ++p) {
    if (!(std::abs(p->compliance - last) <= near * last)) break;
    best = *p;
  }
  return best;
}

/// A shape on the way of kerf's own loop.
struct Passed {
  Iteration row;
  double seconds;
  Shape shape;
};

class Runner {
 public:
  Runner(const BenchOptions& options, OptimizeBench& bench) : options_(options), bench_(bench) {}

  bool stopped() const {
    return stop_asked(options_);
  }

  void own_runs() {
    for (const OptimizeProblem& p : optimize_problems())
      for (const std::string& start : optimize_starts()) {
        if (!is_wanted(options_.cases, p.name) || stopped() || (options_.quick && start != "holes")) continue;
        attempt(fmt::format("{} from {}", p.name, start), [&] { own_run(p, start); });
      }
  }

  void peers() {
    if (options_.peers.empty() || stopped()) return;
    DesignPeers all = run_design_peers({.scripts = options_.peers,
                                        .work = options_.folder / "peers",
                                        .seconds = options_.peer_seconds,
                                        .quick = options_.quick,
                                        .problems = options_.cases,
                                        .stop_asked = options_.stop_asked,
                                        .on_phase = options_.on_phase});
    bench_.notes.insert(bench_.notes.end(), all.notes.begin(), all.notes.end());
    const auto program = [](const DesignPeer& peer) { return peer.name.substr(0, peer.name.find(',')); };
    std::ranges::stable_sort(all.runs, {}, program);
    for (const OptimizeProblem& p : optimize_problems()) {
      std::optional<Mesh> coarse, finer;
      for (const DesignPeer& peer : all.runs) {
        if (peer.problem != p.name || stopped()) continue;
        attempt(fmt::format("judge {}: {}", p.name, peer.name), [&] {
          if (!coarse) {
            const double size = p.length * (options_.quick ? 2 * background : background);
            coarse = triangulate(p.problem.frame, {.size = size});
            finer = options_.quick ? coarse : triangulate(p.problem.frame, {.size = p.length * fine_background});
          }
          judge_peer(p, peer, *coarse, *finer);
        });
      }
    }
  }

  void published() {
    if (!is_wanted(options_.cases, "published")) return;
    const OptimizeProblem& p = published_problem();
    OptimizeProblem fitted = p;
    fitted.ersatz = 0;
    const std::vector<std::string> starts = options_.quick ? std::vector<std::string>{"full"} : optimize_starts();
    const auto run = [&](const OptimizeProblem& problem, const std::string& method) {
      for (const std::string& start : starts) {
        if (stopped()) return;
        attempt(fmt::format("published: {} from {}", method, start), [&] { published_run(problem, method, start); });
      }
    };
    run(p, "fixed point, weak phase 1e-3");
    if (!options_.quick) run(fitted, "shape gradient, body-fitted");
  }

  void remeshing() {
    if (!is_wanted(options_.cases, "remesh") || stopped()) return;
    attempt("remeshing",
            [&] { bench_.remeshing = options_.quick ? measure_remeshing(0.03, 2) : measure_remeshing(0.0105, 8); });
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
    } catch (const std::exception& e) {
      bench_.notes.push_back(fmt::format("{}: {}", name, e.what()));
    }
  }

  OptimizeRequest request(const OptimizeProblem& p, const std::string& start) const {
    OptimizeRequest r = level_set_request(p, start);
    if (options_.quick) r.max_iterations = 30;
    return r;
  }

  Problem sized(const OptimizeProblem& p) const {
    Problem sized = p.problem;
    if (options_.quick) sized.sizing.size *= 2;
    return sized;
  }

  Judged judge_medium(const OptimizeProblem& p, const Shape& shape) const {
    return judge(p, shape, p.length * (options_.quick ? 2 * medium : medium), 0);
  }
  Judged judge_last(const OptimizeProblem& p, const Shape& shape) const {
    return judge(p, shape, p.length * (options_.quick ? 2 * fine : fine), options_.quick ? 5000 : fine_triangles);
  }

  void finish(const OptimizeProblem& p, DesignRun& run) {
    run.last = judge_last(p, run.shape);
    if (!run.curve.empty()) run.near = first_near(run.curve, run.curve.back().compliance);
    bench_.runs.push_back(std::move(run));
  }

  void own_run(const OptimizeProblem& p, const std::string& start) {
    std::vector<Passed> seen;
    ProcessorWatch watch;
    double spent = 0;
    const OptimizeResult result = optimize_level_set(sized(p), request(p, start),
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
                  .start = start,
                  .iterations = result.iterations,
                  .state_solves = result.state_solves,
                  .seconds = spent,
                  .own_compliance = result.objective,
                  .stopped = result.stopped,
                  .shape = result.shape};
    std::erase_if(seen, [&](const Passed& s) { return std::abs(s.row.volume_fraction / p.volume - 1) > at_volume; });
    for (const std::size_t i : chosen(seen.size())) {
      const Judged j = judge_medium(p, seen[i].shape);
      run.curve.push_back({seen[i].row.number, seen[i].row.state_solves, seen[i].seconds, j.compliance, j.volume});
    }
    finish(p, run);
  }

  void judge_peer(const OptimizeProblem& p, const DesignPeer& peer, const Mesh& coarse, const Mesh& finer) {
    const PeerSnapshot& last = peer.snapshots.back();
    DesignRun run{.problem = p.name,
                  .tool = peer.name,
                  .own = false,
                  .iterations = last.iteration,
                  .state_solves = last.state_solves,
                  .seconds = last.seconds,
                  .own_compliance = last.objective,
                  .shape = shape_of(p, last.field, finer)};
    for (const std::size_t i : chosen(peer.snapshots.size())) {
      if (stopped()) break;
      const PeerSnapshot& s = peer.snapshots[i];
      try {
        const Judged j = judge_medium(p, shape_of(p, s.field, coarse));
        run.curve.push_back({s.iteration, s.state_solves, s.seconds, j.compliance, j.volume});
      } catch (const Error&) {  // no body yet
      }
    }
    finish(p, run);
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
                     .objective = result.objective + p.volume_penalty * result.volume_fraction * whole,
                     .compliance = result.objective,
                     .volume = result.volume_fraction,
                     .judged = nan,
                     .stopped = result.stopped};
    if (p.ersatz == 0) {
      const Judged j = judge_last(p, result.shape);
      run.judged = j.compliance + p.volume_penalty * j.volume * whole;
    }
    bench_.published.push_back(std::move(run));
  }

  const BenchOptions& options_;
  OptimizeBench& bench_;
};

const DesignRun* best_peer(const OptimizeBench& bench, const std::string& problem) {
  const DesignRun* best = nullptr;
  for (const DesignRun& r : bench.runs)
    if (!r.own && r.problem == problem && (!best || r.last.compliance < best->last.compliance)) best = &r;
  return best;
}

}  // namespace

OptimizeBench run_optimize_bench(const BenchOptions& options) {
  if (!options.peers.empty()) require_design_scripts(options.peers);
  make_folder(options.folder);
  OptimizeBench bench;
  Runner runner(options, bench);
  runner.own_runs();
  runner.peers();
  runner.published();
  runner.remeshing();
  runner.random_designs();
  bench.stopped = runner.stopped();
  write_optimize_csv(options.folder / "optimize.csv", bench);
  write_optimize_curves_csv(options.folder / "optimize_curves.csv", bench);
  draw_optimize_plots(options.folder, bench);
  write_optimize_json(options.folder / "optimize.json", bench);
  return bench;
}

std::string run_name(const DesignRun& run) {
  if (!run.own) return run.tool;
  return run.start == "full"    ? "kerf, from the full body"
         : run.start == "holes" ? "kerf, from regular holes"
                                : "kerf, from random holes";
}

std::string summary(const OptimizeBench& bench) {
  std::string out;
  if (!bench.runs.empty())
    out += fmt::format(
        "Final compliances on fine body-fitted meshes; processor "
        "seconds:\n{:<12}{:<44}{:>11}{:>9}{:>7}{:>8}{:>9}{:>16}{:>9}\n",
        "case", "program", "compliance", "volume", "its", "solves", "seconds", "within 1 %:", "seconds");
  for (const DesignRun& r : bench.runs) {
    out += fmt::format("{:<12}{:<44}{:>11.3f}{:>9.5f}{:>7}{:>8}{:>9.1f}{:>9} solves{:>9.1f}", r.problem, run_name(r),
                       r.last.compliance, r.last.volume, r.iterations, r.state_solves, r.seconds, r.near.state_solves,
                       r.near.seconds);
    const DesignRun* peer = r.own ? best_peer(bench, r.problem) : nullptr;
    if (peer)
      out += fmt::format("  {:+.2f} % against {}", 100 * (r.last.compliance / peer->last.compliance - 1), peer->tool);
    out += '\n';
  }
  if (!bench.published.empty())
    out += fmt::format("Compliance + 100 area, published {:.2f} to {:.2f} with {} to {} solves:\n",
                       published.least_value, published.most_value, published.fewest_solves, published.most_solves);
  for (const PublishedRun& r : bench.published)
    out += fmt::format("{:<34}{:<10}J {:.2f} ({}), {} solves, {:.1f} s\n", r.method, r.start, r.objective,
                       std::isfinite(r.judged) ? fmt::format("{:.2f} on a fine mesh", r.judged) : "weak phase",
                       r.state_solves, r.seconds);
  if (bench.remeshing)
    out +=
        fmt::format("remeshing: {:.1f} % of an iteration at {} triangles (carve {:.3f} s, mesh {:.3f} s of {:.3f} s)\n",
                    100 * bench.remeshing->share(), bench.remeshing->triangles, bench.remeshing->carve_s,
                    bench.remeshing->mesh_s, bench.remeshing->iteration_s);
  if (bench.random)
    out += fmt::format("random designs: {} of {} meshed, {} refused with a named reason, {} failed; slowest {:.2g} s\n",
                       bench.random->meshed, bench.random->count, bench.random->refused, bench.random->failures.size(),
                       bench.random->slowest);
  for (const std::string& note : bench.notes) out += "note: " + note + '\n';
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

std::vector<std::string> optimize_case_names() {
  std::vector<std::string> names;
  for (const OptimizeProblem& p : optimize_problems()) names.push_back(p.name);
  for (const char* name : {"published", "remesh", "random"}) names.emplace_back(name);
  return names;
}

}  // namespace kerf
