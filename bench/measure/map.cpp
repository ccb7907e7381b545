// `kerf bench map`: time, memory and error of a map (state, adjoint, evaluation) and of validations. Sequences against
// the exact map where the field is known, in relative L1 at the centroids, 0.1 and more from tips, where T is infinite;
// runs at 10,000, 100,000 and a million triangles with the share of each phase; validations of three functionals beside
// the state. A sequence ends at an error of 1e-5 or where the next level, at 2.3 times the last, would overrun its
// share. docs/history/benchmarks.md has the results.

#include "bench/measure/map.hpp"

#include "base/stopwatch.hpp"
#include "bench/command/plots.hpp"
#include "bench/command/records.hpp"
#include "bench/measure/state.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr const char* validation = "validation";
constexpr double least_map_error = 1e-5;    // no sequence goes beyond this error
constexpr double growth_of_map_time = 2.3;  // of the time from one level to the next

Grading grading_of(const BenchProblem& problem) {
  return problem.shape.cracks.empty() ? Grading::Uniform : Grading::Graded;
}

struct MapSequence {
  BenchProblem problem;
  const Element* element;
};

class MapRunner {
 public:
  MapRunner(const MapBenchOptions& options, MapBench& bench) : options_(options), bench_(bench) {}

  void sequences() {
    std::vector<MapSequence> all;
    for (const BenchProblem& p : problems())
      for (const Element& e : elements)
        if (p.exact && (options_.elements.empty() ? e.name == "bdms" : is_wanted(options_.elements, e.name)))
          all.push_back({p, &e});
    Stopwatch watch;
    double spent = 0;
    for (std::size_t i = 0; i < all.size() && !stopped(); ++i) {
      // What one sequence leaves of its share goes to those after it.
      sequence(all[i], (options_.seconds - spent) / static_cast<double>(all.size() - i));
      spent += watch.lap();
    }
  }

  void sizes() {
    std::vector<Index> counts{10000, 100000};
    if (options_.quick) counts = {1000};
    if (options_.large) counts.push_back(1000000);
    for (const BenchProblem& p : problems())
      for (const Index count : counts) {
        if (stopped()) return;
        // A million triangles once: the first and last Poisson's ratio differ by refinement steps alone.
        if (count > 500000 && p.poisson != 0.3) continue;
        attempt(fmt::format("{}, {} triangles", tag(p), count), [&] {
          const double level = level_of(p, grading_of(p), 1, count);
          bench_.sizes.push_back(
              measure_map(p, element("bdms"), grading_of(p), level, options_.quick || count > 500000 ? 1 : 3));
        });
      }
  }

  void validations() {
    if (stopped() || !is_wanted(options_.cases, validation)) return;
    attempt("validations", [&] {
      bench_.validations = options_.quick ? measure_validations(1000, 1, 2, 1) : measure_validations(100000);
    });
  }

  bool stopped() const {
    return stop_asked(options_);
  }

 private:
  static std::string tag(const BenchProblem& p) {
    return problem_tag(p.name, p.poisson);
  }

  std::vector<BenchProblem> problems() const {
    std::vector<BenchProblem> all;
    for (const ProblemKind& kind : map_problem_kinds())
      for (const double poisson : kind.poisson)
        if (is_wanted(options_.cases, kind.name) && !(options_.quick && poisson != kind.poisson.front()))
          all.push_back(map_problem(kind.name, poisson));
    return all;
  }

  /// What an element or the memory cannot do does not end the others.
  bool attempt(const std::string& name, const std::function<void()>& work) {
    if (options_.on_phase) options_.on_phase(name);
    try {
      work();
      return true;
    } catch (const Stopped&) {
      return false;
    } catch (const std::exception& e) {
      bench_.notes.push_back(fmt::format("{}: {}", name, e.what()));
      return false;
    }
  }

  void sequence(const MapSequence& s, double seconds) {
    const std::string name = fmt::format("{} {} {}", tag(s.problem), s.element->name, s.element->degree);
    double spent = 0, last = 0;
    for (int level = 0; level < (options_.quick ? 2 : 40) && !stopped() && spent + growth_of_map_time * last <= seconds;
         ++level) {
      Stopwatch watch;
      if (!attempt(fmt::format("{} level {}", name, level), [&] {
            bench_.sequences.push_back(
                measure_map(s.problem, *s.element, grading_of(s.problem), level, options_.quick ? 1 : 3));
          }))
        return;
      last = watch.lap();
      spent += last;
      if (bench_.sequences.back().error < least_map_error) return;
    }
  }

  const MapBenchOptions& options_;
  MapBench& bench_;
};

/// The other program's run on the same body with the nearest number of triangles.
const PeerRun* beside(const MapBench& bench, const MapMeasurement& m) {
  const PeerRun* best = nullptr;
  const auto away = [&](const PeerRun& p) {
    return std::abs(std::log(static_cast<double>(p.triangles) / static_cast<double>(m.triangles)));
  };
  for (const PeerRun& p : bench.peers)
    if (p.problem == m.problem && p.poisson == m.poisson && away(p) < 0.2 && (!best || away(p) < away(*best)))
      best = &p;
  return best;
}

std::string size_table(const MapBench& bench) {
  std::string out =
      "Processor seconds; evaluation: T of the energy (compliance) everywhere; adjoint, map*: of displacement "
      "tracking:\n";
  out += fmt::format("{:<27}{:>10}{:>8}{:>10}{:>8}{:>8}{:>12}{:>8}{:>9}{:>8}{:>8}{:>11}\n", "case", "triangles", "mesh",
                     "assemble", "factor", "solve", "evaluation", "share", "adjoint", "map*", "MB", "map error");
  for (const MapMeasurement& m : bench.sizes)
    out +=
        fmt::format("{:<27}{:>10}{:>8.2g}{:>10.2g}{:>8.2g}{:>8.2g}{:>12.2g}{:>7.1f}%{:>9.2g}{:>8.2g}{:>8.0f}{:>11}\n",
                    problem_tag(m.problem, m.poisson), m.triangles, m.state.mesh, m.state.assemble, m.state.factor,
                    m.state.solve, m.evaluate_s, 100 * m.evaluation_share(), m.adjoint_s, m.evaluate_dual_s,
                    m.memory_mb, std::isfinite(m.error) ? fmt::format("{:.1e}", m.error) : "-");
  for (const MapMeasurement& m : bench.sizes)
    if (const PeerRun* p = m.problem == "cantilever" ? beside(bench, m) : nullptr)
      out += fmt::format(
          "cantilever: {} maps {} triangles in {:.2g} s ({:.2g} s of them from the solution), kerf {} in {:.2g} s "
          "({:.2g}): {:.2g} times less; compliance {:.6g} and {:.6g}\n",
          p->name, p->triangles, p->work, p->post, m.triangles, m.work(), m.evaluate_s, p->work / m.work(), p->value,
          m.value);
  return out;
}

}  // namespace

MapBench run_map_bench(const MapBenchOptions& options) {
  if (!options.peers.empty()) require_scripts(options.peers, PeerTask::Map);
  make_folder(options.folder);
  MapBench bench;
  MapRunner runner(options, bench);
  runner.sequences();
  runner.sizes();
  runner.validations();
  add_peers(options, PeerTask::Map, bench);
  bench.stopped = runner.stopped();
  Sequences own;
  for (const auto* runs : {&bench.sequences, &bench.sizes})
    for (const MapMeasurement& m : *runs) own.add(m.problem, m.poisson, sequence_name(m), {m.error, m.work()});
  compare(own, map_errors_to_reach, bench);
  write_map_csv(options.folder / "map.csv", bench);
  write_validation_csv(options.folder / "validation.csv", bench);
  draw_map_plots(options.folder, bench);
  write_map_json(options.folder / "map.json", bench);
  return bench;
}

std::string summary(const MapBench& bench) {
  std::string out;
  if (!bench.best.empty()) {
    out += "Processor seconds (state and evaluation) to a relative L1 error of the map, 0.1 and more from the tips:\n";
    const bool peers = !bench.peers.empty();
    out += fmt::format("{:<27}{:>8}  {:<18}{:>14}{:>14}  {:<38}{:>8}\n", "case", "error", "kerf", "seconds",
                       peers ? "best peer" : "", "", peers ? "ratio" : "");
  }
  for (const Fastest& f : bench.best) {
    const Fastest* peer = find(bench.best_peers, f);
    out +=
        fmt::format("{:<27}{:>8.0e}  {:<18}{:>14}", problem_tag(f.problem, f.poisson), f.error, f.name, text(f.time));
    if (peer) out += fmt::format("{:>14}  {:<38}{:>8}", text(peer->time), peer->name, ratio(peer->time, f.time));
    out += '\n';
  }
  if (!bench.sizes.empty()) out += size_table(bench);
  for (const ValidationMeasurement& v : bench.validations)
    out += fmt::format(
        "validation of {} at {} points x {} radii, {} triangles: {:.2g} s, {:.2g} times the state ({:.2g} s); holds "
        "{}, fails {}, out of range {}\n",
        v.functional, v.points, v.radii, v.triangles, v.validate_s, v.ratio(), v.state.work(), v.holds, v.fails,
        v.out_of_range);
  for (const std::string& note : bench.notes) out += "note: " + note + '\n';
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

std::vector<std::string> map_case_names() {
  std::vector<std::string> names;
  for (const ProblemKind& kind : map_problem_kinds()) names.push_back(kind.name);
  names.emplace_back(validation);
  return names;
}

std::string sequence_name(const MapMeasurement& m) {
  return fmt::format("{} {}, {}", m.element, m.degree, m.mesh);
}

}  // namespace kerf
