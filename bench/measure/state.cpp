// `kerf bench state`: time and memory against the error of the stress, for every element on smooth, singular and
// contact problems, on uniform, graded and adaptive meshes. A sequence is refined level by level until its error is
// below 1e-5 or its share of the time would be overrun: the next level is taken to cost 2.3 times the last one. What a
// sequence leaves of its share goes to those after it. Where no closed form is known errors are against a reference,
// down to three times the reference's own. From the sequences follow the times to given errors (compare.cpp), kerf's
// and those of other programs. docs/history/benchmarks.md has the results.

#include "bench/measure/state.hpp"

#include "base/stopwatch.hpp"
#include "bench/command/plots.hpp"
#include "bench/command/records.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

struct StateSequence {
  std::string problem;
  double poisson;
  Element element;
  Grading grading;
};

std::vector<StateSequence> sequences_of(const StateBenchOptions& options) {
  std::vector<StateSequence> all;
  for (const ProblemKind& kind : problem_kinds()) {
    if (!is_wanted(options.cases, kind.name)) continue;
    for (const double poisson : kind.poisson) {
      if (options.quick && poisson != kind.poisson.front()) continue;
      for (const Element& e : elements) {
        if (!is_wanted(options.elements, e.name)) continue;
        all.push_back({kind.name, poisson, e, Grading::Uniform});
        if (kind.name == "smooth") continue;
        all.push_back({kind.name, poisson, e, Grading::Graded});
        if (can_estimate_error(e)) all.push_back({kind.name, poisson, e, Grading::Adaptive});
      }
    }
  }
  return all;
}

constexpr double least_stress_error = 1e-5;   // no sequence goes beyond this stress error
constexpr double growth_of_state_time = 2.3;  // of the time from one level to the next

class StateRunner {
 public:
  StateRunner(const StateBenchOptions& options, StateBench& bench) : options_(options), bench_(bench) {}

  void run(const StateSequence& s, double seconds) {
    const BenchProblem& p = ready(s);
    const std::string name = fmt::format("{} nu {:.6g} {} {} {}", s.problem, s.poisson, s.element.name,
                                         s.element.degree, name_of(s.grading));
    if (options_.on_phase) options_.on_phase(name);
    const int most = options_.quick ? 2 : 40;
    double spent = 0, last = 0;
    for (int level = 0; level < most && !stopped() && spent + growth_of_state_time * last <= seconds; ++level) {
      Stopwatch watch;
      try {
        bench_.runs.push_back(measure(p, s.element, s.grading, level, options_.quick ? 1 : 3));
      } catch (const std::exception& e) {  // what an element or the memory cannot do does not end the others
        bench_.notes.push_back(fmt::format("{}, level {}: {}", name, level, e.what()));
        return;
      }
      last = watch.lap();
      spent += last;
      if (bench_.runs.back().error.stress < std::max(least_stress_error, 3 * reference_error(p))) return;
    }
  }

  bool stopped() const {
    return stop_asked(options_);
  }

 private:
  static double reference_error(const BenchProblem& p) {
    return p.reference ? p.reference->error : 0;
  }

  /// The problem, with the reference that it needs; kept while the sequences stay with it.
  const BenchProblem& ready(const StateSequence& s) {
    if (problem_ && problem_->name == s.problem && problem_->poisson == s.poisson) return *problem_;
    problem_ = problem(s.problem, s.poisson);
    if (problem_->exact) return *problem_;
    if (options_.on_phase) options_.on_phase(fmt::format("{} nu {:.6g} reference", s.problem, s.poisson));
    const Reference& r = problem_->reference.emplace(overkill(*problem_, options_.quick ? 3 : 10));
    bench_.references.push_back({s.problem, s.poisson, r.x.size(), r.strain_energy, problem_->known_energy, r.error});
    return *problem_;
  }

  const StateBenchOptions& options_;
  StateBench& bench_;
  std::optional<BenchProblem> problem_;
};

}  // namespace

StateBench run_state_bench(const StateBenchOptions& options) {
  if (!options.peers.empty()) require_scripts(options.peers);
  make_folder(options.folder);
  StateBench bench;
  StateRunner runner(options, bench);
  const std::vector<StateSequence> all = sequences_of(options);
  Stopwatch watch;
  double spent = 0;
  for (std::size_t i = 0; i < all.size() && !runner.stopped(); ++i) {
    // What one sequence leaves of its share goes to those after it.
    try {
      runner.run(all[i], (options.seconds - spent) / static_cast<double>(all.size() - i));
    } catch (const Stopped&) {
      break;
    }
    spent += watch.lap();
  }
  add_peers(options, PeerTask::State, bench);
  bench.stopped = runner.stopped();
  Sequences own;
  for (const StateMeasurement& m : bench.runs)
    own.add(m.problem, m.poisson, sequence_name(m), {m.error.stress, m.seconds.work()});
  compare(own, errors_to_reach, bench);
  write_state_csv(options.folder / "state.csv", bench);
  draw_state_plots(options.folder, bench);
  write_state_json(options.folder / "state.json", bench);
  return bench;
}

std::string summary(const StateBench& bench) {
  std::string out = "Processor seconds (mesh, assembly, factorization, solution) to a relative L2 stress error:\n";
  out += fmt::format("{:<27}{:>8}  {:<24}{:>14}{:>14}  {:<34}{:>8}\n", "case", "error", "kerf", "seconds",
                     bench.peers.empty() ? "" : "best peer", "", bench.peers.empty() ? "" : "ratio");
  for (const Fastest& f : bench.best) {
    const Fastest* peer = find(bench.best_peers, f);
    std::string line =
        fmt::format("{:<27}{:>8.0e}  {:<24}{:>14}", problem_tag(f.problem, f.poisson), f.error, f.name, text(f.time));
    if (peer) line += fmt::format("{:>14}  {:<34}{:>8}", text(peer->time), peer->name, ratio(peer->time, f.time));
    out += line + '\n';
  }
  for (const ReferenceUsed& r : bench.references) {
    out += fmt::format("{}: errors are against a solution at {} points that errs by about {:.1g} itself",
                       problem_tag(r.problem, r.poisson), r.points, r.error);
    if (r.known_energy > 0)
      out += fmt::format("; its energy is off by {:.1g}", std::abs(r.strain_energy / r.known_energy - 1));
    out += '\n';
  }
  for (const std::string& note : bench.notes) out += "note: " + note + '\n';
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

std::string sequence_name(const StateMeasurement& m) {
  return fmt::format("{} {}, {}", m.element, m.degree, m.mesh);
}

std::string problem_tag(const std::string& problem, double poisson) {
  return fmt::format("{}_nu{:.6g}", problem, poisson);
}

std::vector<std::string> bench_case_names() {
  std::vector<std::string> names;
  for (const ProblemKind& kind : problem_kinds()) names.push_back(kind.name);
  return names;
}

std::vector<std::string> bench_element_names() {
  std::vector<std::string> names;
  for (const Element& e : elements)
    if (std::find(names.begin(), names.end(), e.name) == names.end()) names.emplace_back(e.name);
  return names;
}

}  // namespace kerf
