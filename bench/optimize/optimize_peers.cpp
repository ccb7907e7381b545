// Runs of other programs on the scenarios: SIMP in Python (a script of ours), plain and with projection, and a level
// set in FreeFem++, whose script is changed at one place so that it writes its designs down. A run writes a trace:
// iteration, objective, seconds, state solves, and its field on a grid per snapshot; what a killed run has written
// counts. Small runs go first, so that every scenario has one when the time is over; no run takes more than 900 s. A
// script whose text has changed at that place is left out with a note.

#include "bench/optimize/optimize_peers.hpp"

#include "base/stopwatch.hpp"
#include "bench/command/records.hpp"
#include "bench/command/shell.hpp"
#include "bench/measure/peer_scripts.hpp"
#include "io/files.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

namespace {

namespace fs = std::filesystem;

struct DesignJob {
  std::string problem, name, command;
  int cells;  // per length
  double volume;
  bool strong = false;
};

constexpr const char* traced = "tdopt_traced.edp";
constexpr const char* simp_script = "simp_scenario.py";
constexpr const char* trace_file = "trace.txt";
constexpr double longest = 900;  // seconds that one run may take

DesignJob simp_job(const OptimizeProblem& p, double volume, int cells, bool strong, const DesignPeerOptions& options) {
  const std::string scenario = fmt::format("{}_{}.json", p.name, volume);
  write_file(options.work / scenario, density_scenario(p, volume));
  return {p.name,
          simp_name(cells, strong),
          fmt::format("{} {} {} {} {} {}{}", python, simp_script, scenario, cells, options.quick ? 10 : 100, trace_file,
                      strong ? " --strong" : ""),
          cells,
          volume,
          strong};
}

std::vector<DesignJob> simp_jobs(const std::vector<OptimizeProblem>& problems, const DesignPeerOptions& options) {
  std::vector<DesignJob> jobs;
  for (const OptimizeProblem& p : problems) {
    if (!has_density(p)) continue;
    const double volume = *p.request.volume_at_most;
    for (const int cells : options.quick ? std::vector{20} : std::vector{usual_cells, 2 * usual_cells})
      jobs.push_back(simp_job(p, volume, cells, false, options));
    if (!options.quick && options.finest) jobs.push_back(simp_job(p, volume, 4 * usual_cells, true, options));
  }
  return jobs;
}

/// Of the bodies that its script knows.
std::vector<DesignJob> freefem_design_jobs(const std::vector<OptimizeProblem>& problems, bool quick) {
  std::vector<DesignJob> jobs;
  for (const OptimizeProblem& p : problems) {
    if (p.name != "cantilever" && p.name != "mbb") continue;
    for (const int n : quick ? std::vector{20} : std::vector{50, 100})
      jobs.push_back(
          {p.name, fmt::format("FreeFem++ level set, n = {}", n),
           fmt::format("{} -nw -v 0 {} -n {} -ps 1 -case {} -maxit {}", freefem, traced, n, p.name, quick ? 25 : 100),
           n, *p.request.volume_at_most});
  }
  return jobs;
}

bool has_numpy() {
  return shell(fmt::format("{} -c 'import numpy, scipy' 2>&1", python)).code == 0;
}

/// Those of FreeFem++ that can be run, or a note.
std::vector<DesignJob> prepare_freefem(const std::vector<OptimizeProblem>& problems, const DesignPeerOptions& options,
                                       DesignPeers& result) {
  if (options.scripts.empty()) return {};
  copy_scripts(options.scripts, options.work);
  const auto script = traced_tdopt(read_file(options.scripts / "tdopt.edp"));
  const char* missing = !in_path(freefem) ? "FreeFem++ is not installed: its runs are left out"
                        : !script ? "tdopt.edp has changed: its designs cannot be written down, its runs are left out"
                                  : nullptr;
  if (missing) {
    result.notes.emplace_back(missing);
    return {};
  }
  write_file(options.work / traced, *script);
  return freefem_design_jobs(problems, options.quick);
}

void run_design_job(const DesignJob& job, double limit, const DesignPeerOptions& options, DesignPeers& result) {
  if (options.on_phase) options.on_phase(fmt::format("{}: {}", job.problem, job.name));
  const fs::path trace = options.work / trace_file;
  fs::remove(trace);
  const Outcome o = run_script(options.work, job.command, limit);
  DesignPeer run{job.problem, job.name, job.strong, job.volume, {}, o.memory_mb};
  if (fs::exists(trace)) run.snapshots = read_snapshots(read_file(trace));
  fs::remove(trace);
  if (o.code == 0 && !run.snapshots.empty()) {
    result.runs.push_back(std::move(run));
    return;
  }
  const bool late = o.code == 124 || o.code == 137;
  result.notes.push_back(
      fmt::format("\"{}\" {}", job.command,
                  late ? "took too long" : fmt::format("failed (exit {}): {}", o.code, last_line(o.output))));
}

}  // namespace

std::string simp_name(int cells, bool strong) {
  return fmt::format("SIMP, {}n = {}", strong ? "projected, " : "", cells);
}

void require_design_scripts(const fs::path& folder) {
  if (!fs::exists(folder / "tdopt.edp"))
    throw Error(Fault::Files, fmt::format("{} does not hold the peer script tdopt.edp", folder.string()));
}

std::optional<std::string> traced_tdopt(std::string script) {
  // Where J belongs to psi, right after the clock has been read.
  const std::string place = "  Jold = J;\n";
  const std::size_t at = script.find(place);
  if (at == std::string::npos || script.find(place, at + 1) != std::string::npos) return std::nullopt;
  return script.replace(at, place.size(),
                        fmt::format(R"(  Jold = J; tick(tPost)
  {{ ofstream o("{}", append); o.precision(9); int nx = int(w*nn);
    o << it << " " << J << " " << tAsm+tSol+tPost << " " << nsol << " " << nx+1 << " " << nn+1 << endl; o.precision(6);
    for (int j = 0; j <= nn; j++) {{ for (int i = 0; i <= nx; i++) o << psi(w*i/nx, 1.*j/nn) << " "; o << endl; }} }}
  tt = clock();
)",
                                    trace_file));
}

std::vector<PeerSnapshot> read_snapshots(const std::string& text) {
  std::vector<PeerSnapshot> all;
  const char *at = text.data(), *end = at + text.size();
  const auto read = [&](auto& value) {
    while (at < end && std::isspace(static_cast<unsigned char>(*at))) ++at;
    const auto [next, error] = std::from_chars(at, end, value);
    at = next;
    return error == std::errc();
  };
  for (;;) {
    PeerSnapshot s;
    GridField& f = s.field;
    if (!read(s.iteration) || !read(s.objective) || !read(s.seconds) || !read(s.state_solves) || !read(f.columns) ||
        !read(f.rows) || f.columns < 2 || f.rows < 2 || f.columns > 10000 || f.rows > 10000)
      return all;
    f.value.resize(static_cast<std::size_t>(f.columns) * f.rows);
    for (double& value : f.value)
      if (!read(value) || !std::isfinite(value)) return all;
    all.push_back(std::move(s));
  }
}

DesignPeers run_design_peers(const std::vector<OptimizeProblem>& problems, const DesignPeerOptions& options) {
  DesignPeers result;
  fs::create_directories(options.work);
  std::vector<DesignJob> jobs = prepare_freefem(problems, options, result);
  if (has_numpy()) {
    write_file(options.work / simp_script, simp_scenario_script);
    for (DesignJob& job : simp_jobs(problems, options)) jobs.push_back(std::move(job));
  } else {
    result.notes.push_back(fmt::format("{} has no numpy and scipy: SIMP is left out", python));
  }
  // Small runs first: when time runs out, every problem has one.
  std::stable_sort(jobs.begin(), jobs.end(), [](const DesignJob& a, const DesignJob& b) { return a.cells < b.cells; });
  Stopwatch watch;
  double spent = 0;
  std::size_t done = 0;
  for (const DesignJob& job : jobs) {
    spent += watch.lap();
    if (spent > options.seconds || stop_requested() || (options.stop_asked && options.stop_asked())) break;
    ++done;
    run_design_job(job, std::clamp(options.seconds - spent, 10.0, longest), options, result);
  }
  if (done < jobs.size())
    result.notes.push_back(
        fmt::format("{} of {} runs of other programs were left out for time", jobs.size() - done, jobs.size()));
  return result;
}

DesignPeers run_simp(const OptimizeProblem& p, double volume, int cells, const DesignPeerOptions& options) {
  DesignPeers result;
  fs::create_directories(options.work);
  if (!has_numpy()) return result;
  write_file(options.work / simp_script, simp_scenario_script);
  run_design_job(simp_job(p, volume, cells, false, options), longest, options, result);
  return result;
}

}  // namespace kerf
