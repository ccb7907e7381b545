// The runs of a sweep: processes of this program, so many at a time, or scripts for schedulers. Each run is `kerf run`
// with its overrides, its words on stderr in run.log; what fails leaves failed.txt with the exit code and the reason. A
// child ends with its parent (PR_SET_PDEATHSIG), also when the parent ended before that was set. Scripts (Snakemake,
// Slurm) read runs.tsv, a line per run with words between tabs, so that values need no quoting there; they leave the
// same files, from which --collect makes the table.

#include "app/progress.hpp"
#include "app/sweep.hpp"
#include "io/files.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>

namespace kerf {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> arguments_of(const SweepPlan& plan, const SweepRun& run, int threads) {
  std::vector<std::string> out{"run",         fs::absolute(plan.case_file).string(),
                               "-o",          (plan.folder / run.name).string(),
                               "--force",     "--quiet",
                               "--log-level", "error",
                               "--threads",   std::to_string(threads)};
  for (const std::string& assignment : overrides_of(plan, run)) {
    out.emplace_back("--set");
    out.push_back(assignment);
  }
  return out;
}

void make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot make the folder {}: {}", folder.string(), failed.message()));
}

/// This program with those arguments; what it says on stderr goes to run.log. It ends with this one.
pid_t start(const std::vector<std::string>& arguments, const fs::path& sweep, const std::string& name) {
  const int to = new_file(sweep, fs::path(name) / "run.log");
  if (to < 0)
    throw Error(Fault::Files,
                fmt::format("cannot write '{}': {}", (sweep / name / "run.log").string(),
                            to == -ENOTDIR ? "what its folder is called is a link or no folder" : std::strerror(-to)));
  std::error_code ignored;
  fs::remove(sweep / name / "failed.txt", ignored);
  std::vector<char*> argv{const_cast<char*>("kerf")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child != 0) close(to);
  if (child < 0) throw Error(Fault::Numerics, fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (child > 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGKILL);                                   // what it wrote is whole, and goes on from there
  if (getppid() != parent) _exit(static_cast<int>(Fault::Numerics));  // it ended before
  const int nothing = open("/dev/null", O_RDWR);
  dup2(to, STDERR_FILENO);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  execv("/proc/self/exe", argv.data());
  _exit(static_cast<int>(Fault::Files));
}

std::string last_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  constexpr std::string_view name = "kerf: ";
  return last.starts_with(name) ? last.substr(name.size()) : last;
}

/// What a process left says whether it is done; nothing where a stop ended it.
void note_end(const fs::path& folder, int status) {
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (code == 0 || stop_requested()) return;
  std::string reason = last_line(folder / "run.log");
  if (WIFSIGNALED(status)) reason = fmt::format("ended by signal {}", WTERMSIG(status));
  write_failure(folder, code, reason.empty() ? "no reason was given" : reason);
}

}  // namespace

void run_sweep(const SweepPlan& plan, const SweepHow& how) {
  std::vector<const SweepRun*> todo;
  for (const SweepRun& run : plan.runs)
    if (record_of(plan, run).state == RunRecord::State::Todo) todo.push_back(&run);
  const std::size_t kept = plan.runs.size() - todo.size();
  Progress progress(how.quiet ? "warn" : "info");
  std::map<pid_t, const SweepRun*> going;
  std::size_t next = 0, ended = 0;
  while (next < todo.size() || !going.empty()) {
    while (next < todo.size() && going.size() < static_cast<std::size_t>(how.jobs) && !stop_requested()) {
      const SweepRun& run = *todo[next++];
      std::vector<std::string> words = arguments_of(plan, run, how.threads);
      words.insert(words.end(), how.limits.begin(), how.limits.end());
      going[start(words, plan.folder, run.name)] = &run;
    }
    if (going.empty()) break;
    int status = 0;
    const pid_t child = waitpid(-1, &status, 0);
    if (child < 0 && errno == EINTR) continue;
    const auto found = going.find(child);
    if (found == going.end()) continue;
    note_end(plan.folder / found->second->name, status);
    ++ended;
    progress.phase(fmt::format("sweep: {} of {} runs, last {}", kept + ended, plan.runs.size(), found->second->name));
    going.erase(found);
  }
  progress.finish();
}

namespace {

std::string for_shell(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  out += '\'';
  return out;
}

/// A line per run: its folder, and what its command has more, word by word, with tabs between.
std::string list_of_runs(const SweepPlan& plan) {
  std::string out;
  for (const SweepRun& run : plan.runs) {
    out += run.name;
    for (const std::string& assignment : overrides_of(plan, run)) out += "\t--set\t" + assignment;
    out += '\n';
  }
  return out;
}

/// A string of Python; in a command of Snakemake braces stand twice.
std::string in_quotes(const std::string& text, bool command) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
    if (command && (c == '{' || c == '}')) out += c;
  }
  return out + '"';
}

/// The same for all: runs one, keeps what it says, and its exit code where it fails. `{}`: in the order name, case,
/// threads, name, arguments.
std::string snakefile(const SweepPlan& plan, int threads, const std::string& again) {
  return fmt::format(R"(# Written by kerf sweep: snakemake --cores 2 (or any profile for a cluster) in this folder.
import shlex

LINES = [line.rstrip("\n").split("\t") for line in open("runs.tsv")]
RUNS = {{line[0]: shlex.join(line[1:]) for line in LINES}}
CASE = {0}


rule table:
    input: expand("{{run}}/run.log", run=RUNS)
    shell: {1}


rule run:
    output: "{{run}}/run.log"
    wildcard_constraints: run="[^/]+"
    threads: {2}
    params: arguments=lambda wildcards: RUNS[wildcards.run], case=shlex.quote(CASE),
        folder=lambda wildcards: shlex.quote(wildcards.run)
    shell:
        """
        rm -f {{params.folder}}/failed.txt
        kerf run {{params.case}} -o {{params.folder}} --force --quiet --log-level error --threads {{threads}} {{params.arguments}} \
            2> {{output:q}} || {{{{ code=$?; (echo $code; tail -n 1 {{output:q}}) > {{params.folder}}/failed.txt; [ $code -lt 5 ]; }}}}
        """
)",
                     in_quotes(fs::absolute(plan.case_file).string(), false), in_quotes(again, true), threads);
}

std::string slurm_script(const SweepPlan& plan, int threads) {
  return fmt::format(R"(#!/bin/bash
# Written by kerf sweep: sbatch sweep.sbatch in this folder. A cluster may allow fewer tasks of one array (MaxArraySize,
# often 1001): then submit parts, as sbatch --array=1-1000 sweep.sbatch.
#SBATCH --job-name=kerf-sweep
#SBATCH --array=1-{}
#SBATCH --cpus-per-task={}
#SBATCH --output=/dev/null
IFS=$'\t' read -r -a words < <(sed -n "${{SLURM_ARRAY_TASK_ID}}p" runs.tsv)
run=${{words[0]}} case={}
[ -n "$run" ] || exit 2
mkdir -p "$run"
rm -f "$run/failed.txt"
kerf run "$case" -o "$run" --force --quiet --log-level error --threads {} "${{words[@]:1}}" 2> "$run/run.log" && exit 0
code=$?
(echo $code; tail -n 1 "$run/run.log") > "$run/failed.txt"
exit $code
)",
                     plan.runs.size(), threads, for_shell(fs::absolute(plan.case_file).string()), threads);
}

}  // namespace

std::string write_sweep_script(const SweepPlan& plan, const std::string& kind, int threads, const std::string& again) {
  make_folder(plan.folder);
  write_file(plan.folder / "runs.tsv", list_of_runs(plan));
  const bool snake = kind == "snakemake";
  const std::string name = snake ? "Snakefile" : "sweep.sbatch";
  write_file(plan.folder / name, snake ? snakefile(plan, threads, again) : slurm_script(plan, threads));
  return fmt::format("wrote {}; in that folder: {}\nthen the table: {}\n", (plan.folder / name).string(),
                     snake ? "snakemake --cores 2 --keep-going" : "sbatch " + name, again);
}

}  // namespace kerf
