// The program as a child of its own folder, home and environment, with limits of files and address space. Processor
// time counts, or eight times as much by the clock: past the limit it is asked by SIGTERM to stop, and killed when it
// does not. The outcome is what it printed, every file that is new, changed or removed, and what lies in its home.

#include "tests/fuzz/child.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <stdexcept>

namespace kerf::fuzz {

namespace {

namespace fs = std::filesystem;

/// What the child is started with: nothing of the surroundings that could change what it does.
struct Words {
  std::vector<std::string> arguments, environment;
  std::vector<char*> argv, envp;
};

Words words_of(const fs::path& program, const Input& input, const fs::path& work) {
  Words w;
  w.arguments.push_back(program.string());
  w.arguments.insert(w.arguments.end(), input.arguments.begin(), input.arguments.end());
  w.environment = {"PATH=/usr/bin:/bin", "HOME=" + (work / "home").string(), "TMPDIR=" + (work / "tmp").string(),
                   "LC_ALL=C",           "OPENBLAS_NUM_THREADS=1",           "OMP_NUM_THREADS=1"};
  w.environment.insert(w.environment.begin(), input.environment.begin(), input.environment.end());  // the first counts
  for (const char* name :
       {"LD_LIBRARY_PATH", "LD_PRELOAD", "ASAN_OPTIONS", "UBSAN_OPTIONS", "GCOV_PREFIX", "GCOV_PREFIX_STRIP"})
    if (const char* value = std::getenv(name)) w.environment.push_back(std::string(name) + "=" + value);
  for (std::string& a : w.arguments) w.argv.push_back(a.data());
  for (std::string& e : w.environment) w.envp.push_back(e.data());
  w.argv.push_back(nullptr);
  w.envp.push_back(nullptr);
  return w;
}

void limit(int what, double value) {
  const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  setrlimit(what, &both);
}

/// Between fork and exec: only what signal handlers may do, too.
[[noreturn]] void become(Words& w, const Limits& limits, const char* folder, const char* out, const char* error) {
  const int nothing = open("/dev/null", O_RDONLY), to = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600),
            log = open(error, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (nothing < 0 || to < 0 || log < 0 || chdir(folder) != 0) _exit(126);
  dup2(nothing, 0), dup2(to, 1), dup2(log, 2);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, limits.file_mb * 1e6);
  if (limits.memory_gb > 0) limit(RLIMIT_AS, limits.memory_gb * 1e9);
  execve(w.argv[0], w.argv.data(), w.envp.data());
  _exit(126);
}

double processor_seconds(pid_t child) {
  clockid_t clock;
  timespec t{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &t) != 0) return 0;
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Until it ends. Processor time counts, because the machine may be busy with others; somebody who waits for ever uses
/// none, so that the time of the clock counts, too.
void wait_for(pid_t child, const Limits& limits, Outcome& o) {
  constexpr double patience = 8;  // seconds by the clock for one of processor time
  const double start = now();
  double asked_at = 0, asked_cpu = 0;
  int status = 0;
  rusage usage{};
  for (useconds_t pause = 500;; pause = std::min<useconds_t>(pause * 5 / 4, 20000)) {
    const pid_t done = wait4(child, &status, WNOHANG, &usage);
    if (done == child) break;
    if (done < 0 && errno != EINTR) throw std::runtime_error("the child is lost");
    const double cpu = processor_seconds(child), clock = now();
    if (!o.asked && (cpu > limits.seconds || clock - start > patience * limits.seconds)) {
      o.asked = true, asked_at = clock, asked_cpu = cpu;
      kill(child, SIGTERM);
    } else if (o.asked && !o.hung && (cpu - asked_cpu > limits.grace || clock - asked_at > patience * limits.grace)) {
      o.hung = true;
      kill(child, SIGKILL);
    }
    usleep(pause);
  }
  if (WIFEXITED(status)) o.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) o.signal = WTERMSIG(status);
  o.seconds = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
              1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  o.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

Outcome run_child(const fs::path& program, const Input& input, const Limits& limits, const fs::path& work) {
  const fs::path folder = work / "in";
  fs::remove_all(work);
  for (const char* name : {"in", "home", "tmp"}) fs::create_directories(work / name);
  for (const auto& [name, bytes] : input.files) {
    std::ofstream out(folder / name, std::ios::binary);
    out << bytes;
    if (!out.flush()) throw std::runtime_error("cannot write " + (folder / name).string());
  }
  Words words = words_of(program, input, work);
  const std::string in = folder.string(), out = (work / "stdout").string(), error = (work / "stderr").string();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start a process");
  if (child == 0) become(words, limits, in.c_str(), out.c_str(), error.c_str());
  Outcome o;
  wait_for(child, limits, o);
  if (o.code == 126) throw std::runtime_error("cannot start " + program.string());
  o.out = bytes_of(out);
  o.error = bytes_of(error);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_directory()) continue;
    std::string bytes = bytes_of(entry.path());
    const auto before = input.files.find(name);
    if (before == input.files.end() || before->second != bytes) o.files[name] = std::move(bytes);
  }
  for (const auto& [name, bytes] : input.files)
    if (!fs::exists(folder / name)) o.files[name] = "(removed)";
  for (const char* name : {"home", "tmp"})
    for (const auto& entry : fs::recursive_directory_iterator(work / name))
      o.elsewhere.push_back(entry.path().string());
  fs::remove_all(work);
  return o;
}

}  // namespace kerf::fuzz
