#pragma once
// A program that runs beside its test, and how a test waits: for a condition, never for a time.

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace kerf::test {

/// Whether the condition comes true. Only what never comes reaches the limit, however busy the machine is.
template <class Condition>
bool eventually(Condition&& holds, std::chrono::seconds limit = std::chrono::minutes(5)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// A program, started in a folder where its words go to the files stdout and stderr.
class Running {
 public:
  Running(const std::filesystem::path& folder, std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& w : words) arguments.push_back(w.data());
    arguments.push_back(nullptr);
    const std::string in = folder.string(), out = (folder / "stdout").string(), error = (folder / "stderr").string();
    id_ = fork();
    if (id_ < 0) throw std::runtime_error("cannot start a process");
    if (id_ > 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that is killed leaves nothing behind
    constexpr int how = O_WRONLY | O_CREAT | O_TRUNC;
    if (chdir(in.c_str()) != 0 || dup2(open(out.c_str(), how, 0600), 1) < 0 ||
        dup2(open(error.c_str(), how, 0600), 2) < 0)
      _exit(126);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    if (ended()) return;
    ::kill(id_, SIGKILL);
    waitpid(id_, &status_, 0);
  }

  pid_t id() const {
    return id_;
  }
  bool ended() {
    if (!ended_) ended_ = waitpid(id_, &status_, WNOHANG) != 0;
    return ended_;
  }
  /// A low priority, so that its test sees a short moment before it has passed.
  void give_way() {
    setpriority(PRIO_PROCESS, static_cast<id_t>(id_), 5);
  }
  /// Whether the condition comes true while it runs.
  template <class Condition>
  bool reaches(Condition&& holds) {
    return eventually([&] { return holds() || ended(); }) && !ended();
  }
  void signal(int number) {
    if (!ended()) ::kill(id_, number);
  }
  /// Of all its threads, so far.
  double processor_seconds() const {
    clockid_t clock;
    timespec t{};
    if (clock_getcpuclockid(id_, &clock) != 0 || clock_gettime(clock, &t) != 0) return 0;
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  /// The code it exits with, or 128 and the signal that ends it; -1 if it does not end.
  int code() {
    if (!eventually([this] { return ended(); })) return -1;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

 private:
  pid_t id_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace kerf::test
