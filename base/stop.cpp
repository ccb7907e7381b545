// The request to stop, which a signal handler may set and long loops look at.

#include "kerf/stop.hpp"

#include <atomic>

namespace kerf {

namespace {

// A signal handler can reach nothing else.
std::atomic<bool> stop = false;
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void request_stop() noexcept {
  stop = true;
}

bool stop_requested() noexcept {
  return stop;
}

void forget_stop() noexcept {
  stop = false;
}

void check_stop() {
  if (stop_requested()) throw Stopped{};
}

}  // namespace kerf
