#include "app/watchdog.hpp"

#include "kerf/stop.hpp"
#include "kerf/types.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <thread>

namespace kerf {

namespace {

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

}  // namespace

struct Watchdog::Impl {
  Allowed limits;
  Stopwatch since_look;
  double elapsed = 0;  // but for the pauses
  mutable std::mutex mutex;
  std::condition_variable ended;
  bool over = false, paused = false;
  std::optional<std::string> why;
  std::thread thread;

  std::optional<std::string> beyond(double seconds, double mb) const {
    if (limits.seconds && seconds > *limits.seconds)
      return fmt::format("stopped: it took longer than --max-seconds {:g}", *limits.seconds);
    if (limits.memory_mb && mb > *limits.memory_mb)
      return fmt::format("stopped: it took more memory than --max-memory {:g}MB", *limits.memory_mb);
    return std::nullopt;
  }

  void look() {
    constexpr double patience = 10, much = 1.5;
    double asked = infinity;
    for (std::unique_lock lock(mutex); !over; ended.wait_for(lock, std::chrono::milliseconds(50))) {
      const double seconds = since_look.lap(), mb = resident_mb();
      if (paused) continue;
      elapsed += seconds;
      if (!why) {
        why = beyond(elapsed, mb);
        if (!why) continue;
        asked = elapsed;
        request_stop();
      }
      const bool swells = limits.memory_mb && mb > much * *limits.memory_mb;
      if (elapsed - asked < patience && !swells) continue;
      std::fprintf(stderr, "kerf: %s\n", why->c_str());
      std::fflush(stderr);
      _exit(static_cast<int>(Fault::Numerics));
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

void Watchdog::pause() {
  if (!impl_) return;
  const std::scoped_lock lock(impl_->mutex);
  impl_->paused = true;
}

void Watchdog::resume() {
  if (!impl_) return;
  const std::scoped_lock lock(impl_->mutex);
  impl_->paused = false;
}

std::optional<std::string> Watchdog::why() const {
  if (!impl_) return std::nullopt;
  const std::scoped_lock lock(impl_->mutex);
  return impl_->why;
}

}  // namespace kerf
