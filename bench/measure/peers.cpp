// Runs of other programs on the bodies of the benches: FreeFem++ and dolfin by the scripts in a folder, each a job with
// its problem, element, mesh and size. Scripts run in a copy of the folder with one thread and a limit of time; their
// last line says errors and times (read_peer_line). Small sizes go first, so that every sequence has its beginning when
// the time is over. What is not installed, fails or takes too long is a note.

#include "bench/measure/peers.hpp"

#include "base/stopwatch.hpp"
#include "bench/command/records.hpp"
#include "bench/command/shell.hpp"
#include "bench/measure/peer_scripts.hpp"
#include "bench/measure/problem.hpp"
#include "io/files.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

namespace fs = std::filesystem;

struct Job {
  std::string problem;
  double poisson;
  std::string name, command;
  int size;
};

/// Sizes of a sequence end where a run took more than about twenty seconds on a machine of 2025.
std::vector<Job> freefem_jobs() {
  std::vector<Job> jobs;
  const auto add = [&](const std::string& problem, double poisson, const std::string& name, const std::string& script,
                       const std::string& arguments, std::initializer_list<int> sizes) {
    for (const int n : sizes)
      jobs.push_back({problem, poisson, "FreeFem++ " + name,
                      fmt::format("{} -nw -v 0 {} -n {} -nu {:.18g} {}", freefem, script, n, poisson, arguments), n});
  };
  for (const double nu : {0.3, 0.4999, 0.499999}) {
    add("smooth", nu, "P2", "s1.edp", "-form p2 -solver CHOLMOD", {16, 32, 64, 128});
    add("smooth", nu, "P3", "s1.edp", "-form p3 -solver CHOLMOD", {8, 16, 32, 64});
    add("smooth", nu, "P4", "s1.edp", "-form p4 -solver CHOLMOD", {8, 16, 32});
    add("smooth", nu, "Taylor-Hood", "s1.edp", "-form th -solver MUMPS", {16, 32, 64, 128});
  }
  for (const auto& [problem, nu, extra] :
       {std::tuple("cook-stress", 1.0 / 3, "-mesh 1 -ps 1"), std::tuple("cook-strain", 0.4999, "-mesh 1")}) {
    add(problem, nu, "P2 graded", "s2.edp", fmt::format("-form p2 -solver CHOLMOD {}", extra), {24, 48});
    add(problem, nu, "P3 graded", "s2.edp", fmt::format("-form p3 -solver CHOLMOD {}", extra), {12, 24, 48});
    add(problem, nu, "Taylor-Hood graded", "s2.edp", fmt::format("-form th -solver MUMPS {}", extra), {24, 48});
  }
  for (const double nu : {0.3, 0.499999}) {
    add("open-crack", nu, "P2 graded", "s3.edp", "-half 0 -grade 0.75 -form p2 -solver CHOLMOD", {16, 32, 64, 128});
    add("open-crack", nu, "P3 graded", "s3.edp", "-half 0 -grade 0.83 -form p3 -solver CHOLMOD", {16, 32, 64});
    add("closing-crack", nu, "P2 graded", "s4.edp", "-half 0 -tipA -0.33333333333333", {16, 32, 64});
    add("closing-crack", nu, "P2 graded, end unknown", "s4.edp", "-half 0 -tipA 9", {16, 32, 64});
  }
  return jobs;
}

std::vector<Job> dolfin_jobs() {
  std::vector<Job> jobs;
  const auto add = [&](const std::string& problem, const std::string& script_problem, double poisson,
                       const std::string& form, const std::string& extra, std::initializer_list<int> sizes) {
    for (const int n : sizes)
      jobs.push_back(
          {problem, poisson, "dolfin " + form,
           fmt::format("{} dolf.py {} {} {:.18g} {} mumps{}", python, script_problem, n, poisson, form, extra), n});
  };
  for (const double nu : {0.3, 0.4999, 0.499999}) {
    add("smooth", "S1", nu, "p2", "", {16, 32, 64, 128});
    add("smooth", "S1", nu, "th", "", {16, 32, 64, 128});
    add("smooth", "S1", nu, "afw2", "", {16, 32, 64});
  }
  add("cook-stress", "COOK", 1.0 / 3, "afw2", " ps", {24, 48});
  add("cook-strain", "COOK", 0.4999, "afw2", "", {24, 48});
  return jobs;
}

/// map_crack.edp on the bodies of s3.edp and s4.edp; tdmap.edp has no exact solution and is there for its times. Meshes
/// graded by adaptmesh cost FreeFem++ 0.4 s however small they are; the others have no such floor.
std::vector<Job> map_jobs() {
  std::vector<Job> jobs;
  const auto add = [&](const std::string& problem, double poisson, const std::string& name,
                       const std::string& arguments, std::initializer_list<int> sizes) {
    for (const int n : sizes)
      jobs.push_back({problem, poisson, "FreeFem++ " + name,
                      fmt::format("{} -nw -v 0 map_crack.edp -n {} -nu {:.18g} {}", freefem, n, poisson, arguments),
                      n});
  };
  const std::tuple<const char*, const char*, const char*> forms[] = {
      {"P2", "p2", "0.75"}, {"P3", "p3", "0.83"}, {"Taylor-Hood", "th", "0.75"}};
  for (const double nu : {0.3, 0.499999})
    for (const auto& [name, form, grade] : forms) {
      const std::string open = fmt::format("-case open -form {} -grade ", form),
                        closing = fmt::format("-case closing -form {} -grade ", form);
      add("open-crack", nu, fmt::format("{} uniform", name), open + "0", {16, 32, 64, 128});
      add("open-crack", nu, fmt::format("{} graded", name), open + grade, {8, 16, 32, 64});
      add("closing-crack", nu, fmt::format("{} uniform", name), closing + "0", {16, 32, 64});
      add("closing-crack", nu, fmt::format("{} graded", name), closing + grade + " -tipA -0.33333333333333",
          {8, 16, 32});
      add("closing-crack", nu, fmt::format("{} graded, end unknown", name), closing + grade + " -tipA 9", {8, 16, 32});
    }
  for (const int n : {100, 300})
    jobs.push_back(
        {"cantilever", 0.3, "FreeFem++ P2", fmt::format("{} -nw -v 0 tdmap.edp -n {} -ps 1", freefem, n), n});
  return jobs;
}

}  // namespace

void require_scripts(const fs::path& folder, PeerTask task) {
  if (task == PeerTask::Map && !(fs::exists(folder / "slit.idp") && fs::exists(folder / "common.idp")))
    throw Error(Fault::Files, fmt::format("{} holds no peer scripts (slit.idp, common.idp)", folder.string()));
  if (task == PeerTask::State && !fs::exists(folder / "s1.edp") && !fs::exists(folder / "dolf.py"))
    throw Error(Fault::Files, fmt::format("{} holds no peer scripts (s1.edp, dolf.py)", folder.string()));
}

namespace {

/// What the scripts in the folder and the programs that are installed can do, small runs first: when time runs out,
/// every sequence has its beginning.
std::vector<Job> jobs_of(const PeerOptions& options, std::vector<std::string>& notes) {
  std::vector<Job> jobs;
  const auto consider = [&](const char* script, const char* program, bool installed, const std::vector<Job>& more) {
    if (!fs::exists(options.scripts / script)) return;
    if (installed)
      jobs.insert(jobs.end(), more.begin(), more.end());
    else
      notes.push_back(fmt::format("{} is not installed: its runs are left out", program));
  };
  if (options.task == PeerTask::Map) {
    consider("slit.idp", freefem, in_path(freefem), map_jobs());
    if (!fs::exists(options.scripts / "tdmap.edp")) {
      std::erase_if(jobs, [](const Job& j) { return j.problem == "cantilever"; });
      notes.push_back(fmt::format("{} has no tdmap.edp: no other program on the cantilever", options.scripts.string()));
    }
  } else {
    consider("s1.edp", freefem, in_path(freefem), freefem_jobs());
  }
  if (options.task == PeerTask::State && fs::exists(options.scripts / "dolf.py"))  // to ask takes seconds
    consider("dolf.py", "dolfin", shell(fmt::format("{} -c 'import dolfin' 2>&1", python)).code == 0, dolfin_jobs());
  if (!options.problems.empty())
    std::erase_if(jobs, [&](const Job& j) {
      return std::find(options.problems.begin(), options.problems.end(), j.problem) == options.problems.end();
    });
  std::stable_sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) { return a.size < b.size; });
  if (options.quick) std::erase_if(jobs, [](const Job& j) { return j.size > 8; });
  return jobs;
}

void run_job(const PeerOptions& options, const Job& job, double limit, PeerRuns& result) {
  const Outcome o = run_script(options.work, job.command, limit);
  std::optional<PeerRun> run = read_peer_line(o.output);
  if (o.code != 0 || !run) {
    const bool late = o.code == 124 || o.code == 137;
    result.notes.push_back(
        fmt::format("\"{}\" {}", job.command,
                    late ? "took too long" : fmt::format("failed (exit {}): {}", o.code, last_line(o.output))));
    return;
  }
  run->problem = job.problem;
  run->poisson = job.poisson;
  run->name = job.name;
  run->memory_mb = o.memory_mb;
  result.runs.push_back(std::move(*run));
}

}  // namespace

PeerRuns run_peers(const PeerOptions& options) {
  PeerRuns result;
  require_scripts(options.scripts, options.task);
  copy_scripts(options.scripts, options.work);
  if (options.task == PeerTask::Map) write_file(options.work / "map_crack.edp", map_crack_script);
  const std::vector<Job> jobs = jobs_of(options, result.notes);
  Stopwatch watch;
  double spent = 0;
  std::size_t done = 0;
  for (const Job& job : jobs) {
    spent += watch.lap();
    if (spent > options.seconds || stop_requested() || (options.stop_asked && options.stop_asked())) break;
    ++done;
    if (options.on_phase) options.on_phase(fmt::format("peers: {} {} n = {}", job.problem, job.name, job.size));
    run_job(options, job, std::clamp(options.seconds - spent, 10.0, 300.0), result);
  }
  if (done < jobs.size())
    result.notes.push_back(
        fmt::format("{} of {} runs of other programs were left out for time", jobs.size() - done, jobs.size()));
  return result;
}

}  // namespace kerf
