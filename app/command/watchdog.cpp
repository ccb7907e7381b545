// Limits on seconds and memory of a program, children included (gmsh, runs of a sweep). A thread looks twenty times a
// second. Beyond a limit it asks for a stop, and what there is can be written; ten seconds later, or at 1.5 times the
// memory, it ends the program at once (quick_exit, which removes temporary files). Trials of a forecast may take 150 MB
// more: they are there to find out. Memory is what is resident: pages that were never touched do not count.

#include "app/command/watchdog.hpp"

#include "base/stopwatch.hpp"
#include "kerf/stop.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

namespace kerf {

namespace {

double resident_mb(const std::string& process) {
  std::ifstream statm("/proc/" + process + "/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// Of this process and its children: gmsh, the runs of a sweep.
double resident_mb() {
  double sum = resident_mb("self");
  std::error_code none;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task", none)) {
    std::ifstream children(thread.path() / "children");
    for (std::string child; children >> child;) sum += resident_mb(child);
  }
  return sum;
}

}  // namespace

struct Watchdog::Impl {
  Allowed limits;
  Stopwatch since_look;
  double elapsed = 0;
  mutable std::mutex mutex;
  std::condition_variable ended;
  bool over = false, forecasts = false;
  std::optional<std::string> why;
  std::thread thread;

  std::optional<std::string> beyond(double seconds, double mb) const {
    if (limits.seconds && seconds > *limits.seconds)
      return fmt::format("stopped: it took longer than --max-seconds {:g}", *limits.seconds);
    constexpr double of_forecast = 150;
    if (limits.memory_mb && mb > *limits.memory_mb + (forecasts ? of_forecast : 0))
      return fmt::format("stopped: it took more memory than --max-memory {:g}MB", *limits.memory_mb);
    return std::nullopt;
  }

  void look() {
    constexpr double patience = 10, much = 1.5;
    double asked = infinity;
    for (std::unique_lock lock(mutex); !over; ended.wait_for(lock, std::chrono::milliseconds(50))) {
      const double seconds = since_look.lap(), mb = resident_mb();
      elapsed += seconds;
      if (!why) {
        why = beyond(elapsed, mb);
        if (!why) continue;
        asked = elapsed;
        request_stop();
      }
      const bool swells = !forecasts && limits.memory_mb && mb > much * *limits.memory_mb;
      if (elapsed - asked < patience && !swells) continue;
      std::fprintf(stderr, "kerf: %s\n", why->c_str());
      std::fflush(stderr);
      std::quick_exit(static_cast<int>(Fault::Numerics));
    }
  }
};

Watchdog::Watchdog(const Allowed& limits) {
  if (!limits.memory_mb && !limits.seconds) return;
  impl_ = std::make_unique<Impl>();
  impl_->limits = limits;
  impl_->thread = std::thread([impl = impl_.get()] { impl->look(); });
}

Watchdog::~Watchdog() {
  if (!impl_) return;
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->over = true;
  }
  impl_->ended.notify_all();
  impl_->thread.join();
}

void Watchdog::allow_forecast() {
  if (!impl_) return;
  const std::scoped_lock lock(impl_->mutex);
  impl_->forecasts = true;
}

void Watchdog::end_forecast() {
  if (!impl_) return;
  const std::scoped_lock lock(impl_->mutex);
  impl_->forecasts = false;
}

std::optional<std::string> Watchdog::why() const {
  if (!impl_) return std::nullopt;
  const std::scoped_lock lock(impl_->mutex);
  return impl_->why;
}

}  // namespace kerf
