#include "bench/optimize_peers.hpp"

#include "bench/peer_scripts.hpp"
#include "bench/records.hpp"
#include "bench/shell.hpp"
#include "io/files.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

namespace {

namespace fs = std::filesystem;

struct Job {
  std::string problem, name, command;
  int cells;  // per length
};

constexpr const char* traced = "tdopt_traced.edp";
constexpr const char* trace_file = "trace.txt";

std::vector<Job> simp_jobs(bool quick) {
  std::vector<Job> jobs;
  for (const OptimizeProblem& p : optimize_problems())
    for (const int n : quick ? std::vector{20} : std::vector{50, 100})
      jobs.push_back({p.name, fmt::format("SIMP, n = {}", n),
                      fmt::format("{} simp_trace.py {} {} {} {}", python, p.name, n, quick ? 10 : 100, trace_file), n});
  return jobs;
}

std::vector<Job> freefem_jobs(bool quick) {
  std::vector<Job> jobs;
  for (const char* name : {"cantilever", "mbb"})
    for (const int n : quick ? std::vector{20} : std::vector{50, 100})
      jobs.push_back(
          {name, fmt::format("FreeFem++ level set, n = {}", n),
           fmt::format("{} -nw -v 0 {} -n {} -ps 1 -case {} -maxit {}", freefem, traced, n, name, quick ? 25 : 100),
           n});
  return jobs;
}

}  // namespace

void require_design_scripts(const fs::path& folder) {
  if (!fs::exists(folder / "simp.py") && !fs::exists(folder / "tdopt.edp"))
    throw Error(Fault::Files, fmt::format("{} holds no peer scripts (simp.py, tdopt.edp)", folder.string()));
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

DesignPeers run_design_peers(const DesignPeerOptions& options) {
  DesignPeers result;
  require_design_scripts(options.scripts);
  copy_scripts(options.scripts, options.work);
  std::vector<Job> jobs;
  const auto add = [&](const std::vector<Job>& more) { jobs.insert(jobs.end(), more.begin(), more.end()); };
  if (fs::exists(options.scripts / "tdopt.edp")) {
    if (!in_path(freefem)) {
      result.notes.push_back("FreeFem++ is not installed: its runs are left out");
    } else if (const auto script = traced_tdopt(read_file(options.scripts / "tdopt.edp"))) {
      write_file(options.work / traced, *script);
      add(freefem_jobs(options.quick));
    } else {
      result.notes.push_back("tdopt.edp has changed: its designs cannot be written down, its runs are left out");
    }
  }
  if (fs::exists(options.scripts / "simp.py")) {
    write_file(options.work / "simp_trace.py", simp_trace_script);
    if (shell(fmt::format("{} -c 'import numpy, scipy' 2>&1", python)).code == 0)
      add(simp_jobs(options.quick));
    else
      result.notes.push_back(fmt::format("{} has no numpy and scipy: SIMP is left out", python));
  }
  if (!options.problems.empty())
    std::erase_if(jobs, [&](const Job& j) {
      return std::find(options.problems.begin(), options.problems.end(), j.problem) == options.problems.end();
    });
  // Small runs first: when time runs out, every problem has one.
  std::stable_sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) { return a.cells < b.cells; });

  Stopwatch watch;
  double spent = 0;
  std::size_t done = 0;
  for (const Job& job : jobs) {
    spent += watch.lap();
    if (spent > options.seconds || (options.stop_asked && options.stop_asked())) break;
    ++done;
    if (options.on_phase) options.on_phase(fmt::format("{}: {}", job.problem, job.name));
    const fs::path trace = options.work / trace_file;
    fs::remove(trace);
    const Outcome o = run_script(options.work, job.command, std::clamp(options.seconds - spent, 10.0, 600.0));
    DesignPeer run{job.problem, job.name, {}, o.memory_mb};
    if (fs::exists(trace)) run.snapshots = read_snapshots(read_file(trace));
    if (o.code != 0 || run.snapshots.empty()) {
      const bool late = o.code == 124 || o.code == 137;
      result.notes.push_back(
          fmt::format("\"{}\" {}", job.command,
                      late ? "took too long" : fmt::format("failed (exit {}): {}", o.code, last_line(o.output))));
      continue;
    }
    result.runs.push_back(std::move(run));
  }
  if (done < jobs.size())
    result.notes.push_back(
        fmt::format("{} of {} runs of other programs were left out for time", jobs.size() - done, jobs.size()));
  return result;
}

}  // namespace kerf
